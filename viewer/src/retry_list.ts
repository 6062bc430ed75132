// Frames that could not be had. One damaged file spoils the whole request it is in, so those are asked for again one by one, a second later.
const pause = 1000; // ms

export class RetryList {
  private readonly failures = new Map<number, { alone: boolean; at: number }>();

  failed(first: number, count: number, now: number) {
    for (let frame = first; frame < first + count; ++frame) this.failures.set(frame, { alone: count === 1, at: now });
  }

  succeeded(first: number, count: number) {
    for (let frame = first; frame < first + count; ++frame) this.failures.delete(frame);
  }

  // Not to be asked for yet.
  isWaiting(frame: number, now: number): boolean {
    const failure = this.failures.get(frame);
    return failure !== undefined && now - failure.at < pause;
  }

  // Failed when it was asked for alone.
  isHopeless(frame: number): boolean {
    return this.failures.get(frame)?.alone === true;
  }

  // How many frames from `first` on may go into one request.
  limit(first: number, count: number): number {
    for (let k = 0; k < count; ++k) if (this.failures.has(first + k)) return Math.max(k, 1);
    return count;
  }
}
