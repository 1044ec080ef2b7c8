import uPlot from "uplot";
import type { Clock } from "./clock";
import { floats, type PanelData } from "./data";
import { dash, type Theme } from "./theme";

export interface Curve {
  name: string;
  colour: number | "grey" | "ink";
  /** What hides and shows it: the run on a page that compares, or its place in the panel. */
  key: string;
  width: number;
  x: Float32Array;
  y: Float32Array;
}

/** What all plots share. */
export interface View {
  clock: Clock;
  theme: Theme;
  /** The part of the run that is shown [s]; null for all of it. */
  range: [number, number] | null;
  log: boolean;
  hidden(key: string): boolean;
  zoom(range: [number, number] | null): void;
}

const HEIGHT = 168;
const ROW = 20; // of a strip [px]

/** One panel: its curves, limits and marks, and a line at the clock's time. */
export class Plot {
  readonly curves: Curve[];
  private chart: uPlot | null = null;

  constructor(
    readonly panel: PanelData,
    readonly box: HTMLElement,
    private readonly view: View,
    keyOf: (series: number) => string,
  ) {
    this.curves = panel.series.map((series, i) => ({
      ...series,
      key: keyOf(i),
      x: floats(series.x),
      y: floats(series.y),
    }));
  }

  /** Builds the plot anew: after a change of theme, size, scale or what is hidden. */
  draw(): void {
    this.chart?.destroy();
    this.chart = new uPlot(this.options(), this.data(), this.box);
  }

  /** Moves the cursor to the clock's time. */
  follow(): void {
    if (!this.chart) return;
    const left = this.chart.valToPos(this.view.clock.time, "x");
    if (Number.isFinite(left)) this.chart.setCursor({ left, top: 0 }, false);
  }

  /** Time under the cursor [s]. */
  cursorTime(): number | null {
    const left = this.chart?.cursor.left;
    return this.chart && left !== undefined && left >= 0 ? this.chart.posToVal(left, "x") : null;
  }

  /** A curve's value at a time, from the last point before it. */
  static value(curve: Curve, time: number): number | null {
    let low = 0;
    let high = curve.x.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((curve.x[middle] as number) <= time + 1e-6) low = middle + 1;
      else high = middle;
    }
    const [x0, x1] = [curve.x[low - 1], curve.x[low]];
    const [y0, y1] = [curve.y[low - 1], curve.y[low]];
    if (x0 === undefined || y0 === undefined) return null;
    if (x1 === undefined || y1 === undefined || x1 <= x0) return y0;
    return y0 + ((time - x0) / (x1 - x0)) * (y1 - y0);
  }

  private get strips(): boolean {
    return this.panel.rows.length > 0;
  }

  private get log(): boolean {
    return this.panel.log && this.view.log;
  }

  private shown(): Curve[] {
    return this.curves.filter((curve) => !this.view.hidden(curve.key));
  }

  private data(): uPlot.AlignedData {
    if (this.strips)
      return [
        [0, this.view.clock.end],
        [null, null],
      ];
    const shown = this.shown();
    if (!shown.length)
      return [
        [0, this.view.clock.end],
        [null, null],
      ];
    const tables = shown.map(({ x, y }): uPlot.AlignedData => {
      const drawn = Array.from(y, (value) =>
        Number.isFinite(value) && (!this.log || value > 0) ? value : null,
      );
      return [Array.from(x), drawn];
    });
    return uPlot.join(tables);
  }

  private options(): uPlot.Options {
    const { theme, clock } = this.view;
    const { palette } = theme;
    const axis = {
      stroke: palette.text,
      grid: { stroke: palette.grid, width: 1 },
      ticks: { stroke: palette.grid, width: 1, size: 4 },
      font: "11px system-ui, sans-serif",
    };
    const shown = this.shown();
    const series = this.strips || !shown.length ? [{}] : shown.map((curve) => this.style(curve));
    const labels: uPlot.Axis = this.strips
      ? {
          splits: () => this.panel.rows.map((_, i) => i),
          values: () => [...this.panel.rows],
          size: this.labelWidth(),
        }
      : { size: 52, values: (_, splits) => splits.map((value) => (value === null ? "" : short(value))) };
    return {
      width: Math.max(120, this.box.clientWidth),
      height: this.strips ? 40 + ROW * this.panel.rows.length : HEIGHT,
      legend: { show: false },
      padding: [8, 10, 0, 0],
      focus: { alpha: 1 },
      scales: {
        x: { time: false, range: () => this.view.range ?? [0, Math.max(clock.end, 1e-9)] },
        y: this.log
          ? { distr: 3 }
          : { range: () => (this.strips ? [this.panel.rows.length - 0.5, -0.5] : this.extent()) },
      },
      axes: [
        { ...axis, size: 28, values: (_, splits) => splits.map((t) => `${short(t)}`) },
        { ...axis, ...labels },
      ],
      series: [{}, ...series],
      cursor: {
        y: false,
        drag: { x: true, y: false, setScale: false, dist: 6 },
        points: { show: false },
        bind: {
          dblclick: () => () => {
            this.view.zoom(null);
            return null;
          },
          mouseleave: () => () => null,
        },
      },
      hooks: {
        drawClear: [(u) => this.drawBands(u)],
        draw: [(u) => this.drawOver(u)],
        ready: [(u) => this.ready(u)],
        setSelect: [(u) => this.selected(u)],
      },
    };
  }

  private labelWidth(): number {
    const longest = Math.max(...this.panel.rows.map((row) => row.length));
    return Math.min(0.45 * this.box.clientWidth, 14 + 6.2 * longest);
  }

  private style(curve: Curve): uPlot.Series {
    return {
      stroke: this.view.theme.curve(curve.colour),
      width: curve.width,
      dash: dash(curve.colour),
      points: { show: false },
      alpha: curve.width > 3 ? 0.45 : 1,
    };
  }

  /** Least and greatest value in view, with the lines that the curves come near to. */
  private extent(): [number, number] {
    const [from, to] = this.view.range ?? [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY];
    let low = Number.POSITIVE_INFINITY;
    let high = Number.NEGATIVE_INFINITY;
    for (const { x, y } of this.shown()) {
      for (let i = 0; i < y.length; i++) {
        // neighbours of the window count: lines lead there
        const outside =
          (x[i + 1] ?? Number.POSITIVE_INFINITY) < from || (x[i - 1] ?? Number.NEGATIVE_INFINITY) > to;
        const value = y[i] as number;
        if (outside || !Number.isFinite(value)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    if (low > high) return [-1, 1];
    const reach = Math.max(high - low, this.panel.near);
    for (const value of this.panel.lines) {
      if (value >= high && value - high <= reach) high = value;
      if (value <= low && low - value <= reach) low = value;
    }
    const pad = Math.max(0.06 * (high - low), 1e-6);
    return [low - pad, high + pad];
  }

  /** From now on the clock follows the pointer, unless it plays. */
  private ready(u: uPlot): void {
    const follow = ({ offsetX }: MouseEvent) => {
      if (!this.view.clock.playing) this.view.clock.set(u.posToVal(offsetX, "x"));
    };
    u.over.addEventListener("mousemove", follow);
    u.over.addEventListener("click", follow);
    this.follow();
  }

  private selected(u: uPlot): void {
    if (u.select.width < 6) return;
    const { left, width } = u.select;
    const range: [number, number] = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.view.zoom(range);
  }

  /** Buffers, behind the curves. */
  private drawBands(u: uPlot): void {
    u.ctx.save();
    clip(u);
    u.ctx.fillStyle = this.view.theme.palette.band;
    for (const [from, to] of this.panel.bands) {
      const [a, b] = [u.valToPos(from, "y", true), u.valToPos(to, "y", true)];
      u.ctx.fillRect(u.bbox.left, Math.min(a, b), u.bbox.width, Math.abs(b - a));
    }
    u.ctx.restore();
  }

  /** Limits, strips, and the times at which a task is due. */
  private drawOver(u: uPlot): void {
    const { palette } = this.view.theme;
    const { ctx } = u;
    ctx.save();
    clip(u);
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([]); // of the last curve
    ctx.strokeStyle = palette.limit;
    for (const value of this.panel.lines) {
      const y = u.valToPos(value, "y", true);
      line(ctx, u.bbox.left, y, u.bbox.left + u.bbox.width, y);
    }
    ctx.strokeStyle = palette.text;
    ctx.fillStyle = palette.text;
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    for (const [time, label] of this.panel.marks) {
      const x = u.valToPos(time, "x", true);
      ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
      line(ctx, x, u.bbox.top, x, u.bbox.top + u.bbox.height);
      ctx.setLineDash([]);
      ctx.fillText(label, x + 4 * devicePixelRatio, u.bbox.top + 12 * devicePixelRatio);
    }
    if (this.strips) this.drawStrips(u);
    ctx.restore();
  }

  private drawStrips(u: uPlot): void {
    const thick = 0.55 * ROW * devicePixelRatio;
    for (const { x, y, colour } of this.shown()) {
      u.ctx.fillStyle = this.view.theme.curve(colour);
      for (let i = 0; i + 1 < x.length; i += 3) {
        const [from, to] = [u.valToPos(x[i] as number, "x", true), u.valToPos(x[i + 1] as number, "x", true)];
        u.ctx.fillRect(from, u.valToPos(y[i] as number, "y", true) - thick / 2, to - from, thick);
      }
    }
  }
}

function clip(u: uPlot): void {
  u.ctx.beginPath();
  u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  u.ctx.clip();
}

function line(ctx: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}

/** Few digits, no trailing zeros. */
export function short(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5))
    return value.toExponential(size < 1e-9 ? 0 : 1).replace(".0e", "e");
  return String(Number(value.toPrecision(4)));
}
