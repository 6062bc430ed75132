// Where playback stands. Time passes in frames; it waits for frames that are not there yet.

export class Clock {
  playing = false;
  speed = 1; // simulated seconds a second
  loop = true;
  private place = 0; // frames, with a fraction

  constructor(private readonly frameSeconds: number) {}

  get frame(): number {
    return Math.floor(this.place);
  }

  jump(frame: number) {
    this.place = Math.max(0, frame);
  }

  // `total` frames exist; `more` says that others will follow, so that the end is no end. Returns the frame to show.
  advance(seconds: number, total: number, more: boolean, isThere: (frame: number) => boolean): number {
    if (!this.playing || total === 0) return this.frame;
    const last = total - 1;
    // A page that was in the background does not catch up.
    const next = this.place + (Math.min(seconds, 0.25) * this.speed) / this.frameSeconds;
    let reached = Math.min(Math.floor(next), last);
    // Frames in between may be skipped, but not shown before they are there.
    while (reached > this.frame && !isThere(reached)) --reached;
    if (reached < Math.min(Math.floor(next), last)) this.place = Math.max(this.place, reached);
    else if (next < total) this.place = next;
    else this.atEnd(last, more, isThere);
    return this.frame;
  }

  private atEnd(last: number, more: boolean, isThere: (frame: number) => boolean) {
    this.place = last;
    if (more) return;
    if (!this.loop) this.playing = false;
    else if (isThere(0)) this.place = 0;
  }
}
