// Where playback stands. Time passes in frames; it waits for frames that are not there yet.

// How far, in frames, time may be outside of the frame that is shown. Where frames come as fast as the display's pictures, each picture shows the
// next one: rounded down, a hair's breadth of jitter would show one frame twice and leave out another.
const slack = 0.25;

export class Clock {
  playing = false;
  speed = 1; // simulated seconds a second
  loop = true;
  private place = 0; // frames, with a fraction
  private shown = 0;

  constructor(private readonly frameSeconds: number) {}

  get frame(): number {
    return this.shown;
  }

  jump(frame: number) {
    this.place = this.shown = Math.max(0, Math.floor(frame));
  }

  // `total` frames exist; `more` says that others will follow, so that the end is no end. Returns the frame to show.
  advance(seconds: number, total: number, more: boolean, isThere: (frame: number) => boolean): number {
    if (!this.playing || total === 0) return this.frame;
    const last = total - 1;
    // A page that was in the background does not catch up.
    const passed = (Math.min(seconds, 0.25) * this.speed) / this.frameSeconds;
    const next = this.place + passed;
    const due = Math.min(this.due(next, this.shown + Math.round(passed)), last);
    let reached = due;
    // Frames in between may be skipped, but not shown before they are there.
    while (reached > this.shown && !isThere(reached)) --reached;
    this.shown = reached;
    if (reached < due) this.place = Math.max(this.place, reached);
    else if (next < total) this.place = next;
    else this.atEnd(last, more, isThere);
    return this.frame;
  }

  // The frame at this place, or `steady`, the one that an even pace leads to, if that is as good.
  private due(place: number, steady: number): number {
    return place > steady - slack && place < steady + 1 + slack ? steady : Math.max(this.shown, Math.floor(place));
  }

  private atEnd(last: number, more: boolean, isThere: (frame: number) => boolean) {
    this.place = this.shown = last;
    if (more) return;
    if (!this.loop) this.playing = false;
    else if (isThere(0)) this.place = this.shown = 0;
  }
}
