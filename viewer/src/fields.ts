import type { Pose, SolidInfo } from './api';

// Numbers at each node that the cloth is coloured by.

// The largest L/L0 - 1 of the stretch springs at each node: 0 at rest, negative when all are compressed; 0 for a node without springs.
export function stretchField(positions: Float32Array, springs: Uint32Array, restLengths: Float32Array, out: Float32Array) {
  out.fill(-Infinity);
  for (let s = 0; s < restLengths.length; ++s) {
    const i = springs[2 * s];
    const j = springs[2 * s + 1];
    const dx = positions[3 * j] - positions[3 * i];
    const dy = positions[3 * j + 1] - positions[3 * i + 1];
    const dz = positions[3 * j + 2] - positions[3 * i + 2];
    const strain = Math.sqrt(dx * dx + dy * dy + dz * dz) / restLengths[s] - 1;
    if (strain > out[i]) out[i] = strain;
    if (strain > out[j]) out[j] = strain;
  }
  for (let k = 0; k < out.length; ++k) if (out[k] === -Infinity) out[k] = 0;
}

// Mean speed between two frames `seconds` apart, m/s.
export function speedField(before: Float32Array, after: Float32Array, seconds: number, out: Float32Array) {
  for (let k = 0; k < out.length; ++k) {
    const dx = after[3 * k] - before[3 * k];
    const dy = after[3 * k + 1] - before[3 * k + 1];
    const dz = after[3 * k + 2] - before[3 * k + 2];
    out[k] = Math.sqrt(dx * dx + dy * dy + dz * dz) / seconds;
  }
}

export const poseAt = (solid: SolidInfo, frame: number): Pose => solid.poses[Math.min(frame, solid.poses.length - 1)];

// Signed distance to a solid's surface from a point in its own coordinates, as closest_surface of src/taut/contact/solid.h.
export function localDistance(solid: SolidInfo, x: number, y: number, z: number): number {
  switch (solid.shape) {
    case 'sphere':
      return Math.sqrt(x * x + y * y + z * z) - solid.radius;
    case 'plane':
      return z;
    case 'cylinder': {
      const side = Math.hypot(x, y) - solid.radius;
      const cap = Math.abs(z) - solid.height / 2;
      return side > 0 && cap > 0 ? Math.hypot(side, cap) : Math.max(side, cap);
    }
    case 'box': {
      const dx = Math.abs(x) - solid.size[0] / 2;
      const dy = Math.abs(y) - solid.size[1] / 2;
      const dz = Math.abs(z) - solid.size[2] / 2;
      const outside = Math.hypot(Math.max(dx, 0), Math.max(dy, 0), Math.max(dz, 0));
      return outside > 0 ? outside : Math.max(dx, dy, dz);
    }
    default:
      return Infinity;
  }
}

// Distance of each node from the nearest solid, its thickness taken off, m; Infinity without solids.
export function gapField(positions: Float32Array, solids: readonly SolidInfo[], frame: number, out: Float32Array) {
  out.fill(Infinity);
  for (const solid of solids) {
    const [tx, ty, tz, qx, qy, qz, qw] = poseAt(solid, frame);
    // The rows of the rotation's inverse.
    const r00 = 1 - 2 * (qy * qy + qz * qz), r01 = 2 * (qx * qy + qw * qz), r02 = 2 * (qx * qz - qw * qy);
    const r10 = 2 * (qx * qy - qw * qz), r11 = 1 - 2 * (qx * qx + qz * qz), r12 = 2 * (qy * qz + qw * qx);
    const r20 = 2 * (qx * qz + qw * qy), r21 = 2 * (qy * qz - qw * qx), r22 = 1 - 2 * (qx * qx + qy * qy);
    for (let k = 0; k < out.length; ++k) {
      const x = positions[3 * k] - tx;
      const y = positions[3 * k + 1] - ty;
      const z = positions[3 * k + 2] - tz;
      const gap =
        localDistance(solid, r00 * x + r01 * y + r02 * z, r10 * x + r11 * y + r12 * z, r20 * x + r21 * y + r22 * z) - solid.thickness;
      if (gap < out[k]) out[k] = gap;
    }
  }
}
