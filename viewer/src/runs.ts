import { byId, type PageData } from "./data";
import { dash, type Theme } from "./theme";

/** Which runs are shown, and whose robot is in front. */
export class Runs {
  front = 0;
  ghosts = false;
  private readonly hidden = new Set<number>();
  private readonly listeners: (() => void)[] = [];

  constructor(readonly names: string[]) {}

  get count(): number {
    return this.names.length;
  }

  shown(run: number): boolean {
    return !this.hidden.has(run);
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  toggle(run: number): void {
    if (!this.hidden.delete(run)) this.hidden.add(run);
    if (!this.shown(this.front)) {
      const first = this.names.findIndex((_, i) => this.shown(i));
      if (first >= 0) this.front = first;
    }
    this.tell();
  }

  putInFront(run: number): void {
    this.front = run;
    this.hidden.delete(run);
    this.tell();
  }

  showGhosts(show: boolean): void {
    this.ghosts = show;
    this.tell();
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}

/** Buttons that show and hide runs, and the choice of the robot in front. */
export function addRunControls(data: PageData, runs: Runs, theme: Theme): void {
  if (!data.compares) return;
  const buttons = runs.names.map((name, run) => {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "key";
    const swatch = document.createElement("i");
    button.append(swatch, name);
    button.addEventListener("click", () => runs.toggle(run));
    return button;
  });
  byId("runs").append(...buttons);
  const front = byId("front") as HTMLSelectElement;
  front.append(...runs.names.map((name, run) => new Option(name, String(run))));
  front.addEventListener("change", () => runs.putInFront(Number(front.value)));
  const ghosts = byId("ghosts") as HTMLInputElement;
  ghosts.addEventListener("change", () => runs.showGhosts(ghosts.checked));
  const refresh = () => {
    buttons.forEach((button, run) => {
      button.setAttribute("aria-pressed", String(runs.shown(run)));
      paintSwatch(button.firstElementChild as HTMLElement, run, theme);
    });
    front.value = String(runs.front);
  };
  runs.onChange(refresh);
  theme.onChange(refresh);
  refresh();
}

export function paintSwatch(swatch: HTMLElement, colour: number | "grey" | "ink", theme: Theme): void {
  swatch.style.borderTopColor = theme.curve(colour);
  const [on] = dash(colour);
  swatch.style.borderTopStyle = on === undefined ? "solid" : on > 2 ? "dashed" : "dotted";
}
