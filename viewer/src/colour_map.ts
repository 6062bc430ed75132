// Viridis, which is perceptually uniform and readable without colour vision and in grey (Smith and van der Walt, matplotlib 1.5): ten of its
// colours, linear in between, as the plots of the program use them.

const anchors = [0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725];

export type Rgb = [number, number, number]; // 0 to 255, sRGB

const channels = (colour: number): Rgb => [colour >> 16, (colour >> 8) & 255, colour & 255];

// t from 0 to 1; beyond, the ends.
export function viridis(t: number): Rgb {
  const place = Math.min(Math.max(t, 0), 1) * (anchors.length - 1);
  const k = Math.min(Math.floor(place), anchors.length - 2);
  const a = channels(anchors[k]);
  const b = channels(anchors[k + 1]);
  return a.map((value, c) => Math.round(value + (place - k) * (b[c] - value))) as Rgb;
}

// 256 colours, RGBA.
export function viridisTexels(reversed = false): Uint8Array {
  const texels = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; ++k) texels.set([...viridis((reversed ? 255 - k : k) / 255), 255], 4 * k);
  return texels;
}

// A colour bar, low values to the left.
export function viridisGradient(reversed = false): string {
  const colours = anchors.map((_, k) => `rgb(${viridis(k / (anchors.length - 1)).join(' ')})`);
  return `linear-gradient(to right, ${(reversed ? colours.reverse() : colours).join(', ')})`;
}

// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is not below the value: the end of a scale.
export function niceCeiling(value: number): number {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 1.5, 2, 3, 4, 5, 6, 8]) if (step * power >= value * (1 - 1e-9)) return step * power;
  return 10 * power;
}

// The p-th part of the values in order, 0 to 1; NaN of none.
export function quantile(values: ArrayLike<number>, p: number): number {
  const sorted = Float32Array.from(values).filter(Number.isFinite).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))] : NaN;
}

export function shortNumber(value: number): string {
  return String(Number(value.toPrecision(3)));
}
