import { ServerError } from './api';
import { nextRequest, splitFrames, surplus } from './frame_plan';
import { RetryList } from './retry_list';

const mostBytes = 768 * 2 ** 20;
const chunkBytes = 8 * 2 ** 20;
const mostRequests = 2;

// The frames that are in memory: fetched ahead of the playhead, those played last let go when memory is used up.
export class FrameStore<T> {
  private frames = new Map<number, T>();
  private asked = new Set<number>();
  private requests = 0;
  private readonly retries = new RetryList();
  private closed = false;
  private readonly most: number;
  private readonly chunk: number;
  total = 0;
  playhead = 0;

  constructor(
    private readonly source: { frameBytes: number; read: (first: number, count: number) => Promise<ArrayBuffer>; view: (frame: ArrayBuffer) => T },
    private readonly onArrival: () => void,
    private readonly onTrouble: (message: string) => void,
  ) {
    const { frameBytes } = source;
    this.most = Math.max(4, Math.floor(mostBytes / frameBytes));
    this.chunk = Math.max(1, Math.floor(chunkBytes / frameBytes));
  }

  get(frame: number): T | undefined {
    return this.frames.get(frame);
  }

  // There, or not to be had for now: playback goes past a damaged one.
  isSettled(frame: number): boolean {
    return this.frames.has(frame) || this.retries.isHopeless(frame);
  }

  // A resumed run begins anew after its checkpoint: frames from `total` on are other ones when they come again.
  setTotal(total: number) {
    this.forgetFrom(total);
    this.total = total;
    this.fetchMore();
  }

  forgetFrom(total: number) {
    if (total < this.total) for (const frame of [...this.frames.keys()]) if (frame >= total) this.frames.delete(frame);
    this.total = Math.min(this.total, total);
  }

  moveTo(playhead: number) {
    this.playhead = playhead;
    this.fetchMore();
  }

  close() {
    this.closed = true;
    this.frames.clear();
  }

  private fetchMore() {
    const now = performance.now();
    while (!this.closed && this.requests < mostRequests && this.total > 0) {
      const has = (frame: number) => this.frames.has(frame) || this.asked.has(frame) || this.retries.isWaiting(frame, now);
      const request = nextRequest(has, this.playhead, this.total, this.most, this.chunk);
      if (!request) return;
      void this.fetch(request.first, this.retries.limit(request.first, request.count));
    }
  }

  private async fetch(first: number, count: number) {
    ++this.requests;
    for (let frame = first; frame < first + count; ++frame) this.asked.add(frame);
    try {
      const { read, view, frameBytes } = this.source;
      const arrived = splitFrames(await read(first, count), frameBytes).map(view);
      if (this.closed) return;
      arrived.forEach((frame, k) => this.frames.set(first + k, frame));
      this.retries.succeeded(first, count);
      for (const frame of surplus(this.frames.keys(), this.playhead, this.total, this.most)) this.frames.delete(frame);
      this.onArrival();
    } catch (error) {
      this.retries.failed(first, count, performance.now());
      if (count === 1 && error instanceof ServerError) this.onTrouble(error.message);
      setTimeout(() => this.fetchMore(), 1001);
    } finally {
      --this.requests;
      for (let frame = first; frame < first + count; ++frame) this.asked.delete(frame);
    }
    this.fetchMore();
  }
}
