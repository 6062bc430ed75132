import assert from 'node:assert/strict';
import { test } from 'node:test';
import { niceCeiling, quantile, viridis, viridisTexels } from '../../src/colour_map';

// CIE 1976 L* of an sRGB colour under D65.
function lightness(colour: readonly number[]): number {
  const linear = colour.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
  const y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  return y > (6 / 29) ** 3 ? 116 * Math.cbrt(y) - 16 : (903.3 * y);
}

test('lightness rises evenly along the map: it can be read in grey', () => {
  const steps = Array.from({ length: 65 }, (_, k) => lightness(viridis(k / 64)));
  const even = (steps[64] - steps[0]) / 64;
  for (let k = 1; k < 65; ++k) {
    assert.ok(steps[k] > steps[k - 1], `at ${k}`);
    assert.ok(Math.abs(steps[k] - (steps[0] + k * even)) < 3, `at ${k}: ${steps[k]}`);
  }
});

test('colours are those of matplotlib', () => {
  assert.deepEqual(viridis(0), [68, 1, 84]);
  assert.deepEqual(viridis(1), [253, 231, 37]);
  // matplotlib's viridis(128): 0.127568, 0.566949, 0.550556
  viridis(128 / 255).forEach((c, k) => assert.ok(Math.abs(c - [32.5, 144.6, 140.4][k]) < 4, String(c)));
  assert.deepEqual(viridis(-1), viridis(0));
  assert.deepEqual(viridis(7), viridis(1));
});

test('reversed texels are the others backwards', () => {
  const there = viridisTexels();
  const back = viridisTexels(true);
  for (let k = 0; k < 256; ++k) assert.deepEqual(there.slice(4 * k, 4 * k + 4), back.slice(4 * (255 - k), 4 * (256 - k)));
});

test('the end of a scale is round and not below', () => {
  for (const [value, end] of [[0.0123, 0.015], [0.05, 0.05], [2.1, 3], [8.5, 10], [9999, 10000], [0, 1], [NaN, 1], [-3, 1]])
    assert.ok(Math.abs(niceCeiling(value) / end - 1) < 1e-12, `${value}: ${niceCeiling(value)}`);
});

test('quantile leaves out what is no number', () => {
  assert.equal(quantile([3, NaN, 1, Infinity, 2], 0.5), 2);
  assert.equal(quantile([1, 2, 3, 4], 1), 4);
  assert.ok(Number.isNaN(quantile([], 0.5)));
});
