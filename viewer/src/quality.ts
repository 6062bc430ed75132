// Without a graphics processor the browser draws on the processor: then smooth edges and shadows cost most of the frames a second, and are left out.
// ?quality=high or ?quality=low at the end of the address decides otherwise.
export type Quality = 'high' | 'low';

const softwareRenderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;

function rendererName(): string {
  const context = document.createElement('canvas').getContext('webgl2');
  if (!context) return '';
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return name;
}

export function chooseQuality(): Quality {
  const asked = new URLSearchParams(location.search).get('quality');
  if (asked === 'high' || asked === 'low') return asked;
  return softwareRenderers.test(rendererName()) ? 'low' : 'high';
}
