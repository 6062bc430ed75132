// Triangles and lines into pixels on the processor, with a depth buffer: what a graphics processor does, for machines that have none.
//
//   x, y     pixels times 16, whole numbers, y down; pixel (0, 0) is sampled at (8, 8). Sums of products of them are exact, so that triangles that
//            share an edge leave no gap
//   z        smaller is nearer
//   level    how much light a vertex gets, value: what it is coloured by; both linear over a triangle. They choose a colour in a table
//
// A triangle is seen from its front when its corners run counter-clockwise on the screen.

export const subpixels = 16;

// Colours by light and value: table[level * stride + value].
export type ColourTable = { colours: Uint32Array; stride: number };

export interface Vertices {
  x: Float64Array;
  y: Float64Array;
  z: Float64Array;
  hidden: Uint8Array; // 1: behind the camera
  frontLevel: Float32Array;
  backLevel: Float32Array;
  value: Float32Array | null;
}

export interface Look {
  front: ColourTable;
  back: ColourTable | null; // null: not drawn from behind
  dimmed: Uint8Array | null; // by triangle: 1 for those that a line on the cloth goes through
  flat: boolean; // each triangle has one value, the largest of its corners'
  opacity: number;
}

const dimmedShare = 0.8;

export class Raster {
  readonly colour: Uint32Array;
  readonly depth: Float32Array;

  constructor(
    readonly width: number,
    readonly height: number,
  ) {
    this.colour = new Uint32Array(width * height);
    this.depth = new Float32Array(width * height);
  }

  // To two colours, 0xrrggbb, and what lies between.
  clear(top: number, bottom: number) {
    const { width, height } = this;
    for (let y = 0; y < height; ++y) this.colour.fill(blend(pixelOf(top), pixelOf(bottom), y / height), y * width, (y + 1) * width);
    this.depth.fill(Infinity);
  }

  // Triangles first to end of the index list. Those with a hidden corner are left out and their numbers given to `hidden`.
  triangles(vertices: Vertices, index: ArrayLike<number>, first: number, end: number, look: Look, hidden: number[] | null) {
    const { x, y, z, frontLevel, backLevel, value } = vertices;
    const { colour, depth, width, height } = this;
    const { front, back, dimmed, flat, opacity } = look;
    const opaque = opacity >= 1;
    for (let t = first; t < end; ++t) {
      const a = index[3 * t];
      let b = index[3 * t + 1];
      let c = index[3 * t + 2];
      if (vertices.hidden[a] | vertices.hidden[b] | vertices.hidden[c]) {
        if (hidden && !(vertices.hidden[a] & vertices.hidden[b] & vertices.hidden[c])) hidden.push(t);
        continue;
      }
      const xa = x[a], ya = y[a];
      let area = (x[b] - xa) * (y[c] - ya) - (x[c] - xa) * (y[b] - ya);
      if (area === 0) continue;
      let table = back;
      let level = backLevel;
      if (area < 0) {
        // Turned, so that the inside of all edges is positive.
        const other = b;
        b = c, c = other, area = -area;
        table = front, level = frontLevel;
      }
      if (table === null) continue;
      const xb = x[b], yb = y[b], xc = x[c], yc = y[c];
      // Pixels whose samples lie within: 7 >> 4 rounds up to them, -8 >> 4 down.
      let left = (Math.min(xa, xb, xc) + 7) >> 4, right = (Math.max(xa, xb, xc) - 8) >> 4;
      let top = (Math.min(ya, yb, yc) + 7) >> 4, bottom = (Math.max(ya, yb, yc) - 8) >> 4;
      if (left < 0) left = 0;
      if (top < 0) top = 0;
      if (right >= width) right = width - 1;
      if (bottom >= height) bottom = height - 1;
      if (left > right || top > bottom) continue;

      const px = left * subpixels + 8, py = top * subpixels + 8;
      let rowA = (xc - xb) * (py - yb) - (yc - yb) * (px - xb);
      let rowB = (xa - xc) * (py - yc) - (ya - yc) * (px - xc);
      let rowC = (xb - xa) * (py - ya) - (yb - ya) * (px - xa);
      const stepA = (yb - yc) * subpixels, stepB = (yc - ya) * subpixels, stepC = (ya - yb) * subpixels;
      const downA = (xc - xb) * subpixels, downB = (xa - xc) * subpixels, downC = (xb - xa) * subpixels;
      const share = 1 / area;
      const za = z[a], zab = (z[b] - za) * share, zac = (z[c] - za) * share;
      const stepZ = stepB * zab + stepC * zac, downZ = downB * zab + downC * zac;
      let rowZ = za + rowB * zab + rowC * zac;
      const dim = dimmed !== null && dimmed[t] !== 0 ? dimmedShare : 1;
      const la = level[a] * dim, lab = (level[b] * dim - la) * share, lac = (level[c] * dim - la) * share;
      const stepL = stepB * lab + stepC * lac, downL = downB * lab + downC * lac;
      let rowL = la + rowB * lab + rowC * lac;
      let stepV = 0, downV = 0, rowV = 0;
      if (value !== null && flat) {
        rowV = Math.max(value[a], value[b], value[c]);
      } else if (value !== null) {
        const va = value[a], vab = (value[b] - va) * share, vac = (value[c] - va) * share;
        stepV = stepB * vab + stepC * vac, downV = downB * vab + downC * vac;
        rowV = va + rowB * vab + rowC * vac;
      }
      // Where what is behind shines through, no pixel may be drawn by both triangles at an edge.
      if (!opaque) {
        if (!(stepA > 0 || (stepA === 0 && downA > 0))) --rowA;
        if (!(stepB > 0 || (stepB === 0 && downB > 0))) --rowB;
        if (!(stepC > 0 || (stepC === 0 && downC > 0))) --rowC;
      }
      const colours = table.colours, stride = table.stride;
      const wide = right - left > 12;
      for (let row = top; row <= bottom; ++row) {
        let from = left, to = right;
        if (wide) {
          // Where the row enters and leaves the triangle, one pixel to spare.
          if (stepA > 0) from = Math.max(from, left + Math.floor(-rowA / stepA));
          else if (stepA < 0) to = Math.min(to, left + Math.ceil(-rowA / stepA));
          if (stepB > 0) from = Math.max(from, left + Math.floor(-rowB / stepB));
          else if (stepB < 0) to = Math.min(to, left + Math.ceil(-rowB / stepB));
          if (stepC > 0) from = Math.max(from, left + Math.floor(-rowC / stepC));
          else if (stepC < 0) to = Math.min(to, left + Math.ceil(-rowC / stepC));
        }
        const skipped = from - left;
        let inA = rowA + skipped * stepA, inB = rowB + skipped * stepB, inC = rowC + skipped * stepC;
        let nowZ = rowZ + skipped * stepZ, nowL = rowL + skipped * stepL, nowV = rowV + skipped * stepV;
        const end = row * width + to;
        for (let at = row * width + from; at <= end; ++at) {
          if (inA >= 0 && inB >= 0 && inC >= 0 && nowZ < depth[at]) {
            const shown = colours[(nowL | 0) * stride + (nowV | 0)];
            if (opaque) {
              depth[at] = nowZ;
              colour[at] = shown;
            } else {
              colour[at] = blend(colour[at], shown, opacity);
            }
          }
          inA += stepA, inB += stepB, inC += stepC;
          nowZ += stepZ, nowL += stepL, nowV += stepV;
        }
        rowA += downA, rowB += downB, rowC += downC;
        rowZ += downZ, rowL += downL, rowV += downV;
      }
    }
  }

  // A line one pixel wide, between points in pixels times 16.
  line(x0: number, y0: number, z0: number, x1: number, y1: number, z1: number, shown: number, opacity: number) {
    const { colour, depth, width, height } = this;
    const dx = (x1 - x0) / subpixels, dy = (y1 - y0) / subpixels;
    const steps = Math.max(1, Math.ceil(Math.max(Math.abs(dx), Math.abs(dy))));
    // The part that is on the screen.
    let first = 0, last = steps;
    for (const [start, change, size] of [[x0 / subpixels, dx / steps, width], [y0 / subpixels, dy / steps, height]]) {
      if (change === 0) {
        if (start < 0 || start >= size) return;
        continue;
      }
      const enter = -start / change, leave = (size - 1e-6 - start) / change;
      first = Math.max(first, Math.ceil(Math.min(enter, leave))), last = Math.min(last, Math.floor(Math.max(enter, leave)));
    }
    for (let k = first; k <= last; ++k) {
      const at = Math.floor(y0 / subpixels + (k * dy) / steps) * width + Math.floor(x0 / subpixels + (k * dx) / steps);
      const z = z0 + (k / steps) * (z1 - z0);
      if (z >= depth[at]) continue;
      if (opacity >= 1) depth[at] = z;
      colour[at] = opacity >= 1 ? shown : blend(colour[at], shown, opacity);
    }
  }
}

// 0xrrggbb as the canvas has it in memory.
export const pixelOf = (hex: number) => (0xff000000 | ((hex & 255) << 16) | (hex & 0xff00) | (hex >> 16)) >>> 0;

function blend(below: number, above: number, opacity: number): number {
  const share = (opacity * 256) | 0, rest = 256 - share;
  const redBlue = (((below & 0xff00ff) * rest + (above & 0xff00ff) * share) >>> 8) & 0xff00ff;
  const green = (((below & 0xff00) * rest + (above & 0xff00) * share) >>> 8) & 0xff00;
  return (0xff000000 | redBlue | green) >>> 0;
}

// Every two by two pixels become one, their mean.
export function halve(fine: Raster, out: Uint32Array) {
  const width = fine.width >> 1, height = fine.height >> 1;
  const { colour } = fine;
  for (let y = 0; y < height; ++y) {
    let at = 2 * y * fine.width;
    for (let x = 0; x < width; ++x, at += 2) {
      const a = colour[at], b = colour[at + 1], c = colour[at + fine.width], d = colour[at + fine.width + 1];
      const redBlue = ((a & 0xff00ff) + (b & 0xff00ff) + (c & 0xff00ff) + (d & 0xff00ff) + 0x20002) >>> 2;
      const green = ((a & 0xff00) + (b & 0xff00) + (c & 0xff00) + (d & 0xff00) + 0x200) >>> 2;
      out[y * width + x] = 0xff000000 | (redBlue & 0xff00ff) | (green & 0xff00);
    }
  }
}
