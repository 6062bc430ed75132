import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Clock } from '../../src/clock';

const all = () => true;

function play(clock: Clock, ticks: number, total: number, more = false, isThere: (frame: number) => boolean = all): number[] {
  return Array.from({ length: ticks }, () => clock.advance(1 / 60, total, more, isThere));
}

test('plays in simulated time, whatever the time between frames', () => {
  const clock = new Clock(1 / 120);
  clock.playing = true;
  play(clock, 30, 1000);
  assert.ok(Math.abs(clock.frame - 60) <= 1, String(clock.frame));
  clock.speed = 0.25;
  play(clock, 60, 1000);
  assert.ok(Math.abs(clock.frame - 90) <= 1, String(clock.frame));
});

test('shows each frame once where they come as fast as pictures, whatever the jitter', () => {
  const clock = new Clock(1 / 60);
  clock.playing = true;
  for (let tick = 1; tick <= 500; ++tick) {
    const jitter = tick % 3 === 0 ? 2e-4 : -1e-4;
    assert.equal(clock.advance(1 / 60 + jitter, 1000, false, all), tick);
  }
});

test('waits for a frame that is not there yet', () => {
  const clock = new Clock(1 / 60);
  clock.playing = true;
  assert.equal(play(clock, 30, 100, false, (frame) => frame <= 7).at(-1), 7);
  assert.equal(clock.playing, true);
  const on = play(clock, 3, 100);
  assert.ok(on[0] <= 9 && on[2] > 8, String(on)); // goes on from there, without catching up
});

test('loops, or stops at the end', () => {
  const clock = new Clock(1 / 60);
  clock.playing = true;
  const frames = play(clock, 25, 10);
  assert.equal(Math.max(...frames), 9);
  assert.ok(frames.indexOf(0, 9) > 0);
  clock.loop = false;
  play(clock, 25, 10);
  assert.equal(clock.frame, 9);
  assert.equal(clock.playing, false);
});

test('at the newest frame of a running simulation it waits for more', () => {
  const clock = new Clock(1 / 60);
  clock.playing = true;
  assert.equal(play(clock, 30, 10, true).at(-1), 9);
  assert.equal(clock.playing, true);
  assert.ok((play(clock, 3, 20, true).at(-1) ?? 0) > 9);
});

test('shows nothing where there is nothing', () => {
  const clock = new Clock(1 / 60);
  clock.playing = true;
  assert.deepEqual(play(clock, 3, 0), [0, 0, 0]);
});
