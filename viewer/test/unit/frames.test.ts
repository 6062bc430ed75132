import assert from 'node:assert/strict';
import { test } from 'node:test';
import { nextRequest, splitFrames, surplus } from '../../src/frame_plan';
import { RetryList } from '../../src/retry_list';

test('frames come apart in order and do not share memory', () => {
  const numbers = Float32Array.from({ length: 2 * 4 * 3 }, (_, k) => k);
  const frames = splitFrames(numbers.buffer as ArrayBuffer, 48);
  assert.equal(frames.length, 2);
  assert.deepEqual([...new Float32Array(frames[1])], [12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23]);
  assert.equal(frames[0].byteLength, 48);
  assert.throws(() => splitFrames(new ArrayBuffer(48 + 4), 48), /no whole frames/);
  assert.throws(() => splitFrames(new ArrayBuffer(0), 0), /no whole frames/);
});

test('what plays next is asked for first, then the start', () => {
  const there = new Set([3, 4, 8]);
  const ask = (window: number, chunk: number) => nextRequest((frame) => there.has(frame), 3, 10, window, chunk);
  assert.deepEqual(ask(10, 100), { first: 5, count: 3 });
  assert.deepEqual(ask(10, 2), { first: 5, count: 2 });
  for (const frame of [5, 6, 7]) there.add(frame);
  assert.deepEqual(ask(10, 100), { first: 9, count: 1 });
  there.add(9);
  assert.deepEqual(ask(10, 100), { first: 0, count: 3 });
  assert.deepEqual(ask(8, 100), { first: 0, count: 1 }); // no more than the window
  assert.equal(ask(7, 100), null);
});

test('every frame is fetched once, whatever the sizes', () => {
  for (const [total, chunk, playhead] of [[1, 1, 0], [17, 4, 9], [100, 25, 99], [10, 1000, 5]]) {
    const there = new Map<number, number>();
    for (let request; (request = nextRequest((frame) => there.has(frame), playhead, total, total, chunk)); )
      for (let frame = request.first; frame < request.first + request.count; ++frame) there.set(frame, (there.get(frame) ?? 0) + 1);
    assert.equal(there.size, total);
    assert.ok([...there].every(([frame, times]) => frame < total && times === 1));
  }
});

test('those played last are let go', () => {
  assert.deepEqual(surplus([0, 1, 2, 3, 4, 5], 3, 6, 4).sort(), [1, 2]);
  assert.deepEqual(surplus([0, 1, 2], 0, 6, 4), []);
});

test('one damaged frame does not keep back those beside it', () => {
  const retries = new RetryList();
  assert.equal(retries.limit(10, 20), 20);
  retries.failed(10, 20, 5000);
  assert.ok(retries.isWaiting(15, 5900) && !retries.isWaiting(15, 6001));
  assert.ok(!retries.isHopeless(15));
  assert.equal(retries.limit(10, 20), 1); // alone
  assert.equal(retries.limit(5, 20), 5); // those before it together
  retries.succeeded(10, 1);
  retries.failed(11, 1, 7000);
  assert.ok(retries.isHopeless(11));
  assert.equal(retries.limit(30, 5), 5);
  retries.succeeded(11, 1); // mended meanwhile
  assert.ok(!retries.isHopeless(11));
});
