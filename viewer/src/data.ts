/** What the page holds: written by python/tope/report.py and scene.py, in metres, radians and seconds. */

/** Little-endian 32-bit floats in base64. */
export type Packed = string;

/** A place in the palette of curves, or a named colour. */
export type ColourName = number | "grey" | "ink";

export interface SeriesData {
  name: string;
  colour: ColourName;
  width: number;
  x: Packed;
  y: Packed;
}

/** One plot over time. */
export interface PanelData {
  title: string;
  unit: string;
  series: SeriesData[];
  lines: number[];
  bands: [number, number][];
  marks: [number, string][];
  near: number;
  /** Names of strips, if the curves are strips: their y is the row's number, NaN ends a stretch. */
  rows: string[];
  log: boolean;
}

export type Triple = [number, number, number];
/** x, y, z, w */
export type Quaternion = [number, number, number, number];

export interface VisualData {
  shape: "box" | "cylinder" | "sphere";
  /** box: edges; cylinder: radius, length; sphere: radius */
  size: number[];
  xyz: Triple;
  quaternion: Quaternion;
  colour: Triple;
}

export interface LinkData {
  name: string;
  visuals: VisualData[];
}

export interface JointData {
  name: string;
  type: "fixed" | "revolute" | "continuous" | "prismatic";
  parent: string;
  child: string;
  xyz: Triple;
  quaternion: Quaternion;
  axis: Triple;
  /** Position of a joint that never moves. */
  locked: number;
}

export interface GoalData {
  frame: string;
  /** Rows of x, y, z: one for each frame of the replay, or one for all. */
  position: Packed;
  /** Rows of x, y, z, w likewise; null if no task turns the frame. */
  quaternion: Packed | null;
}

export interface ReplayData {
  frames: number;
  /** Time between frames. */
  step: number;
  /** frames x joints, in the order of SceneData.joints */
  positions: Packed;
  /** frames x joints: how far a limit acts, 0 to 1; negative for a lower limit. */
  activations: Packed;
  goals: GoalData[];
  /** Path of the first frame that a task is about, rows of x, y, z; empty if there is none. */
  trace: Packed;
}

/** Something in the way of a joint, drawn where the robot would meet it. */
export interface ObstacleData {
  joint: string;
  side: "lower" | "upper";
  /** Of the joint [m]. */
  limit: number;
  /** From the robot to the obstacle, of length 1. */
  direction: Triple;
  label: string;
  size: Triple;
  xyz: Triple;
}

export interface SceneData {
  joints: string[];
  links: LinkData[];
  tree: JointData[];
  /** How many shapes of the robot are meshes, which are left out. */
  meshes: number;
  obstacles: ObstacleData[];
  runs: ReplayData[];
}

export interface PageData {
  /** Names of the runs, in the order of the palette. */
  runs: string[];
  compares: boolean;
  /** Length of the longest run. */
  end: number;
  panels: PanelData[];
  /** None if the robot cannot be drawn. */
  scene: SceneData | null;
}

export function floats(text: Packed): Float32Array {
  return new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

export function readPage(): PageData {
  return JSON.parse(byId("data").textContent ?? "");
}

export function byId(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element #${id}`);
  return found;
}
