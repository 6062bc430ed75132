import { shortNumber, viridisGradient } from './colour_map';
import type { Scale } from './colouring';
import { contactKinds } from './contact_kinds';

const element = (id: string) => document.getElementById(id) as HTMLElement;

export function showLegend(scale: Scale | null) {
  element('legend').hidden = scale === null;
  if (!scale) return;
  element('legend-title').textContent = scale.unit ? `${scale.title}, ${scale.unit}` : scale.title;
  element('legend-bar').hidden = element('legend-fit').hidden = scale.kinds;
  element('legend-ticks').classList.toggle('kinds', scale.kinds);
  if (scale.kinds) return element('legend-ticks').replaceChildren(...kindEntries());
  element('legend-bar').style.background = viridisGradient(scale.reversed);
  const ticks = [0, 0.5, 1].map((share) => {
    const tick = document.createElement('span');
    tick.textContent = shortNumber(share * scale.high * scale.factor) + (share === 1 ? '+' : '');
    return tick;
  });
  element('legend-ticks').replaceChildren(...ticks);
}

function kindEntries(): HTMLElement[] {
  return contactKinds.map(({ name, colour }) => {
    const entry = document.createElement('span');
    entry.className = 'kind';
    entry.style.setProperty('--colour', `#${colour.toString(16).padStart(6, '0')}`);
    entry.textContent = name;
    return entry;
  });
}
