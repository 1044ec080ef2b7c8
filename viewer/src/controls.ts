import type { Clock } from "./clock";
import { byId } from "./data";

const STEP = 0.05; // of an arrow key [s]; ten times as much with Shift

/** Play button, slider, speed, and keys for them. */
export function addTimeControls(clock: Clock): void {
  const play = byId("play");
  const slider = byId("time") as HTMLInputElement;
  const speed = byId("speed") as HTMLSelectElement;
  const now = byId("now");
  slider.max = String(clock.end);
  play.addEventListener("click", () => clock.toggle());
  slider.addEventListener("input", () => clock.set(slider.valueAsNumber));
  speed.addEventListener("change", () => {
    clock.speed = Number(speed.value);
  });
  addEventListener("keydown", (event) => press(event, clock));
  const refresh = () => {
    slider.value = String(clock.time);
    slider.setAttribute("aria-valuetext", `${clock.time.toFixed(2)} seconds`);
    now.textContent = `${clock.time.toFixed(2)} s`;
    play.textContent = clock.playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(clock.playing));
  };
  clock.onChange(refresh);
  refresh();
}

function press(event: KeyboardEvent, clock: Clock): void {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const target = event.target as HTMLElement;
  const typing = target.matches("input:not(#time), select, textarea, .scroll");
  if (typing || (event.key === " " && target.matches("button, a, summary"))) return;
  const step = event.shiftKey ? 10 * STEP : STEP;
  const actions: Record<string, () => void> = {
    " ": () => clock.toggle(),
    ArrowLeft: () => clock.set(clock.time - step),
    ArrowRight: () => clock.set(clock.time + step),
    Home: () => clock.set(0),
    End: () => clock.set(clock.end),
  };
  const action = actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}
