"""Run: make campaign-goals.

Two hundred random goals (seed 42), most of them out of reach because the base is blocked: how often is the
orientation reached, how often both, is any limit crossed, and does the command's largest jump fall with dt?
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

SCENARIO = Path(__file__).parent / "goals.yaml"
START_POSITION = np.array([0.25770200514162706, 0.0, 0.7572908809075207])  # of ee at the scenario's start
START_PITCH = 0.2  # rad
START_YAW = 0.3  # rad
REACHED = 1e-3  # m and rad
CONTINUOUS = 8.0  # ratio of the largest jumps at dt and dt / 10 from which a command counts as continuous
FAR = 2.2  # rad; beyond this initial error the rotation vector may flip at pi


@dataclass
class Goal:
    """One target pose."""

    number: int
    quaternion: list[float]  # w, x, y, z
    position: list[float]
    initial_angle: float  # rad


@dataclass
class Outcome:
    """What became of one goal."""

    number: int
    initial_angle: float
    orientation_error: float
    position_error: float
    limit_violation: float
    cut_off: int
    jump: float
    fine_jump: float

    @property
    def ratio(self) -> float:
        """Of the largest jumps at dt and dt / 10."""
        return self.jump / self.fine_jump


def goals(count: int) -> list[Goal]:
    """Positions in a box before the robot, rotations uniform."""
    generator = np.random.default_rng(42)
    start = Rotation.from_euler("YZ", [START_PITCH, START_YAW])
    result = []
    for number in range(count):
        box = np.array([generator.random(), generator.random(), generator.random()])
        position = [START_POSITION[0] + 1.5 * box[0], -0.75 + 1.5 * box[1], 1.5 * box[2]]
        quaternion = generator.standard_normal(4)
        quaternion /= np.linalg.norm(quaternion)
        rotation = Rotation.from_quat(quaternion, scalar_first=True)
        result.append(Goal(number, list(quaternion), position, (start.inv() * rotation).magnitude()))
    return result


def run(goal: Goal, method: str) -> Outcome:
    """Pursue the goal at dt and at dt / 10."""
    overrides = {
        "limits.method": method,
        "tasks.orientation.target.quaternion": goal.quaternion,
        "tasks.position.target.position": goal.position,
    }
    summary = tope.simulate(SCENARIO, overrides=overrides).summary
    fine = tope.simulate(SCENARIO, overrides=overrides | {"dt": 1e-4}).summary
    return Outcome(
        number=goal.number,
        initial_angle=goal.initial_angle,
        orientation_error=summary["task_error"]["orientation"]["final"],
        position_error=summary["task_error"]["position"]["final"],
        limit_violation=max(s["max_limit_violation"]["overall"] for s in (summary, fine)),
        cut_off=summary["status_counts"].get("cut_off", 0),
        jump=summary["max_command_jump"]["overall"],
        fine_jump=fine["max_command_jump"]["overall"],
    )


def table(outcomes: list[Outcome], method: str) -> Table:
    """The figures of the README."""
    turned = [o for o in outcomes if o.orientation_error < REACHED]
    near = [o for o in outcomes if o.initial_angle < FAR]
    rows = {
        "goals": len(outcomes),
        "orientation within 1 mrad": len(turned),
        "position within 1 mm as well": sum(o.position_error < REACHED for o in turned),
        "goals with a limit crossed": sum(o.limit_violation > 0 for o in outcomes),
        "least distance kept from a limit": f"{-max(o.limit_violation for o in outcomes):.2e}",
        "cycles cut off": sum(o.cut_off for o in outcomes),
        f"jump ratio >= {CONTINUOUS:g}, initial error < {FAR} rad": (
            f"{sum(o.ratio >= CONTINUOUS for o in near)} of {len(near)}"
        ),
        "jump ratio, median and least of those": (
            f"{np.median([o.ratio for o in near]):.2f}, {min(o.ratio for o in near):.2f}"
        ),
        f"jump ratio >= {CONTINUOUS:g}, all goals": sum(o.ratio >= CONTINUOUS for o in outcomes),
    }
    result = Table("", method, title="Two hundred goals with a blocked base, 5 s at gain 2/s")
    for name, value in rows.items():
        result.add_row(name, str(value))
    return result


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--method", default="unilateral", choices=tope.LIMIT_METHODS)
    parser.add_argument("--count", type=int, default=200, help="goals, of 200")
    parser.add_argument("--json", type=Path, help="also write every outcome there")
    arguments = parser.parse_args()
    tasks = goals(arguments.count)
    with ProcessPoolExecutor() as pool:
        results = pool.map(partial(run, method=arguments.method), tasks)
        outcomes = list(track(results, total=len(tasks), description="goals", transient=True))
    Console().print(table(outcomes, arguments.method))
    for outcome in outcomes:
        if outcome.initial_angle < FAR and outcome.ratio < CONTINUOUS:
            print(
                f"goal {outcome.number}: jump {outcome.jump:.4f} at dt, {outcome.fine_jump:.4f} at dt/10, "
                f"ratio {outcome.ratio:.1f}, initial error {outcome.initial_angle:.2f} rad"
            )
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(outcome) for outcome in outcomes], indent=1))


if __name__ == "__main__":
    main()
