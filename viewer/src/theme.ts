import { byId, type ColourName } from "./data";

export interface Palette {
  curves: string[];
  grey: string;
  ink: string;
  text: string;
  grid: string;
  limit: string;
  band: string;
  now: string;
  stage: string;
  floor: string;
  acting: string;
  obstacle: string;
  trace: string;
}

// Curves: Okabe and Ito's palette, with the yellow and the black replaced where they would not show.
const palettes: Record<"light" | "dark", Palette> = {
  light: {
    curves: ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#1c1f23", "#8a7a00"],
    grey: "#949aa1",
    ink: "#1c1f23",
    text: "#5a6068",
    grid: "#e9ebee",
    limit: "#b3261e",
    band: "rgba(230,159,0,0.16)",
    now: "#1c1f23",
    stage: "#eef1f4",
    floor: "#c3cad1",
    acting: "#d55e00",
    obstacle: "#56789a",
    trace: "#0072b2",
  },
  dark: {
    curves: ["#4aa3df", "#f0803c", "#2cc79a", "#e39cc4", "#f2b134", "#a9dcf7", "#eceef0", "#f0e442"],
    grey: "#8b929a",
    ink: "#ffffff",
    text: "#a4abb3",
    grid: "#272d34",
    limit: "#ff8a80",
    band: "rgba(242,177,52,0.18)",
    now: "#e8eaed",
    stage: "#1d2228",
    floor: "#3c444d",
    acting: "#ff7a1f",
    obstacle: "#7f9fbe",
    trace: "#4aa3df",
  },
};

/** Light or dark: as the system is, until the reader chooses. */
export class Theme {
  private readonly root = document.documentElement;
  private readonly listeners: (() => void)[] = [];

  constructor() {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.use(dark.matches ? "dark" : "light"));
    byId("theme").addEventListener("click", () => this.use(this.name === "dark" ? "light" : "dark"));
    this.use(this.name);
  }

  get name(): "light" | "dark" {
    return this.root.dataset.theme === "dark" ? "dark" : "light";
  }

  get palette(): Palette {
    return palettes[this.name];
  }

  curve(name: ColourName): string {
    const { curves } = this.palette;
    return typeof name === "number" ? (curves[name % curves.length] as string) : this.palette[name];
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  private use(name: "light" | "dark"): void {
    this.root.dataset.theme = name;
    const button = byId("theme");
    button.textContent = name === "dark" ? "Light" : "Dark";
    for (const listener of this.listeners) listener();
  }
}

/** The ninth curve and later ones repeat the colours; a pattern tells them apart. */
export function dash(name: ColourName): number[] {
  if (typeof name !== "number" || name < 4) return [];
  return name < 8 ? [7, 3] : [2, 2];
}
