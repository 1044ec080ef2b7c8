import type { Clock } from "./clock";
import type { Plots } from "./plots";
import type { Runs } from "./runs";
import type { Stage } from "./stage";

/**
 * What tests and scripts may ask the page: `window.tope`. Runs are counted from 0.
 */
export interface Handle {
  /** The moment shown [s]. */
  time(): number;
  setTime(time: number): void;
  playing(): boolean;
  /** World position [m] and quaternion (x, y, z, w) of a link's frame; null without 3D. */
  linkPose(link: string, run?: number): { position: number[]; quaternion: number[] } | null;
  /** World position [m] of the goal of a frame; null if no task is about it. */
  goalPosition(frame: string): number[] | null;
  /** Times under the cursors of the plots that are drawn [s]. */
  cursorTimes(): number[];
  /** The part of the run that the plots show [s]. */
  plotRange(): [number, number];
  shownRuns(): string[];
  frontRun(): string;
}

declare global {
  interface Window {
    tope: Handle;
  }
}

export function makeHandle(clock: Clock, plots: Plots, runs: Runs, stage: Stage | null): Handle {
  return {
    time: () => clock.time,
    setTime: (time) => clock.set(time),
    playing: () => clock.playing,
    linkPose: (link, run = runs.front) => {
      if (!stage) return null;
      const robot = stage.robot(run);
      return { position: robot.position(link).toArray(), quaternion: robot.quaternion(link).toArray() };
    },
    goalPosition: (frame) => stage?.goalPosition(frame)?.toArray() ?? null,
    cursorTimes: () => plots.plots.map((plot) => plot.cursorTime()).filter((time) => time !== null),
    plotRange: () => plots.range ?? [0, clock.end],
    shownRuns: () => runs.names.filter((_, run) => runs.shown(run)),
    frontRun: () => runs.names[runs.front] ?? "",
  };
}
