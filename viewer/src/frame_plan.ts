// Which frames to fetch next and which to let go. Frames are wanted in the order in which they will be played: from the playhead to the newest,
// then from the start.

export interface FrameRequest {
  first: number;
  count: number;
}

// How many frames later a frame is played.
export const playedAfter = (frame: number, playhead: number, total: number) => (frame - playhead + total) % total;

// The first run of frames, at most `chunk` long and within the next `window` to be played, that are neither there nor asked for.
export function nextRequest(has: (frame: number) => boolean, playhead: number, total: number, window: number, chunk: number): FrameRequest | null {
  const reach = Math.min(window, total);
  for (let step = 0; step < reach; ++step) {
    const first = (playhead + step) % total;
    if (has(first)) continue;
    let count = 1;
    while (count < chunk && step + count < reach && first + count < total && !has(first + count)) ++count;
    return { first, count };
  }
  return null;
}

// Those that will be played last, so that `most` remain.
export function surplus(frames: Iterable<number>, playhead: number, total: number, most: number): number[] {
  const order = [...frames].sort((a, b) => playedAfter(a, playhead, total) - playedAfter(b, playhead, total));
  return order.slice(most);
}

// Frames of so many bytes, one after the other.
export function splitFrames(buffer: ArrayBuffer, frameBytes: number): ArrayBuffer[] {
  if (frameBytes === 0 || buffer.byteLength % frameBytes !== 0) throw new RangeError(`${buffer.byteLength} bytes are no whole frames of ${frameBytes}`);
  const frames: ArrayBuffer[] = [];
  // Copied: a view would keep all others in memory with it.
  for (let at = 0; at < buffer.byteLength; at += frameBytes) frames.push(buffer.slice(at, at + frameBytes));
  return frames;
}
