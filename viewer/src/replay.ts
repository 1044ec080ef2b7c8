import { Quaternion, Vector3 } from "three";
import { floats, type GoalData, type ReplayData } from "./data";

/** Rows of numbers over time, read at any moment. */
class Track {
  private readonly row: Float32Array;

  constructor(
    private readonly values: Float32Array,
    private readonly width: number,
  ) {
    this.row = new Float32Array(width);
  }

  get rows(): number {
    return this.values.length / this.width;
  }

  /** The row at a fractional number, linear in between; valid until the next call. */
  at(frame: number): Float32Array {
    const first = Math.max(0, Math.min(this.rows - 1, Math.floor(frame)));
    const second = Math.min(this.rows - 1, first + 1);
    const share = Math.max(0, Math.min(1, frame - first));
    for (let i = 0; i < this.width; i++) {
      const a = this.values[first * this.width + i] as number;
      const b = this.values[second * this.width + i] as number;
      this.row[i] = a + share * (b - a);
    }
    return this.row;
  }
}

export class Goal {
  readonly frame: string;
  private readonly positions: Track;
  private readonly quaternions: Track | null;

  constructor(data: GoalData) {
    this.frame = data.frame;
    this.positions = new Track(floats(data.position), 3);
    this.quaternions = data.quaternion === null ? null : new Track(floats(data.quaternion), 4);
  }

  position(frame: number): Vector3 {
    return new Vector3().fromArray(this.positions.at(frame));
  }

  /** None if no task turns the frame. */
  quaternion(frame: number): Quaternion | null {
    return this.quaternions && new Quaternion().fromArray(this.quaternions.at(frame)).normalize();
  }
}

/** One run's motion. */
export class Replay {
  readonly goals: Goal[];
  /** Rows of x, y, z. */
  readonly trace: Float32Array;
  private readonly step: number;
  private readonly positionTrack: Track;
  private readonly activationTrack: Track;

  constructor(data: ReplayData, joints: number) {
    this.step = data.step;
    this.goals = data.goals.map((goal) => new Goal(goal));
    this.trace = floats(data.trace);
    this.positionTrack = new Track(floats(data.positions), joints);
    this.activationTrack = new Track(floats(data.activations), joints);
  }

  /** The fractional number of the frame at a time [s]. */
  frame(time: number): number {
    return this.step > 0 ? time / this.step : 0;
  }

  positions(time: number): Float32Array {
    return this.positionTrack.at(this.frame(time));
  }

  activations(time: number): Float32Array {
    return this.activationTrack.at(this.frame(time));
  }
}
