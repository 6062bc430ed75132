import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as THREE from 'three';
import type { SolidInfo } from '../../src/api';
import { SolidsView } from '../../src/solids_view';

// One triangle that moves up by 1 a frame, as the server sends it.
const answers: Record<string, ArrayBufferLike> = {
  solid_triangles: Int32Array.of(0, 1, 2).buffer,
  solid_points: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1).buffer,
};

test('a solid that is a mesh is drawn from both sides, where it is at each frame', async () => {
  globalThis.fetch = (async (address: string) => new Response(answers[/solid_\w+/.exec(address)![0]] as ArrayBuffer)) as typeof fetch;
  const info = [{ name: 'flap', shape: 'mesh', poses: [] } as unknown as SolidInfo];
  const solids = new SolidsView(info);
  await solids.loadMeshes(info);
  const mesh = solids.group.children[0] as THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>;
  assert.equal(mesh.material.side, THREE.DoubleSide);
  for (const frame of [0, 1, 7]) {
    solids.setFrame(frame);
    assert.equal(mesh.geometry.getAttribute('position').getZ(0), Math.min(frame, 1));
  }
  solids.setTranslucent(true);
  solids.setColour(0x123456, 0);
  assert.ok(mesh.material.transparent && mesh.material.color.getHex() === 0x123456);
});
