import type { Clock } from "./clock";
import { byId, type PageData } from "./data";
import { type Curve, Plot, short, type View } from "./plot";
import { paintSwatch, type Runs } from "./runs";
import type { Theme } from "./theme";

/** All panels. One is drawn when it comes into view, and follows the clock while it is there. */
export class Plots implements View {
  range: [number, number] | null = null;
  log = false;
  readonly plots: Plot[];
  private readonly hiddenCurves = new Set<string>();
  private readonly inView = new Set<Plot>();
  private readonly stale = new Set<Plot>();
  private readonly readouts = new Map<Plot, { curve: Curve; output: HTMLElement }[]>();

  constructor(
    private readonly data: PageData,
    readonly clock: Clock,
    private readonly runs: Runs,
    readonly theme: Theme,
  ) {
    this.plots = data.panels.map((panel, i) => {
      const figure = byId(`panel-${i}`);
      const box = figure.querySelector<HTMLElement>(".plot") as HTMLElement;
      const plot = new Plot(panel, box, this, (series) => this.keyOf(i, series));
      this.addLegend(plot, figure);
      return plot;
    });
    this.watch();
    this.addControls();
    clock.onChange(() => this.follow());
    runs.onChange(() => this.redraw());
    theme.onChange(() => this.redraw());
  }

  hidden(key: string): boolean {
    const run = this.data.compares ? this.data.runs.indexOf(key) : -1;
    return this.hiddenCurves.has(key) || (run >= 0 && !this.runs.shown(run));
  }

  zoom(range: [number, number] | null): void {
    this.range = range;
    byId("whole").hidden = range === null;
    this.redraw();
  }

  /** Draws every plot, seen or not: for print. */
  drawAll(): void {
    for (const plot of this.plots) plot.draw();
  }

  private keyOf(panel: number, series: number): string {
    const name = this.data.panels[panel]?.series[series]?.name ?? "";
    return this.data.compares ? name : `${panel} ${name}`;
  }

  /** The curves' names and their values at the clock's time; a click hides a curve. */
  private addLegend(plot: Plot, figure: HTMLElement): void {
    const legend = figure.querySelector(".legend");
    if (!legend || plot.panel.rows.length) return;
    const entries = plot.curves.map((curve) => {
      // on a page that compares, the runs' own buttons hide curves everywhere
      const hides = plot.curves.length > 1 && !this.data.compares;
      const entry = document.createElement(hides ? "button" : "span");
      entry.className = "entry";
      const swatch = document.createElement("i");
      const output = document.createElement("output");
      entry.append(swatch);
      // the runs' buttons stay in view and tell their names
      if (this.data.compares) entry.title = curve.name;
      else if (plot.curves.length > 1) entry.append(curve.name);
      entry.append(output);
      if (hides) {
        entry.setAttribute("aria-pressed", "true");
        entry.addEventListener("click", () => this.toggle(curve, plot, entry));
      }
      this.theme.onChange(() => paintSwatch(swatch, curve.colour, this.theme));
      paintSwatch(swatch, curve.colour, this.theme);
      legend.append(entry);
      return { curve, output };
    });
    this.readouts.set(plot, entries);
  }

  private toggle(curve: Curve, plot: Plot, button: HTMLElement): void {
    if (!this.hiddenCurves.delete(curve.key)) this.hiddenCurves.add(curve.key);
    button.setAttribute("aria-pressed", String(!this.hiddenCurves.has(curve.key)));
    plot.draw();
  }

  private watch(): void {
    const byBox = new Map(this.plots.map((plot) => [plot.box as Element, plot]));
    const seen = new IntersectionObserver(
      (entries) => {
        for (const { target, isIntersecting } of entries) {
          const plot = byBox.get(target) as Plot;
          if (isIntersecting) this.inView.add(plot);
          else this.inView.delete(plot);
          if (isIntersecting && this.stale.has(plot)) this.draw(plot);
          if (isIntersecting) this.followOne(plot);
        }
      },
      { rootMargin: "200px" },
    );
    const sizes = new ResizeObserver((entries) => {
      for (const { target } of entries) this.redraw([byBox.get(target) as Plot]);
    });
    for (const plot of this.plots) {
      this.stale.add(plot);
      seen.observe(plot.box);
      sizes.observe(plot.box);
    }
  }

  private addControls(): void {
    const log = byId("log");
    log.hidden = !this.plots.some(({ panel }) => panel.log);
    log.addEventListener("click", () => {
      this.log = !this.log;
      log.setAttribute("aria-pressed", String(this.log));
      this.redraw(this.plots.filter(({ panel }) => panel.log));
    });
    byId("whole").addEventListener("click", () => this.zoom(null));
    addEventListener("beforeprint", () => this.drawAll());
  }

  private redraw(plots: Plot[] = this.plots): void {
    for (const plot of plots) {
      if (this.inView.has(plot)) this.draw(plot);
      else this.stale.add(plot);
    }
  }

  private draw(plot: Plot): void {
    this.stale.delete(plot);
    plot.draw();
  }

  private follow(): void {
    for (const plot of this.inView) this.followOne(plot);
  }

  private followOne(plot: Plot): void {
    plot.follow();
    for (const { curve, output } of this.readouts.get(plot) ?? []) {
      const value = this.hidden(curve.key) ? null : Plot.value(curve, this.clock.time);
      output.textContent = value === null || Number.isNaN(value) ? "" : short(value);
    }
  }
}
