// Normals at the nodes: the sum of the adjacent triangles' normals, weighted by their areas, then made of length 1. A node without area gets +z.
export function nodeNormals(positions: Float32Array, triangles: Uint32Array, out: Float32Array) {
  out.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    out[a] += nx, out[a + 1] += ny, out[a + 2] += nz;
    out[b] += nx, out[b + 1] += ny, out[b + 2] += nz;
    out[c] += nx, out[c + 1] += ny, out[c + 2] += nz;
  }
  for (let k = 0; k < out.length; k += 3) {
    const length = Math.sqrt(out[k] * out[k] + out[k + 1] * out[k + 1] + out[k + 2] * out[k + 2]);
    if (length > 0) (out[k] /= length), (out[k + 1] /= length), (out[k + 2] /= length);
    else (out[k] = 0), (out[k + 1] = 0), (out[k + 2] = 1);
  }
}
