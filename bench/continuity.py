"""Run: make campaign-continuity.

Ten thousand states of the youBot close to where a law may jump, each followed for 30 ms at 1 ms and 0.1 ms. A
continuous law's largest jump between two cycles shrinks tenfold, one that switches keeps it. Where it shrinks
less, the command may still be continuous but steep: then it must shrink so at a shorter period. Kinds:
  limit     some joints inside the buffers of their limits, on either side
  tie       several joints equally deep inside their buffers, to rounding
  singular  the arm stretched, or its wrist aligned, to within 0.02 rad
"""

import argparse
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.spatial.transform import Rotation

import tope

SCENARIO = Path(__file__).parent / "cycle_{}.yaml"
KINDS = ("limit", "tie", "singular")
JOINTS = ("arm_joint_1", "arm_joint_2", "arm_joint_3", "arm_joint_4", "arm_joint_5")
DURATION = 0.03  # s
PERIODS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)  # s
BUFFER = {"velocity": 0.1, "torque": 0.05}  # rad
CONTINUOUS = 8.0  # ratio from which a command counts as continuous
STILL = 1e-6  # of its bound: a command that changes less is at rest, and its ratio says nothing
ROBOT = tope.Robot.from_urdf(
    Path(__file__).parents[1] / "robots/youbot/youbot.urdf",
    Path(__file__).parents[1] / "robots/youbot/youbot.yaml",
)


@dataclass(frozen=True)
class Outcome:
    """Of one state."""

    number: int
    kind: str
    jumps: list[float]  # at dt, dt / 10, and on until they shrink as dt does, or the periods end

    @property
    def ratio(self) -> float:
        """Of the largest jumps at dt and dt / 10."""
        return self.jumps[0] / self.jumps[1]

    @property
    def continuous_at(self) -> float | None:
        """The period from which the jump shrinks as the period does."""
        ratios = zip(PERIODS, self.jumps, self.jumps[1:], strict=False)
        return next((dt for dt, jump, finer in ratios if jump >= CONTINUOUS * finer), None)


def start(random: np.random.Generator, kind: str, buffer: float) -> dict[str, float]:
    """Positions of the joints."""
    names = list(ROBOT.joint_names)
    state = dict.fromkeys(names[:3], 0.0)
    lower = dict(zip(names, ROBOT.position_lower, strict=True))
    upper = dict(zip(names, ROBOT.position_upper, strict=True))
    for joint in JOINTS:
        state[joint] = random.uniform(lower[joint] + 0.2, upper[joint] - 0.2)
    if kind == "singular":
        state["arm_joint_3"] = random.uniform(-0.02, 0.02)
        state["arm_joint_4"] = random.uniform(-0.02, 0.02)
        return state
    depth = random.uniform(0.05, 0.95)
    for joint in random.choice(JOINTS, size=random.integers(2, 5), replace=False):
        share = depth if kind == "tie" else random.uniform(0.05, 0.95)
        distance = buffer * (1.0 - share)
        state[joint] = upper[joint] - distance if random.random() < 0.5 else lower[joint] + distance
    return state


def run(number: int, mode: str, method: str, options: Mapping[str, float] = MappingProxyType({})) -> Outcome:
    """Follow one state at dt and at dt / 10, with these options of the method `unilateral`."""
    random = np.random.default_rng([7, number])
    kind = KINDS[number % len(KINDS)]
    turned = Rotation.from_rotvec(random.uniform(-1.0, 1.0, 3))
    overrides = {
        "limits.method": method,
        "limits.buffer": BUFFER[mode],
        **{f"limits.unilateral.{key}": value for key, value in options.items()},
        "initial": start(random, kind, BUFFER[mode]),
        "duration": DURATION,
        "tasks.orientation.target.quaternion": list(turned.as_quat(scalar_first=True)),
        "tasks.position.target": {"position": list(random.uniform([-0.3, -0.5, 0.1], [0.9, 0.5, 0.9]))},
    }
    scenario = str(SCENARIO).format(mode)
    jumps: list[float] = []
    for dt in PERIODS:
        summary = tope.simulate(scenario, overrides=overrides | {"dt": dt}).summary
        jumps.append(summary["max_command_jump"]["overall"])
        if len(jumps) > 1 and jumps[-2] >= CONTINUOUS * jumps[-1]:
            break
    return Outcome(number, kind, jumps)


def row(outcomes: list[Outcome], mode: str, method: str, kind: str) -> list[str]:
    """Of the table."""
    chosen = [o for o in outcomes if o.kind == kind and o.jumps[0] > STILL]
    ratios = np.array([o.ratio for o in chosen])
    return [
        mode,
        method,
        kind,
        f"{np.sum(ratios >= CONTINUOUS):,} of {len(chosen):,}",
        f"{np.median(ratios):.2f}",
        f"{np.min(ratios):.2f}",
        *(f"{sum(o.continuous_at == dt for o in chosen):,}" for dt in PERIODS[1:-1]),
        f"{sum(o.continuous_at is None for o in chosen):,}",
    ]


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000, help="states, shared by the kinds")
    parser.add_argument("--methods", nargs="+", default=["unilateral", "chain"], choices=tope.LIMIT_METHODS)
    arguments = parser.parse_args()
    console = Console()
    table = Table(
        "mode",
        "method",
        "states near",
        "ratio >= 8",
        "median",
        "least",
        "from 0.1 ms",
        "from 10 us",
        "from 1 us",
        "never",
    )
    jumping = []
    with ProcessPoolExecutor() as pool:
        for mode in ("velocity", "torque"):
            for method in arguments.methods:
                results = pool.map(
                    partial(run, mode=mode, method=method), range(arguments.count), chunksize=20
                )
                outcomes = list(
                    track(results, f"{mode}, {method}", arguments.count, console=console, transient=True)
                )
                for kind in KINDS:
                    table.add_row(*row(outcomes, mode, method, kind))
                jumping += [
                    (mode, method, o) for o in outcomes if o.jumps[0] > STILL and o.continuous_at is None
                ]
    console.print(table)
    for mode, method, outcome in jumping:
        console.print(f"{mode}, {method}: {outcome}", highlight=False)


if __name__ == "__main__":
    main()
