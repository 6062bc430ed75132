import { readStats } from './api';

export type Column = (number | null)[];

// stats.csv as columns of numbers, row by row as they come. What is no number is null.
export class StatsTable {
  readonly columns = new Map<string, Column>();
  private names: string[] = [];
  private wanted: (Column | null)[] = [];

  constructor(private readonly keep: readonly string[]) {}

  get rows(): number {
    return this.column('time').length;
  }

  column(name: string): Column {
    return this.columns.get(name) ?? [];
  }

  // Whole lines; the first ever is the header.
  append(text: string) {
    for (const line of text.split('\n')) {
      const row = line.endsWith('\r') ? line.slice(0, -1) : line;
      if (row === '') continue;
      if (this.names.length === 0) this.readHeader(row);
      else this.readRow(row);
    }
  }

  private readHeader(row: string) {
    this.names = row.split(',');
    this.wanted = this.names.map((name) => (this.keep.includes(name) ? [] : null));
    this.names.forEach((name, k) => {
      const column = this.wanted[k];
      if (column) this.columns.set(name, column);
    });
  }

  private readRow(row: string) {
    const fields = row.split(',');
    this.wanted.forEach((column, k) => {
      const field = fields[k] ?? '';
      const value = field === '' ? NaN : Number(field);
      column?.push(Number.isFinite(value) ? value : null);
    });
  }

  // The last row at or before a time; -1 when there is none.
  rowAt(time: number): number {
    const times = this.column('time');
    // Times are written with nine digits.
    const limit = time * (1 + 1e-8) + 1e-12;
    let low = 0;
    let high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((times[middle] ?? -Infinity) <= limit) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }
}

// Follows the growing file.
export class StatsFollower {
  table: StatsTable;
  private bytes = 0;
  private file = '';
  private busy = false;

  constructor(private readonly keep: readonly string[]) {
    this.table = new StatsTable(keep);
  }

  // True when there are new rows.
  async update(): Promise<boolean> {
    if (this.busy) return false;
    this.busy = true;
    try {
      let answer = await readStats(this.bytes);
      if (answer.file !== this.file) {
        // Another file: what was read of the old one may not be in it.
        if (this.bytes > 0) answer = await readStats(0);
        this.table = new StatsTable(this.keep);
        this.file = answer.file;
        this.bytes = 0;
      }
      this.bytes += answer.bytes;
      this.table.append(answer.text);
      return answer.bytes > 0;
    } finally {
      this.busy = false;
    }
  }
}
