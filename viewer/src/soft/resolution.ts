// How finely pictures are drawn on the processor: coarser while they take too long, whole again when there is time.

const budget = 11; // ms a picture: of a sixtieth of a second the rest is the browser's
const steps = [1, 0.85, 0.7, 0.6];
const counted = 8;

export class Resolution {
  private step = 0;
  private times: number[] = [];

  // Of the whole picture's width, and of its height.
  get scale(): number {
    return steps[this.step];
  }

  // How long a picture took to draw.
  note(milliseconds: number) {
    this.times.push(milliseconds);
    if (this.times.length < counted) return;
    // The median: a pause of the garbage collector's is no reason.
    const usual = this.times.sort((a, b) => a - b)[counted >> 1];
    this.times = [];
    const finer = steps[this.step - 1];
    if (usual > budget && this.step < steps.length - 1) ++this.step;
    else if (finer && usual * (finer / this.scale) ** 2 < 0.8 * budget) --this.step;
  }
}
