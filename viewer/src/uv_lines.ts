// The triangles that a line of constant u or v goes through, 20 lines from 0 to 1: they stand for the lines where there is no graphics processor to draw
// thin ones. All 0 where triangles are too large for that.

const lines = 20;
const widest = 0.34; // of the way from line to line

export function lineTriangles(triangles: ArrayLike<number>, uv: ArrayLike<number>): Uint8Array {
  const through = new Uint8Array(triangles.length / 3);
  for (let t = 0; t < through.length; ++t)
    for (let axis = 0; axis < 2; ++axis) {
      const places = [0, 1, 2].map((corner) => lines * uv[2 * triangles[3 * t + corner] + axis]);
      const low = Math.min(...places), high = Math.max(...places);
      if (high - low > widest) return through.fill(0);
      // A line at the border of two triangles belongs to the one above.
      if (high - low > 1e-6 && Math.ceil(low - 1e-4) < high - 1e-4) through[t] = 1;
    }
  return through;
}
