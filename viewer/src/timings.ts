// What each picture costs the page, for `npm run bench`: kept where ?timings stands at the end of the address.

const most = 10_000;

export class Timings {
  readonly work: number[] = []; // ms: everything but drawing
  readonly draw: number[] = [];

  note(work: number, draw: number) {
    if (this.work.length < most) this.work.push(work), this.draw.push(draw);
  }
}

export function wantedTimings(): Timings | null {
  if (!new URLSearchParams(location.search).has('timings')) return null;
  return ((window as { tautTimings?: Timings }).tautTimings = new Timings());
}
