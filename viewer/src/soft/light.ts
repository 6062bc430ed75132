import type { ColourTable } from './raster';

// Light on a vertex as one number, and what colour it makes of a surface: as three.js's standard material without its gloss.

export const levels = 256; // of light, from none to mostLight
const mostLight = 1.6; // what a white surface returns, 1 is white on the screen

// All in the coordinates of the mesh; directions towards the light.
export interface Lights {
  up: [number, number, number];
  sky: number;
  floor: number;
  suns: { direction: [number, number, number]; strength: number }[];
}

// Seen from the front, and from behind, where the normal is the other way round.
export function vertexLevels(normals: ArrayLike<number>, lights: Lights, front: Float32Array, back: Float32Array) {
  const factor = (levels - 1) / mostLight / Math.PI;
  const mean = (0.5 * (lights.sky + lights.floor)) * factor, slope = (0.5 * (lights.sky - lights.floor)) * factor;
  const ux = lights.up[0] * slope, uy = lights.up[1] * slope, uz = lights.up[2] * slope;
  const suns = lights.suns.map(({ direction, strength }) => direction.map((value) => value * strength * factor));
  for (let k = 0, n = 0; k < front.length; ++k, n += 3) {
    const nx = normals[n], ny = normals[n + 1], nz = normals[n + 2];
    const tilt = ux * nx + uy * ny + uz * nz;
    let f = mean + tilt, b = mean - tilt;
    for (const sun of suns) {
      const lit = sun[0] * nx + sun[1] * ny + sun[2] * nz;
      if (lit > 0) f += lit;
      else b -= lit;
    }
    front[k] = f < levels - 1 ? f : levels - 1;
    back[k] = b < levels - 1 ? b : levels - 1;
  }
}

const toLinear = (channel: number) => (channel <= 0.04045 ? channel / 12.92 : ((channel + 0.055) / 1.055) ** 2.4);
const toScreen = (light: number) => (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055);

// The screen's value for light in 1/1023: what powers cost is paid once.
const screenValues = Uint8Array.from({ length: 1024 }, (_, k) => Math.round(255 * toScreen(k / 1023)));

// `colours`: 0xrrggbb by value. `glow`: the share of a colour that is seen without light.
export function colourTable(colours: ArrayLike<number>, glow = 0): ColourTable {
  const stride = colours.length;
  const table = new Uint32Array(levels * stride);
  for (let v = 0; v < stride; ++v) {
    const [red, green, blue] = [16, 8, 0].map((shift) => 1023 * toLinear(((colours[v] >> shift) & 255) / 255));
    for (let level = 0; level < levels; ++level) {
      const light = glow + (1 - 0.9 * glow) * ((level * mostLight) / (levels - 1));
      const shown = (part: number) => screenValues[Math.min(1023, (part * light) | 0)];
      table[level * stride + v] = (0xff000000 | (shown(blue) << 16) | (shown(green) << 8) | shown(red)) >>> 0;
    }
  }
  return { colours: table, stride };
}
