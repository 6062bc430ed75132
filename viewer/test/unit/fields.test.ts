import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Pose, SolidInfo } from '../../src/api';
import { gapField, localDistance, poseAt, speedField, stretchField } from '../../src/fields';
import { nodeNormals } from '../../src/normals';

const near = (a: number, b: number, tolerance = 1e-6) => assert.ok(Math.abs(a - b) <= tolerance, `${a}, expected ${b}`);

test('stretch is the largest of a node’s springs', () => {
  // 0 --- 1 --- 2, the first spring 10 % longer than at rest, the second 5 % shorter; node 3 has none.
  const positions = Float32Array.from([0, 0, 0, 1.1, 0, 0, 1.1, 0.95, 0, 5, 5, 5]);
  const out = new Float32Array(4);
  stretchField(positions, Uint32Array.from([0, 1, 1, 2]), Float32Array.from([1, 1]), out);
  near(out[0], 0.1);
  near(out[1], 0.1);
  near(out[2], -0.05);
  assert.equal(out[3], 0);
});

test('speed is the way over the time', () => {
  const out = new Float32Array(2);
  speedField(Float32Array.from([0, 0, 0, 1, 1, 1]), Float32Array.from([0.3, 0, 0.4, 1, 1, 1]), 0.25, out);
  near(out[0], 2);
  assert.equal(out[1], 0);
});

const solid = (facts: Partial<SolidInfo>): SolidInfo => ({
  name: 's',
  shape: 'sphere',
  radius: 0.5,
  height: 2,
  size: [1, 2, 3],
  thickness: 0,
  poses: [[0, 0, 0, 0, 0, 0, 1]],
  ...facts,
});

test('distances are those of points known to lie there', () => {
  for (const [facts, point, distance] of [
    [{ shape: 'sphere' }, [0, 0, 2], 1.5],
    [{ shape: 'sphere' }, [0.1, 0, 0], -0.4],
    [{ shape: 'plane' }, [9, 9, -0.25], -0.25],
    [{ shape: 'cylinder' }, [0.5 + 0.3, 0, 1 + 0.4], 0.5], // beyond the edge: 3-4-5
    [{ shape: 'cylinder' }, [0, 0, 0.9], -0.1],
    [{ shape: 'cylinder' }, [0, 0.7, -0.2], 0.2],
    [{ shape: 'box' }, [0.5 + 0.3, 1 + 0.4, 0], 0.5],
    [{ shape: 'box' }, [0, 0, 1.4], -0.1],
    [{ shape: 'box' }, [0, -1.25, 1], 0.25],
  ] as const)
    near(localDistance(solid(facts), ...(point as unknown as [number, number, number])), distance, 1e-12);
});

test('a solid’s pose counts: turned, moved, thick', () => {
  // A quarter turn about x brings the box's z (half 1.5) to -y.
  const quarter: Pose = [1, 2, 3, Math.SQRT1_2, 0, 0, Math.SQRT1_2];
  const box = solid({ shape: 'box', poses: [[0, 0, 0, 0, 0, 0, 1], quarter], thickness: 0.01 });
  const out = new Float32Array(2);
  gapField(Float32Array.from([1, 2 + 1.5 + 0.2, 3, 1, 2, 3 + 1 + 0.3]), [box], 1, out);
  near(out[0], 0.19);
  near(out[1], 0.29);
  gapField(Float32Array.from([0, 0, 0, 9, 9, 9]), [], 0, out);
  assert.equal(out[0], Infinity);
});


test('normals of a folded sheet', () => {
  // Two triangles at a right angle along the y axis: one in z = 0, one in x = 0, of the same area.
  const positions = Float32Array.from([0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 1]);
  const out = new Float32Array(12);
  nodeNormals(positions, Uint32Array.from([0, 1, 2, 0, 3, 1]), out);
  near(out[6 + 2], 1); // node 2, in the first only
  near(Math.hypot(out[0], out[1], out[2]), 1);
  near(out[0], -Math.SQRT1_2, 1e-6);
  near(out[2], Math.SQRT1_2, 1e-6);
  nodeNormals(new Float32Array(12), Uint32Array.from([0, 1, 2]), out);
  assert.deepEqual([...out.slice(0, 3)], [0, 0, 1]);
});

test('a resting solid has one pose for all frames', () => {
  const resting = solid({});
  assert.equal(poseAt(resting, 50), resting.poses[0]);
});
