"""Run: make campaign-torque-goals.

A hundred random goals in torque mode (seed 42), many of them out of reach because the base is blocked: does
the largest jump of the torques fall with dt? Ten times shorter cycles divide the largest jump of a continuous
command by ten.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.spatial.transform import Rotation

import tope
from tope import words

SCENARIO = Path(__file__).parent / "goals_torque.yaml"
START_POSITION = np.array([0.596, 0.0, 0.354])  # of ee at the scenario's start [m]
REACHED = 1e-3  # m and rad
CONTINUOUS = 8.0  # ratio of the largest jumps at dt and dt / 10 from which a command counts as continuous
FAR = 2.2  # rad; rotations beyond it may come near the flip at pi
METHODS = ("unilateral", "chain", "switch", "paper", "intermediate")


@dataclass
class Outcome:
    """What became of one goal under one method."""

    goal: int
    orientation_error: float  # rad
    position_error: float  # m
    limit_violation: float  # rad or m, negative: distance kept
    in_buffer: float  # s
    clipped: int  # cycles
    jump: float  # share of the torque bound
    fine_jump: float

    @property
    def ratio(self) -> float:
        """Of the largest jumps at dt and dt / 10."""
        return self.jump / self.fine_jump


def target(goal: int) -> dict[str, list[float]]:
    """A random pose: a box before the robot, rotations up to FAR from the start's."""
    random = np.random.default_rng([42, goal])
    start = Rotation.from_euler("y", 1.9)
    axis = random.standard_normal(3)
    turn = Rotation.from_rotvec(axis / np.linalg.norm(axis) * random.uniform(0, FAR))
    position = START_POSITION + random.uniform([-0.5, -0.75, -0.3], [1.0, 0.75, 0.5])
    return {
        "tasks.orientation.target.quaternion": (turn * start).as_quat(scalar_first=True).tolist(),
        "tasks.position.target.position": position.tolist(),
    }


def run(goal: int, method: str, extra: dict[str, object]) -> Outcome:
    """Pursue the goal at dt and at dt / 10."""
    overrides = {"limits.method": method, **extra, **target(goal)}
    summary = tope.simulate(SCENARIO, overrides=overrides).summary
    fine = tope.simulate(SCENARIO, overrides=overrides | {"dt": summary["scenario"]["dt"] / 10}).summary
    return Outcome(
        goal=goal,
        orientation_error=summary["task_error"]["orientation"]["final"],
        position_error=summary["task_error"]["position"]["final"],
        limit_violation=max(s["max_limit_violation"]["overall"] for s in (summary, fine)),
        in_buffer=summary["buffer_time"]["overall"],
        clipped=summary["status_counts"].get("clipped", 0),
        jump=summary["max_command_jump"]["overall"],
        fine_jump=fine["max_command_jump"]["overall"],
    )


def explanation(outcome: Outcome, method: str, extra: dict[str, object]) -> str:
    """Is a small ratio a jump, or a slope that dt does not resolve?

    Halves the step between the two states around the largest jump at dt / 10, towards the larger change.
    """
    overrides = {"limits.method": method, **extra, **target(outcome.goal), "dt": 1e-4, "log.every": 1}
    log = tope.simulate(SCENARIO, overrides=overrides).log
    scenario = tope.load_scenario(SCENARIO, overrides)
    joints = scenario.describe()["joints"]
    q, v, u = (np.column_stack([log[f"{x}.{joint['name']}"] for joint in joints]) for x in "qvu")
    bound = np.array([joint["bound"] for joint in joints])
    k = int(np.abs(np.diff(u / bound, axis=0)).max(axis=1).argmax())
    controller = scenario.controller()
    controller.update(q[0], v[0], 0.0)  # starts the references

    def command(s: float) -> np.ndarray:
        t = log["t"][k] + s * 1e-4
        return controller.update(q[k] + s * (q[k + 1] - q[k]), v[k] + s * (v[k + 1] - v[k]), t) / bound

    low, high = 0.0, 1.0
    changes = []
    for _ in range(24):
        middle = 0.5 * (low + high)
        there = command(middle)
        lower, upper = (np.abs(command(s) - there).max() for s in (low, high))
        low, high = (low, middle) if lower > upper else (middle, high)
        changes.append(max(lower, upper))
    steep = changes[-1] < 1e-3 * changes[0]
    return (
        f"{method}, goal {outcome.goal}: jump {words.percent(outcome.jump)} at dt, "
        f"{words.percent(outcome.fine_jump)} at dt/10, ratio {outcome.ratio:.1f}; "
        f"over 2^-24 of that cycle {100 * changes[-1]:.1e} %: " + ("a steep slope" if steep else "a jump")
    )


def row(method: str, outcomes: list[Outcome]) -> list[str]:
    """The figures of one method."""
    ratios = np.array([o.ratio for o in outcomes])
    turned = [o for o in outcomes if o.orientation_error < REACHED]
    return [
        method,
        str(len(outcomes)),
        str(sum(o.in_buffer > 0 for o in outcomes)),
        f"{np.sum(ratios >= CONTINUOUS)}",
        f"{np.median(ratios):.2f}, {ratios.min():.2f}",
        f"{100 * np.median([o.jump for o in outcomes]):.3g} %",
        str(len(turned)),
        str(sum(o.position_error < REACHED for o in turned)),
        str(sum(o.limit_violation > 0 for o in outcomes)),
        str(sum(o.clipped > 0 for o in outcomes)),
    ]


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--methods", default=",".join(METHODS), help="of limits.method, by comma")
    parser.add_argument("--count", type=int, default=100, help="goals")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="of the scenario")
    parser.add_argument("--json", type=Path, help="also write every outcome there")
    arguments = parser.parse_args()
    extra = dict(each.split("=", 1) for each in arguments.set)
    table = Table(
        "method",
        "goals",
        "entered a buffer",
        f"jump ratio >= {CONTINUOUS:g}",
        "median, least",
        "median jump",
        "orientation reached",
        "position too",
        "limit crossed",
        "clipped",
    )
    results: dict[str, list[Outcome]] = {}
    with ProcessPoolExecutor() as pool:
        for method in arguments.methods.split(","):
            outcomes = pool.map(partial(run, method=method, extra=extra), range(arguments.count))
            results[method] = list(track(outcomes, total=arguments.count, description=method, transient=True))
            table.add_row(*row(method, results[method]))
    console = Console()
    console.print(table)
    for method in {"unilateral", "chain"} & results.keys():
        for o in results[method]:
            if o.ratio < CONTINUOUS:
                console.print(explanation(o, method, extra))
    if arguments.json:
        arguments.json.write_text(
            json.dumps({m: [asdict(o) for o in each] for m, each in results.items()}, indent=1)
        )


if __name__ == "__main__":
    main()
