import { kindField } from './contact_kinds';
import { gapField, speedField, stretchField } from './fields';
import type { SceneInfo } from './api';
import { niceCeiling, quantile } from './colour_map';

export const modes = ['cloth', 'stretch', 'speed', 'contact'] as const;
export type Mode = (typeof modes)[number];

export interface Springs {
  ends: Uint32Array;
  restLengths: Float32Array;
}

export interface Scale {
  title: string;
  unit: string;
  factor: number; // from the field's SI unit to the one shown
  reversed: boolean; // low values bright
  high: number; // SI; low is 0
  kinds: boolean; // no numbers but those of contact_kinds.ts
}

// Frames that are in memory.
export interface Frames {
  positions(frame: number): Float32Array | undefined;
  contact(frame: number): Uint8Array | undefined; // bits, where the run has recorded them
}

// 10 mm: where cloth that nears a solid begins to be told from the rest.
const gapShown = 0.01;

// A few nodes at pins stretch far more than all others; they may share the scale's last colour.
const usualShare = 0.99;

// Fills the numbers that a mode colours by, and keeps the end of its scale.
export class Colouring {
  springs: Springs | null = null;
  private highs: Partial<Record<Mode, number>> = {};
  private fitted = new Set<Mode>();

  constructor(private readonly scene: SceneInfo) {}

  available(mode: Mode): string | null {
    if (mode === 'stretch' && this.scene.springs === 0) return 'This result does not say where its springs are';
    if (mode === 'contact' && !this.scene.contact && !this.scene.solids.some((solid) => solid.shape !== 'unknown' && solid.shape !== 'mesh')) return 'There is no solid whose distance is known';
    return null;
  }

  // False when what is needed is not there yet; then `out` is as it was.
  fill(mode: Mode, frame: number, frames: Frames, out: Float32Array): boolean {
    const positions = frames.positions(frame);
    if (!positions) return false;
    if (mode === 'contact' && this.scene.contact) {
      const bits = frames.contact(frame);
      if (!bits) return false;
      kindField(bits, out);
    } else if (mode === 'contact') {
      gapField(positions, this.scene.solids, frame, out);
    } else if (mode === 'stretch') {
      if (!this.springs) return false;
      stretchField(positions, this.springs.ends, this.springs.restLengths, out);
    } else if (mode === 'speed') {
      // Since the frame before; at the start until the next.
      const other = frames.positions(frame === 0 ? 1 : frame - 1);
      if (!other) return false;
      speedField(other, positions, this.scene.frame_s, out);
    }
    return true;
  }

  // The end of the scale: round, and never shrinking, so that colours mean the same in all frames; unless it was fitted by hand.
  updateScale(mode: Mode, field: Float32Array) {
    if (this.fitted.has(mode)) return;
    if (mode === 'contact') this.highs[mode] = gapShown;
    else this.highs[mode] = Math.max(this.highs[mode] ?? 0, niceCeiling(quantile(sample(field), usualShare)));
  }

  // To what the field holds now.
  fitScale(mode: Mode, field: Float32Array) {
    this.fitted.add(mode);
    this.highs[mode] = niceCeiling(quantile(sample(field), mode === 'contact' ? 0.5 : usualShare));
  }

  scale(mode: Mode): Scale {
    const high = this.highs[mode] ?? 1;
    if (mode === 'stretch') return { title: 'Stretch: largest L/L₀ − 1 at a node', unit: '%', factor: 100, reversed: false, high, kinds: false };
    if (mode === 'speed') return { title: 'Speed', unit: 'm/s', factor: 1, reversed: false, high, kinds: false };
    if (this.scene.contact) return { title: 'Touched by', unit: '', factor: 1, reversed: false, high: 1, kinds: true };
    return { title: 'Distance to the nearest solid', unit: 'mm', factor: 1000, reversed: true, high, kinds: false };
  }
}

// Enough for a quantile, in little time.
function sample(field: Float32Array): Float32Array {
  const stride = Math.max(1, Math.floor(field.length / 2000));
  const taken = new Float32Array(Math.ceil(field.length / stride));
  for (let k = 0; k < taken.length; ++k) taken[k] = field[k * stride];
  return taken;
}
