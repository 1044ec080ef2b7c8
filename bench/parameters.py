"""Run: make parameters.

What the options of `unilateral` do: goals reached beside a limit on six robots (near_goals.py), and how
steep the command gets near limits, ties and singularities of the youBot (continuity.py), for the defaults and
for sets that differ from them in one option. Writes the tables of docs/parameters.md.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import continuity
import near_goals
import scenario

from tope import peers

PAGE = near_goals.ROOT / "docs" / "parameters.md"
MARK = "<!-- tables: make parameters -->"
SETS: Mapping[str, Sequence[str]] = {
    "velocity": (
        "",
        *(f"lock={value}" for value in (0.1, 0.05, 0.02, 0.01)),
        *(f"damping={value}" for value in (0.1, 0.03)),
        *(f"headroom={value}" for value in (0.03, 0.002)),
        *(f"free_headroom={value}" for value in (0.01, 0.1)),
        *(f"margin={value}" for value in (3e-3, 3e-4)),
    ),
    "torque": (
        "",
        *(f"lock={value}" for value in (0.1, 0.03)),
        *(f"damping={value}" for value in (0.2, 0.05)),
        *(f"headroom={value}" for value in (0.5, 0.05)),
        *(f"free_headroom={value}" for value in (0.1, 2.0)),
        *(f"margin={value}" for value in (3e-3, 3e-4)),
    ),
}
LOWEST = ("rest", "posture")
FINE = 4  # goals of each robot that are run at a tenth of the period too
HEADER = (
    "option",
    "reached, joints at rest below",
    "posture below",
    "ratio ≥ 8",
    "largest jump",
    "youBot's states with ratio ≥ 8",
    "largest jump there",
)


def goals(mode: str, count: int, out: Path) -> list[near_goals.Job]:
    """All sets of options on all robots."""
    result = []
    for robot in near_goals.SCENARIOS:
        machine = near_goals.machine(robot, mode)
        drawn = [near_goals.draw(machine, number) for number in range(count)]
        for lowest in LOWEST:
            folder = out / mode / lowest / robot
            folder.mkdir(parents=True, exist_ok=True)
            file = near_goals.write(folder / f"{mode}.txt", lowest, machine, drawn, FINE)
            for options in SETS[mode]:
                program = peers.Program("tope", "Python", mode, options or peers.DEFAULT)
                result.append(near_goals.Job(robot, lowest, program, drawn, file))
    return result


def steepness(found: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """How many jumps fall with the period, and the largest at the ordinary one."""
    pairs = [pair for each in found for pair in near_goals.jumps(each["runs"])]
    largest = max(run["jump"] for each in found for run in each["runs"] if run["dt"] == scenario.DT)
    fallen = sum(jump >= near_goals.CONTINUOUS * fine for jump, fine in pairs)
    return f"{fallen} of {len(pairs)}", f"{100 * largest:.2g} %"


def states(mode: str, options: str, count: int) -> tuple[str, str]:
    """The same of states of the youBot; a margin has no part in it."""
    named = dict(part.split("=") for part in options.split(",") if part)
    if "margin" in named:
        return "-", "-"
    follow = partial(
        continuity.run, mode=mode, method=peers.DEFAULT, options={k: float(v) for k, v in named.items()}
    )
    with ProcessPoolExecutor() as pool:
        outcomes = [
            each for each in pool.map(follow, range(count), chunksize=20) if each.jumps[0] > continuity.STILL
        ]
    fallen = sum(each.ratio >= continuity.CONTINUOUS for each in outcomes)
    return f"{fallen} of {len(outcomes)}", f"{100 * max(each.jumps[0] for each in outcomes):.2g} %"


def refused(tried: Sequence[Mapping[str, Any]]) -> str:
    """Robots that the option does not suit: the controller says so when it is built."""
    absent = [each for each in tried if "absent" in each]
    for each in absent:
        if "limits are not safe" not in each["absent"]:
            raise SystemExit(f"{each['robot']}, {each['configuration']}: {each['absent']}")
    robots = sorted({each["robot"] for each in absent})
    return f" (refused by {', '.join(robots)})" if robots else ""


def table(mode: str, count: int, state_count: int, out: Path) -> str:
    """Of one mode."""
    wanted = goals(mode, count, out)
    found = near_goals.run_all(wanted, os.cpu_count(), mode)
    (out / f"{mode}.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    rows = []
    for options in SETS[mode]:
        tried = [
            each
            for job, each in zip(wanted, found, strict=True)
            if job.program.configuration == (options or peers.DEFAULT)
        ]
        mine = [each for each in tried if "runs" in each]
        runs = {
            name: [run for each in mine if each["lowest"] == name for run in each["runs"]] for name in LOWEST
        }
        rows.append(
            (
                (f"`{options}`" if options else "defaults") + refused(tried),
                *("{} of {}".format(*near_goals.reached_of(runs[name])) for name in LOWEST),
                *steepness(mine),
                *states(mode, options, state_count),
            )
        )
    return near_goals.table(HEADER, rows)


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=20, help="goals of each robot")
    parser.add_argument("--states", type=int, default=900, help="states of the youBot")
    parser.add_argument(
        "--out", type=Path, default=near_goals.ROOT / "runs" / "parameters", help="folder of all figures"
    )
    parser.add_argument(
        "--page", action="store_true", help=f"write the tables to {PAGE.relative_to(near_goals.ROOT)}"
    )
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    parts = [
        f"## {mode.capitalize()} mode\n\n{table(mode, arguments.count, arguments.states, arguments.out)}"
        for mode in SETS
    ]
    near_goals.publish("\n\n".join(parts), PAGE if arguments.page else None, MARK)


if __name__ == "__main__":
    main()
