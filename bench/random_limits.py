"""Run: make campaign-limits, make campaign-torque-limits.

A thousand random runs per method with the safety inequalities of `tope check` kept, some of them barely:
random start, goal (half of them out of reach), task gains, period, buffers and limit gains. Counts crossed
limits. In torque mode on the rigid-body plant, under the real bounds of joints and wheels, fast approaches
included; there `chain` runs once more with its activations measured on the position, as in the paper.
"""

import argparse
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

import tope

ROOT = Path(__file__).parents[1]
ROBOT = ROOT / "robots/youbot"
STEEPNESS = 1.1383  # kappa of the raised cosine, as `tope check` prints it
Overrides = dict[str, object]


@dataclass
class Outcome:
    """What became of one run."""

    seed: int
    violation: float  # rad or m, negative: distance kept
    moved_in_buffer: bool
    cut_off: int
    clipped: int  # cycles in which the limits alone asked for more than a bound


@dataclass(frozen=True)
class Campaign:
    """What runs in one mode."""

    scenario: Path
    variants: dict[str, Overrides]  # name -> the keys that make it
    sample: Callable[[np.random.Generator, tope.Robot], tuple[float, np.ndarray, Overrides]]


def velocity_sample(random: np.random.Generator, robot: tope.Robot) -> tuple[float, np.ndarray, Overrides]:
    """Period, buffers from barely wide enough to three times that, and the limits' gain."""
    dt = 10 ** random.uniform(-3, -1.7)
    widths = STEEPNESS * dt * robot.velocity_limit * random.uniform(1.001, 3.0, robot.nv)
    return dt, widths, {"limits.gain": random.uniform(0.2, 1.0) * min(1.0 / dt, 50.0)}


def torque_sample(random: np.random.Generator, robot: tope.Robot) -> tuple[float, np.ndarray, Overrides]:
    """The same of torque mode; the gain is what the drives can brake with."""
    dt = 10 ** random.uniform(-3, -2.3)
    return dt, random.uniform(0.05, 0.2, robot.nv), {"limits.servo_gain": random.uniform(5.0, 20.0)}


CAMPAIGNS = {
    "velocity": Campaign(
        ROOT / "scenarios/youbot_velocity.yaml",
        {name: {"limits.method": name} for name in ("unilateral", "chain", "multilinear", "switch")},
        velocity_sample,
    ),
    "torque": Campaign(
        ROOT / "scenarios/youbot_torque.yaml",
        {
            "unilateral": {"limits.method": "unilateral"},
            "chain": {"limits.method": "chain"},
            "chain, measured on the position": {"limits.method": "chain", "limits.measure": "position"},
        },
        torque_sample,
    ),
}


def overrides(seed: int, campaign: Campaign) -> Overrides:
    """One random run."""
    random = np.random.default_rng(seed)
    robot = tope.Robot.from_urdf(ROBOT / "youbot.urdf", ROBOT / "youbot.yaml")
    dt, widths, sampled = campaign.sample(random, robot)
    wall = random.uniform(0.2, 1.0)
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
    return sampled | {
        "dt": dt,
        "duration": 4.0,
        "log.every": 10_000,
        "limits.joints": joints,
        "initial": dict(zip(robot.joint_names, start.tolist(), strict=True)),
        "tasks.orientation.target.quaternion": (quaternion / np.linalg.norm(quaternion)).tolist(),
        "tasks.position.target.position": (random.uniform(-1, 1, 3) * reach).tolist(),
        "tasks.orientation.reference": reference,
        "tasks.position.reference": reference,
    }


def run(seed: int, mode: str, variant: str) -> Outcome:
    """Run the scenario of a seed."""
    campaign = CAMPAIGNS[mode]
    keys = overrides(seed, campaign) | campaign.variants[variant]
    summary = tope.simulate(campaign.scenario, overrides=keys).summary
    return Outcome(
        seed,
        summary["max_limit_violation"]["overall"],
        summary["buffer_time"]["overall"] > 0,
        summary["status_counts"].get("cut_off", 0),
        summary["status_counts"].get("clipped", 0),
    )


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--mode", default="velocity", choices=list(CAMPAIGNS))
    parser.add_argument("--count", type=int, default=1000, help="runs per method")
    parser.add_argument("--seed", type=int, default=1, help="of the first run; run i has seed + i")
    arguments = parser.parse_args()
    table = Table(
        "method", "runs", "entered a buffer", "crossed a limit", "least distance kept", "cut off", "clipped"
    )
    crossed = 0
    with ProcessPoolExecutor() as pool:
        for variant, keys in CAMPAIGNS[arguments.mode].variants.items():
            seeds = range(arguments.seed, arguments.seed + arguments.count)
            task = partial(run, mode=arguments.mode, variant=variant)
            outcomes = list(
                track(
                    pool.map(task, seeds, chunksize=8), total=len(seeds), description=variant, transient=True
                )
            )
            bad = [o.seed for o in outcomes if o.violation > 0]
            crossed += 0 if keys.get("limits.measure") == "position" else len(bad)
            table.add_row(
                variant,
                str(len(outcomes)),
                str(sum(o.moved_in_buffer for o in outcomes)),
                f"{len(bad)}" + (f" (seeds {bad[:5]})" if bad else ""),
                f"{-max(o.violation for o in outcomes):.2e}",
                str(sum(o.cut_off > 0 for o in outcomes)),
                str(sum(o.clipped > 0 for o in outcomes)),
            )
    Console().print(table)
    raise SystemExit(1 if crossed else 0)


if __name__ == "__main__":
    main()
