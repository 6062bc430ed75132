import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { StatsTable } from './stats';

interface Line {
  column: string;
  name: string;
  colour: string; // a variable of style.css
  scale?: number;
}

interface Plot {
  title: string;
  unit: string;
  lines: Line[];
}

const plots: Plot[] = [
  {
    title: 'Iterations',
    unit: '',
    lines: [
      { column: 'iterations', name: 'iterations', colour: '--line-1' },
      { column: 'bound_iterations', name: 'bound', colour: '--line-5' },
    ],
  },
  {
    title: 'Time a step',
    unit: 'ms',
    lines: [
      { column: 'step_ms', name: 'step', colour: '--line-5' },
      { column: 'assemble_ms', name: 'assembly', colour: '--line-3' },
      { column: 'factor_ms', name: 'factor', colour: '--line-4' },
      { column: 'solve_ms', name: 'solve', colour: '--line-1' },
      { column: 'contact_ms', name: 'contact', colour: '--line-2' },
    ],
  },
  {
    title: 'Energy',
    unit: 'J',
    lines: [
      { column: 'kinetic_J', name: 'kinetic', colour: '--line-1' },
      { column: 'elastic_J', name: 'elastic', colour: '--line-2' },
    ],
  },
  { title: 'Largest stretch', unit: '%', lines: [{ column: 'max_stretch', name: 'stretch', colour: '--line-2', scale: 100 }] },
  { title: 'Contacts', unit: '', lines: [{ column: 'contacts', name: 'contacts', colour: '--line-4' }] },
];

export const plottedColumns = ['time', 'frame', ...plots.flatMap((plot) => plot.lines.map((line) => line.column))];

const style = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function shown(value: number | null | undefined): string {
  if (value == null) return '–';
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(1) : String(Number(value.toPrecision(3)));
}

// Short numbers on an axis: 0.0002 is 2e-4.
const tickText = (value: number | null) =>
  value == null ? '' : value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5) ? value.toExponential(0) : String(Number(value.toPrecision(6)));

// One plot: title with the values at the playhead, curves, playhead.
class PlotView {
  private readonly values: HTMLElement[] = [];
  private readonly playhead = document.createElement('div');
  private readonly chart: uPlot;
  private time = 0;

  constructor(
    holder: HTMLElement,
    private readonly plot: Plot,
    table: StatsTable,
    width: number,
    lastTime: number,
    private readonly lowest: boolean, // it bears the axis of time for all
    jump: (time: number) => void,
  ) {
    const figure = document.createElement('figure');
    figure.setAttribute('aria-label', plot.title + (plot.unit ? `, ${plot.unit}` : ''));
    figure.append(this.caption());
    holder.append(figure);
    this.chart = new uPlot(this.options(width, lastTime), this.data(table), figure);
    this.playhead.className = 'playhead';
    this.chart.over.append(this.playhead);
    this.jumpOnClick(jump);
  }

  private caption(): HTMLElement {
    const caption = document.createElement('figcaption');
    const title = document.createElement('span');
    title.className = 'plot-title';
    title.textContent = this.plot.title + (this.plot.unit ? `, ${this.plot.unit}` : '');
    caption.append(title);
    for (const line of this.plot.lines) {
      const entry = document.createElement('span');
      entry.className = 'entry';
      entry.style.setProperty('--colour', `var(${line.colour})`);
      const value = document.createElement('span');
      value.className = 'value';
      entry.append(this.plot.lines.length > 1 ? line.name + ' ' : '', value);
      this.values.push(value);
      caption.append(entry);
    }
    return caption;
  }

  private options(width: number, lastTime: number): uPlot.Options {
    const axis = { stroke: style('--faint'), grid: { stroke: style('--grid'), width: 1 }, ticks: { show: false }, font: '11px system-ui, sans-serif' };
    return {
      width,
      height: this.lowest ? 122 : 102,
      padding: [6, 8, 0, 0],
      legend: { show: false },
      cursor: { y: false, points: { show: false }, drag: { x: false, y: false } },
      scales: { x: { time: false, range: (_, low, high) => [0, Math.max(lastTime, high ?? 0, low ?? 0) || 1] }, y: { range: (_, low, high) => [Math.min(0, low ?? 0), high > 0 ? high * 1.08 : 1] } },
      axes: [
        { ...axis, size: this.lowest ? 22 : 4, gap: 3, space: 60, values: (_, ticks) => ticks.map((tick) => (this.lowest && tick > 0 ? `${tickText(tick)} s` : '')) },
        { ...axis, size: 44, gap: 4, space: 28, values: (_, ticks) => ticks.map(tickText) },
      ],
      series: [{}, ...this.plot.lines.map((line) => ({ stroke: style(line.colour), width: 1.5, points: { show: false } }))],
    };
  }

  private data(table: StatsTable): uPlot.AlignedData {
    const scaled = (line: Line) => {
      const column = table.column(line.column);
      return line.scale ? column.map((value) => (value == null ? null : value * (line.scale as number))) : column;
    };
    const times = table.column('time') as number[];
    const empty = times.map(() => null);
    return [times, ...this.plot.lines.map((line) => (table.columns.has(line.column) ? scaled(line) : empty))];
  }

  private jumpOnClick(jump: (time: number) => void) {
    const over = this.chart.over;
    const go = (event: PointerEvent) => jump(this.chart.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'));
    over.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      go(event);
    });
    over.addEventListener('pointermove', (event) => {
      if (over.hasPointerCapture(event.pointerId)) go(event);
    });
  }

  setData(table: StatsTable) {
    this.chart.setData(this.data(table));
    queueMicrotask(() => this.setTime(this.time, table));
  }

  setTime(time: number, table: StatsTable) {
    this.time = time;
    this.playhead.style.transform = `translateX(${this.chart.valToPos(time, 'x').toFixed(1)}px)`;
    const row = table.rowAt(time);
    this.plot.lines.forEach((line, k) => {
      const value = row < 0 ? null : table.column(line.column)[row];
      this.values[k].textContent = shown(value == null ? null : value * (line.scale ?? 1));
    });
  }

  setWidth(width: number, table: StatsTable) {
    this.chart.setSize({ width, height: this.chart.height });
    queueMicrotask(() => this.setTime(this.time, table));
  }

  destroy() {
    this.chart.destroy();
  }
}

// The side panel.
export class PlotPanel {
  private views: PlotView[] = [];
  private table: StatsTable | null = null;
  private time = 0;
  private lastTime = 0;
  jump: (time: number) => void = () => {};

  constructor(private readonly holder: HTMLElement) {
    new ResizeObserver(() => {
      if (this.table) for (const view of this.views) view.setWidth(this.width(), this.table);
    }).observe(holder);
  }

  private width() {
    return Math.max(160, this.holder.clientWidth - 24);
  }

  // `lastTime`: when the run will end, s; 0 when that is not known.
  show(table: StatsTable, lastTime: number) {
    const rebuild = this.table !== table || this.lastTime !== lastTime || this.views.length === 0;
    this.table = table;
    this.lastTime = lastTime;
    if (rebuild) this.build();
    else for (const view of this.views) view.setData(table);
  }

  // Anew, in the colours of the theme.
  build() {
    for (const view of this.views) view.destroy();
    this.views = [];
    this.holder.replaceChildren();
    const table = this.table;
    if (!table || table.rows === 0) {
      const text = document.createElement('p');
      text.className = 'faint';
      text.textContent = 'No step has been recorded yet.';
      this.holder.append(text);
      return;
    }
    const width = this.width();
    this.views = plots.map((plot, k) => new PlotView(this.holder, plot, table, width, this.lastTime, k === plots.length - 1, (time) => this.jump(time)));
    // uPlot lays itself out a microtask later; before, no time has a place.
    queueMicrotask(() => this.setTime(this.time));
  }

  setTime(time: number) {
    this.time = time;
    if (this.table) for (const view of this.views) view.setTime(time, this.table);
  }
}
