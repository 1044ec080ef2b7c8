import { Clock } from "./clock";
import { addTimeControls } from "./controls";
import { byId, type PageData, readPage } from "./data";
import { makeHandle } from "./handle";
import { Plots } from "./plots";
import { addRunControls, Runs } from "./runs";
import { Stage } from "./stage";
import { Theme } from "./theme";

const data = readPage();
const clock = new Clock(data.end);
const runs = new Runs(data.runs);
const theme = new Theme();
const stage = openStage(data);
const plots = new Plots(data, clock, runs, theme);
addTimeControls(clock);
addRunControls(data, runs, theme);
if (stage) {
  byId("look").addEventListener("click", () => stage.lookAtAll());
  const tell = () => sayActing(stage, data);
  clock.onChange(tell);
  runs.onChange(tell);
  tell();
}
window.tope = makeHandle(clock, plots, runs, stage);

/** The replay, or a sentence why there is none. */
function openStage(page: PageData): Stage | null {
  if (!page.scene) return null;
  const box = byId("stage");
  try {
    return new Stage(box, page.scene, clock, runs, theme);
  } catch (error) {
    box.replaceChildren(`The replay needs WebGL, which this browser does not offer: ${String(error)}`);
    box.classList.add("without");
    return null;
  }
}

/** The limits that act at the moment shown. */
function sayActing(from: Stage, page: PageData): void {
  const joints = page.scene?.joints ?? [];
  const acting = Array.from(from.activations(), (value, i) => ({ value, joint: joints[i] as string }))
    .filter(({ value }) => Math.abs(value) > 0.005)
    .map(
      ({ value, joint }) =>
        `${joint} ${value > 0 ? "upper" : "lower"} ${Math.round(100 * Math.abs(value))} %`,
    );
  byId("acting").textContent = acting.length ? `Limits that act: ${acting.join(", ")}` : "No limit acts";
}
