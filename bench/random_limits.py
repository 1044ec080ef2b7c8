"""Run: make campaign-limits.

A thousand random runs per method with the safety inequalities of `tope check` kept, some of them barely:
random start, goal (half of them out of reach), task gains, period, buffers and limit gains. Counts crossed
limits.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

import tope

SCENARIO = Path(__file__).parents[1] / "scenarios/youbot_velocity.yaml"
ROBOT = Path(__file__).parents[1] / "robots/youbot"
STEEPNESS = 1.1383  # kappa of the raised cosine, as `tope check` prints it
METHODS = ("unilateral", "chain", "multilinear", "switch")


@dataclass
class Outcome:
    """What became of one run."""

    seed: int
    violation: float  # rad or m, negative: distance kept
    moved_in_buffer: bool
    cut_off: int


def overrides(seed: int, method: str) -> dict[str, object]:
    """One random run."""
    random = np.random.default_rng(seed)
    robot = tope.Robot.from_urdf(ROBOT / "youbot.urdf", ROBOT / "youbot.yaml")
    dt = 10 ** random.uniform(-3, -1.7)
    wall = random.uniform(0.2, 1.0)
    # buffers from barely wide enough to three times that
    widths = STEEPNESS * dt * robot.velocity_limit * random.uniform(1.001, 3.0, robot.nv)
    lower = np.maximum(robot.position_lower, -1.0)
    upper = np.minimum(robot.position_upper, wall)
    start = random.uniform(lower + widths, upper - widths)
    reach = 0.6 if random.random() < 0.5 else 3.0
    quaternion = random.standard_normal(4)
    reference = {"type": "exponential", "gain": random.uniform(0.5, 20.0)}
    if random.random() < 0.5:
        reference = {"type": "predefined_time", "duration": random.uniform(0.3, 3.0), "gain": 2.0}
    joints = {name: {"buffer": float(width)} for name, width in zip(robot.joint_names, widths, strict=True)}
    joints["base_x"]["upper"] = wall
    return {
        "dt": dt,
        "duration": 4.0,
        "log.every": 10_000,
        "limits.method": method,
        "limits.gain": random.uniform(0.2, 1.0) * min(1.0 / dt, 50.0),
        "limits.joints": joints,
        "initial": dict(zip(robot.joint_names, start.tolist(), strict=True)),
        "tasks.orientation.target.quaternion": (quaternion / np.linalg.norm(quaternion)).tolist(),
        "tasks.position.target.position": (random.uniform(-1, 1, 3) * reach).tolist(),
        "tasks.orientation.reference": reference,
        "tasks.position.reference": reference,
    }


def run(seed: int, method: str) -> Outcome:
    """Run the scenario of a seed."""
    summary = tope.simulate(SCENARIO, overrides=overrides(seed, method)).summary
    return Outcome(
        seed,
        summary["max_limit_violation"]["overall"],
        summary["buffer_time"]["overall"] > 0,
        summary["status_counts"].get("cut_off", 0),
    )


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=1000, help="runs per method")
    parser.add_argument("--seed", type=int, default=1, help="of the first run; run i has seed + i")
    arguments = parser.parse_args()
    table = Table(
        "method", "runs", "entered a buffer", "crossed a limit", "least distance kept", "cycles cut off"
    )
    crossed = 0
    with ProcessPoolExecutor() as pool:
        for method in METHODS:
            seeds = range(arguments.seed, arguments.seed + arguments.count)
            results = pool.map(partial(run, method=method), seeds, chunksize=8)
            outcomes = list(track(results, total=len(seeds), description=method, transient=True))
            bad = [o.seed for o in outcomes if o.violation > 0]
            crossed += len(bad)
            table.add_row(
                method,
                str(len(outcomes)),
                str(sum(o.moved_in_buffer for o in outcomes)),
                f"{len(bad)}" + (f" (seeds {bad[:5]})" if bad else ""),
                f"{-max(o.violation for o in outcomes):.2e}",
                str(sum(o.cut_off for o in outcomes)),
            )
    Console().print(table)
    raise SystemExit(1 if crossed else 0)


if __name__ == "__main__":
    main()
