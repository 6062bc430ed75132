import { shortNumber, viridisGradient } from './colour_map';
import type { Scale } from './colouring';

const element = (id: string) => document.getElementById(id) as HTMLElement;

export function showLegend(scale: Scale | null) {
  element('legend').hidden = scale === null;
  if (!scale) return;
  element('legend-title').textContent = `${scale.title}, ${scale.unit}`;
  element('legend-bar').style.background = viridisGradient(scale.reversed);
  const ticks = [0, 0.5, 1].map((share) => {
    const tick = document.createElement('span');
    tick.textContent = shortNumber(share * scale.high * scale.factor) + (share === 1 ? '+' : '');
    return tick;
  });
  element('legend-ticks').replaceChildren(...ticks);
}
