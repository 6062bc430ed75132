import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as THREE from 'three';
import { contactKinds, kindField } from '../../src/contact_kinds';
import { colourTable, levels, vertexLevels } from '../../src/soft/light';
import { halve, pixelOf, Raster, type Look, type Vertices } from '../../src/soft/raster';
import { Resolution } from '../../src/soft/resolution';
import { SoftRenderer } from '../../src/soft/soft_renderer';
import { lineTriangles } from '../../src/uv_lines';

// What is drawn by the processor where there is no graphics processor.

const shades = { colours: Uint32Array.from({ length: levels }, (_, k) => 0xff000000 + k), stride: 1 };
const front: Look = { front: shades, back: null, dimmed: null, flat: false, opacity: 1 };

function vertices(points: number[][], level = 100): Vertices {
  const column = (k: number, factor = 1) => Float64Array.from(points, (point) => Math.round(point[k] * factor));
  return {
    x: column(0, 16), y: column(1, 16), z: Float64Array.from(points, (point) => point[2]), hidden: new Uint8Array(points.length),
    frontLevel: Float32Array.from(points, (point) => point[3] ?? level), backLevel: new Float32Array(points.length).fill(7), value: null,
  };
}

const drawn = (raster: Raster) => raster.depth.reduce((count, depth) => count + (depth < Infinity ? 1 : 0), 0);

test('a triangle covers the pixels whose middles it holds', () => {
  const raster = new Raster(64, 64);
  raster.clear(0, 0);
  const corners = [[3.2, 5.1, 0.5], [50.7, 20.3, 0.5], [12.4, 58.9, 0.5]];
  raster.triangles(vertices(corners), [0, 2, 1], 0, 1, front, null);
  const side = (a: number[], b: number[], x: number, y: number) => (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
  const [a, b, c] = corners.map(([x, y]) => [Math.round(x * 16) / 16, Math.round(y * 16) / 16]);
  let count = 0;
  for (let y = 0; y < 64; ++y)
    for (let x = 0; x < 64; ++x) {
      const inside = side(a, b, x + 0.5, y + 0.5) >= 0 && side(b, c, x + 0.5, y + 0.5) >= 0 && side(c, a, x + 0.5, y + 0.5) >= 0;
      assert.equal(raster.depth[y * 64 + x] < Infinity, inside, `pixel ${x}, ${y}`);
      if (inside) ++count;
    }
  assert.ok(count > 900);
});

test('triangles that share edges leave no gap and, where one sees through them, meet no pixel twice', () => {
  // A fan around an odd place, in pixels and parts of them.
  const rim = Array.from({ length: 17 }, (_, k) => [40.3 + 33 * Math.cos(k * 0.3696), 40.9 + 33 * Math.sin(k * 0.3696), 0.5]);
  const all = vertices([[37.11, 44.53, 0.5], ...rim]);
  const index = rim.flatMap((_, k) => [0, 1 + ((k + 1) % 17), 1 + k]);
  for (const opacity of [1, 0.5]) {
    const raster = new Raster(80, 80);
    raster.clear(0, 0);
    raster.triangles(all, index, 0, 17, { ...front, front: { colours: shades.colours.map(() => pixelOf(0xffffff)), stride: 1 }, opacity }, null);
    const seen = new Map<number, number>();
    for (const shown of raster.colour) seen.set(shown, (seen.get(shown) ?? 0) + 1);
    assert.deepEqual(seen.size, 2, `colours at opacity ${opacity}: ${[...seen.keys()].map((k) => k.toString(16))}`);
    for (let y = 0; y < 80; ++y)
      for (let x = 0; x < 80; ++x) {
        const distance = Math.hypot(x + 0.5 - 40.3, y + 0.5 - 40.9);
        if (distance < 31) assert.notEqual(raster.colour[y * 80 + x], pixelOf(0), `a hole at ${x}, ${y}`);
        if (distance > 34) assert.equal(raster.colour[y * 80 + x], pixelOf(0), `too much at ${x}, ${y}`);
      }
  }
});

test('the nearer hides the farther in either order; light is linear between corners', () => {
  const square = (z: number, level: number) => [[4, 4, z, level], [60, 4, z, level], [60, 60, z, level], [4, 60, z, level]];
  for (const order of [[0, 1, 2, 3], [2, 3, 0, 1]]) {
    const raster = new Raster(64, 64);
    raster.clear(0, 0);
    const index = [0, 2, 1, 0, 3, 2, 4, 6, 5, 4, 7, 6];
    const both = vertices([...square(0.8, 10), ...square(0.2, 200)]);
    for (const t of order) raster.triangles(both, index, t, t + 1, front, null);
    assert.equal(raster.colour[30 * 64 + 30], shades.colours[200]);
    assert.equal(raster.depth[30 * 64 + 30], Math.fround(0.2));
  }
  const raster = new Raster(64, 64);
  raster.clear(0, 0);
  raster.triangles(vertices([[0, 0, 0, 0], [64, 0, 0, 128], [0, 64, 0, 0]]), [0, 2, 1], 0, 1, front, null);
  for (const x of [5, 20, 50]) assert.ok(Math.abs((raster.colour[3 * 64 + x] & 255) - 2 * (x + 0.5)) <= 1);
});

test('front and back are told apart', () => {
  const turned = vertices([[4, 4, 0], [60, 4, 0], [4, 60, 0]]);
  const raster = new Raster(64, 64);
  raster.clear(0, 0);
  raster.triangles(turned, [0, 1, 2], 0, 1, front, null);
  assert.equal(drawn(raster), 0);
  raster.triangles(turned, [0, 1, 2], 0, 1, { ...front, back: shades }, null);
  assert.equal(raster.colour[10 * 64 + 10], shades.colours[7]);
});

test('large triangles beyond the screen are cut off at its edges', () => {
  const raster = new Raster(32, 16);
  raster.clear(0, 0);
  raster.triangles(vertices([[-9e5, -9e5, 0], [9e5, -9e5, 0], [0, 2e6, 0]]), [0, 2, 1], 0, 1, front, null);
  assert.equal(drawn(raster), 32 * 16);
  raster.line(-1e6, 40, -1, 1e6, 40, -1, 5, 1);
  assert.equal(raster.colour.filter((shown) => shown === 5).length, 32);
});

test('a table’s colours are those of the screen where light is 1', () => {
  const whole = Math.round((levels - 1) / 1.6);
  for (const hex of [0x3a7cbd, 0xe9a040, 0xffffff, 0]) {
    const shown = colourTable([hex]).colours[whole];
    for (const [place, shift] of [[0, 16], [8, 8], [16, 0]]) assert.ok(Math.abs(((shown >> place) & 255) - ((hex >> shift) & 255)) <= 3, hex.toString(16));
  }
  const dark = colourTable([0x3a7cbd, 0xffffff], 0.5);
  assert.ok((dark.colours[1] & 255) > 150, 'half of the light is its own');
});

test('light comes from where the lights are, from behind on the other side', () => {
  const normals = [0, 0, 1, 0, 0, -1, 1, 0, 0];
  const front = new Float32Array(3), back = new Float32Array(3);
  vertexLevels(normals, { up: [0, 0, 1], sky: 1, floor: 0, suns: [{ direction: [0, 0, 1], strength: 1 }] }, front, back);
  const unit = (levels - 1) / 1.6 / Math.PI;
  [2, 0, 0.5].forEach((light, k) => assert.ok(Math.abs(front[k] - light * unit) < 1e-3, `front ${k}`));
  [0, 2, 0.5].forEach((light, k) => assert.ok(Math.abs(back[k] - light * unit) < 1e-3, `back ${k}`));
});

test('four pixels become their mean', () => {
  const fine = new Raster(2, 2);
  fine.colour.set([0x000000, 0xff8040, 0xff8040, 0xff80ff].map(pixelOf));
  const out = new Uint32Array(1);
  halve(fine, out);
  assert.deepEqual([out[0] & 255, (out[0] >> 8) & 255, (out[0] >> 16) & 255, out[0] >>> 24], [191, 96, 96, 255]);
});

test('pictures become coarser while they take long, finer when there is time', () => {
  const resolution = new Resolution();
  const draw = (milliseconds: number, times: number) => {
    for (let k = 0; k < times; ++k) resolution.note(milliseconds);
  };
  draw(9, 50);
  assert.equal(resolution.scale, 1);
  draw(40, 8);
  assert.equal(resolution.scale, 0.85);
  draw(40, 100);
  assert.equal(resolution.scale, 0.6);
  draw(9, 100);
  assert.equal(resolution.scale, 0.6, 'finer would take too long');
  draw(2, 100);
  assert.equal(resolution.scale, 1);
});

test('lines of constant u and v go through triangles, none at their borders twice', () => {
  const side = 161;
  const uv: number[] = [], triangles: number[] = [];
  for (let j = 0; j < side; ++j) for (let i = 0; i < side; ++i) uv.push(i / (side - 1), j / (side - 1));
  for (let j = 0; j + 1 < side; ++j)
    for (let i = 0; i + 1 < side; ++i) {
      const a = j * side + i;
      triangles.push(a, a + 1, a + side + 1, a, a + side + 1, a + side);
    }
  const through = lineTriangles(triangles, Float32Array.from(uv));
  const share = through.reduce((sum, one) => sum + one, 0) / through.length;
  assert.ok(Math.abs(share - (1 - (7 / 8) ** 2)) < 0.002, `${share}`);
  assert.equal(lineTriangles([0, 1, 2], [0, 0, 1, 0, 0, 1])[0], 0, 'a triangle wider than the lines apart');
});

test('the kinds of contact', () => {
  const out = new Float32Array(6);
  kindField(Uint8Array.from([0, 1, 2, 3, 4, 7]), out);
  assert.deepEqual([...out].map((kind) => contactKinds[kind].name), ['nothing', 'solid', 'cloth', 'both', 'held in a rigid zone', 'held in a rigid zone']);
});

// A canvas that keeps what is put on it.
function fakeCanvas() {
  const canvas = { width: 1, height: 1, shown: null as ImageData | null, getContext: () => context };
  const context = {
    createImageData: (width: number, height: number) => ({ width, height, data: new Uint8ClampedArray(4 * width * height) }),
    putImageData: (image: ImageData) => (canvas.shown = image),
  };
  return canvas;
}

test('a scene is drawn where three.js projects it, also what reaches behind the camera', () => {
  const canvas = fakeCanvas();
  const renderer = new SoftRenderer(canvas as unknown as HTMLCanvasElement);
  renderer.setBackground('#102030', '#102030');
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(40, 2, 0.1, 100);
  camera.up.set(0, 0, 1);
  camera.position.set(0, -5, 1);
  camera.lookAt(0, 0, 1);
  scene.add(camera, new THREE.HemisphereLight(0xffffff, 0xffffff, 3));
  const ball = new THREE.Mesh(new THREE.SphereGeometry(0.5, 48, 24), new THREE.MeshStandardMaterial({ color: 0xff0000 }));
  ball.position.set(1, 0, 1.5);
  const ground = new THREE.Mesh(new THREE.PlaneGeometry(400, 400), new THREE.MeshStandardMaterial({ color: 0x00ff00 }));
  scene.add(ball, ground);
  camera.updateMatrixWorld();
  for (const fine of [false, true]) {
    renderer.render(scene, camera, 200, 100, fine);
    const at = (x: number, y: number) => [...canvas.shown!.data.slice(4 * (y * 200 + x), 4 * (y * 200 + x) + 3)];
    const middle = new THREE.Vector3(1, 0, 1.5).project(camera);
    const [x, y] = [Math.floor(100 + 100 * middle.x), Math.floor(50 - 50 * middle.y)];
    assert.ok(at(x, y)[0] > 150 && at(x, y)[1] < 60, `the ball at ${x}, ${y}: ${at(x, y)}`);
    assert.ok(at(100, 98)[1] > 150, 'the ground below the camera');
    assert.ok(at(3, 60)[1] > 150 && at(197, 60)[1] > 150, 'and up to the horizon at both sides');
    assert.deepEqual(at(20, 10), [0x10, 0x20, 0x30], 'the sky');
  }
});
