// Without a graphics processor a browser has no WebGL, or imitates one on the processor, too slowly to play a large cloth: then the page draws by itself
// (soft/). ?quality=high or ?quality=low at the end of the address decides otherwise.
export type Quality = 'high' | 'low';

const softwareRenderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;

function rendererName(): string {
  const context = document.createElement('canvas').getContext('webgl2');
  if (!context) return '';
  const unnamed = 'unnamed';
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : unnamed;
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return name;
}

export function chooseQuality(): Quality {
  const asked = new URLSearchParams(location.search).get('quality');
  if (asked === 'low') return 'low';
  const name = rendererName();
  if (name === '') return 'low';
  return asked === 'high' || !softwareRenderers.test(name) ? 'high' : 'low';
}
