// Screenshots as pixels: enough of PNG for what a browser writes (8 bits, RGB or RGBA, not interlaced).
import { inflateSync } from 'node:zlib';

function chunks(png) {
  const found = [];
  for (let at = 8; at < png.length; ) {
    const length = png.readUInt32BE(at);
    found.push({ type: png.toString('latin1', at + 4, at + 8), data: png.subarray(at + 8, at + 8 + length) });
    at += length + 12;
  }
  return found;
}

const paeth = (a, b, c) => {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
};

export function decodePng(png) {
  const parts = chunks(png);
  const head = parts.find((part) => part.type === 'IHDR').data;
  const [width, height, depth, kind] = [head.readUInt32BE(0), head.readUInt32BE(4), head[8], head[9]];
  if (depth !== 8 || (kind !== 2 && kind !== 6)) throw new Error(`PNG with ${depth} bits, kind ${kind}`);
  const size = kind === 6 ? 4 : 3;
  const raw = inflateSync(Buffer.concat(parts.filter((part) => part.type === 'IDAT').map((part) => part.data)));
  const stride = width * size;
  const pixels = new Uint8Array(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const at = y * stride + x;
      const a = x >= size ? pixels[at - size] : 0;
      const b = y > 0 ? pixels[at - stride] : 0;
      const c = x >= size && y > 0 ? pixels[at - stride - size] : 0;
      const add = [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
      pixels[at] = raw[y * (stride + 1) + 1 + x] + add;
    }
  }
  return { width, height, size, pixels };
}

// How many pixels a rule holds for; rule(r, g, b).
export function countPixels({ size, pixels }, rule) {
  let count = 0;
  for (let at = 0; at < pixels.length; at += size) if (rule(pixels[at], pixels[at + 1], pixels[at + 2])) ++count;
  return count;
}

// The share of pixels in which two pictures differ visibly.
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error('pictures of different sizes');
  let count = 0;
  for (let at = 0; at < a.pixels.length; at += a.size)
    if (Math.max(Math.abs(a.pixels[at] - b.pixels[at]), Math.abs(a.pixels[at + 1] - b.pixels[at + 1]), Math.abs(a.pixels[at + 2] - b.pixels[at + 2])) > 12) ++count;
  return count / (a.width * a.height);
}
