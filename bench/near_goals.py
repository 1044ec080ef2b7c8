"""Run: make near-goals.

Goals whose last millimetre lies beside a joint limit: the hand's pose at a configuration in which one joint
of the hand's chain is within 2 mrad of a limit. How many are reached, on six robots, by tope and, from the
same starts in the same loop, by Pink and tsid? Writes the tables of docs/near-goals.md.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any
from xml.etree import ElementTree

import numpy as np
from rich.progress import track

from tope import _core, peers

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(peers.FOLDER))

import geometry  # noqa: E402
import scenario  # noqa: E402

PAGE = ROOT / "docs" / "near-goals.md"
MARK = "<!-- tables: make near-goals -->"
SCENARIOS = {
    "youbot": ROOT / "scenarios" / "youbot_velocity.yaml",
    **{
        name: ROOT / "scenarios" / "robots" / f"{name}.yaml"
        for name in ("panda", "ur5", "tiago", "talos", "kinova")
    },
}
# Limits within which the drives of TALOS, as its URDF describes them, hold its arms in every pose.
HELD: Mapping[str, Mapping[str, float]] = {
    "torso_2_joint": {"lower": -0.1, "upper": 0.15},
    "arm_left_2_joint": {"upper": 0.7},
    "arm_right_2_joint": {"lower": -0.7},
}
SEED = 42
NEAREST, NEAR = 2e-4, 2e-3  # rad or m; how far the one joint is from its limit
AWAY = 0.1  # share of the range that every other joint keeps from its limits
OFFSET = 0.5  # rad or m; how far from the goal a joint starts, at most
OFFSET_SHARE = 0.25  # the same as a share of its range
INSIDE = 0.01  # rad or m; what a start keeps from every limit
FAR = 2.2  # rad; a start turned further away is drawn anew: the rotation vector flips at pi
MARGIN = 1e-3  # rad or m; what tope keeps from a limit by default
DURATION = 8.0  # s
SETTLED = 2e-4  # m and rad; a run that is so near ends
CONTINUOUS = 8.0  # ratio of the largest jumps at dt and dt / 10 from which a command counts as continuous
TOPE = (("tope", "unilateral"), ("tope", "tight"))
PROGRAMS: Mapping[str, Sequence[tuple[str, str]]] = {
    "velocity": (*TOPE, ("tope", "chain"), ("pink", "default"), ("pink", "weights")),
    "torque": (*TOPE, ("tsid", "weights+torque-bounds")),
}
HEADER = (
    "robot",
    "library",
    "reached",
    f"of those within {1e3 * MARGIN:g} mrad",
    "oriented",
    "others missed by [mm, mrad]",
    "limit crossed by",
    "jump at 1 ms",
    "0.1 ms",
    "ratio",
    f"ratio ≥ {CONTINUOUS:g}",
    "largest jump of all",
    "failed cycles, runs",
)


@dataclass(frozen=True)
class Machine:
    """A robot as every library reads it: its plain URDF, its joints in order, their limits [rad or m]."""

    urdf: ElementTree.Element
    names: Sequence[str]
    inertia: Mapping[str, float]  # of the rotors, by joint, where known
    joints: Sequence[geometry.Joint]  # those that move the hand
    tip: geometry.Pose
    lower: np.ndarray
    upper: np.ndarray

    @property
    def chain(self) -> list[int]:
        """Where the joints that move the hand are in the order."""
        return [self.names.index(joint.name) for joint in self.joints]

    def hand(self, q: np.ndarray) -> geometry.Pose:
        """Its pose."""
        return geometry.forward(list(self.joints), self.tip, q[self.chain])


@dataclass(frozen=True)
class Goal:
    """The hand's pose at `q`; `joint` is `distance` from its `side` limit there."""

    joint: str
    side: str
    distance: float  # rad or m
    q: list[float]
    start: list[float]


def machine(name: str, mode: str) -> Machine:
    """A robot of SCENARIOS; in torque mode TALOS is kept where it can hold its arms."""
    described = _core.load_scenario(SCENARIOS[name]).describe()
    urdf = ElementTree.parse(described["robot"]["urdf"]).getroot()
    scenario.plain(urdf, described["robot"]["locked_joints"])
    urdf.set("name", name)
    if name == "talos" and mode == "torque":
        for joint, limits in HELD.items():
            urdf.find(f"joint[@name='{joint}']/limit").attrib |= {key: str(limits[key]) for key in limits}  # type: ignore[union-attr]
    put_hand(urdf, described["tasks"][0]["frame"])
    joints, tip = scenario.chain(urdf)
    names = [joint["name"] for joint in described["joints"]]
    lower, upper = (np.array([limit(urdf, joint, side) for joint in names]) for side in ("lower", "upper"))
    youbot = (scenario.ROBOT / "youbot.yaml").read_text(encoding="utf-8")
    inertia = scenario.rotor_inertia(youbot) if name == "youbot" else {}
    return Machine(urdf, names, inertia, joints, tip, lower, upper)


def put_hand(urdf: ElementTree.Element, frame: str) -> None:
    """Give a robot's hand the name by which every program knows it."""
    if frame != "ee":
        ElementTree.SubElement(urdf, "link", name="ee")
        joint = ElementTree.SubElement(urdf, "joint", name="ee_joint", type="fixed")
        ElementTree.SubElement(joint, "parent", link=frame)
        ElementTree.SubElement(joint, "child", link="ee")


def limit(urdf: ElementTree.Element, joint: str, side: str) -> float:
    """A joint's limit [rad or m]; scenario.FAR where it has none."""
    return float(urdf.find(f"joint[@name='{joint}']/limit").get(side))  # type: ignore[union-attr,arg-type]


def draw(robot: Machine, number: int) -> Goal:
    """A goal beside a limit, and a start from which the joint has to move towards it."""
    random = np.random.default_rng([SEED, number])
    unlimited = robot.upper >= scenario.FAR
    span = np.where(unlimited, 2 * math.pi, robot.upper - robot.lower)
    lower = np.where(unlimited, -math.pi, robot.lower + AWAY * span)
    upper = np.where(unlimited, math.pi, robot.upper - AWAY * span)
    offset = np.minimum(OFFSET, OFFSET_SHARE * span)
    limited = [j for j in robot.chain if not unlimited[j]]
    while True:
        q = random.uniform(lower, upper)
        j, inwards = random.choice(limited), random.choice([-1.0, 1.0])
        distance = random.uniform(NEAREST, NEAR)
        q[j] = (robot.lower[j] if inwards > 0 else robot.upper[j]) + inwards * distance
        move = random.uniform(-offset, offset)
        move[j] = inwards * abs(move[j])
        start = np.clip(q + move, robot.lower + INSIDE, robot.upper - INSIDE)
        turn = robot.hand(start).rotation.T @ robot.hand(q).rotation
        if geometry.rotation_angle(turn) < FAR:
            side = "lower" if inwards > 0 else "upper"
            return Goal(robot.names[j], side, distance, q.tolist(), start.tolist())


def write(file: Path, lowest: str, robot: Machine, goals: Sequence[Goal], fine: int) -> Path:
    """Write the scenario of a robot, the first `fine` goals to be run with the short cycle too."""
    names = [f"goal_{number}" for number in range(len(goals))]
    lines: list[scenario.Line] = [
        ("duration", [DURATION]),
        ("settled", [SETTLED]),
        ("lowest", [lowest]),
        ("chain", robot.chain),
        ("start", goals[0].start),
        ("fine", names[:fine]),
    ]
    for name, goal in zip(names, goals, strict=True):
        lines.append(("start_of", [name, *goal.start]))
        lines.append(scenario.goal_line(name, robot.hand(np.array(goal.q))))
    return scenario.write_scenario(
        file.parent, file.stem, robot.urdf, robot.names, inertia=robot.inertia, more=lines
    )


@dataclass(frozen=True)
class Job:
    """One program on one robot."""

    robot: str
    lowest: str  # the last task
    program: peers.Program
    goals: Sequence[Goal]
    file: Path

    @property
    def library(self) -> str:
        """And how it is driven."""
        return f"{self.program.name}: {self.program.configuration}"

    def run(self) -> dict[str, Any]:
        """What it measured."""
        return {"robot": self.robot, "lowest": self.lowest} | peers.run(self.program, self.file)


Found = Sequence[tuple[Job, Mapping[str, Any]]]  # what was measured


def jobs(robots: Sequence[str], counts: Mapping[str, int], fine: int, out: Path) -> list[Job]:
    """All programs on all robots, so many goals by the last task, their scenarios written to a folder."""
    result = []
    drawn: dict[str, dict[str, list[dict[str, Any]]]] = {}
    for mode, programs in PROGRAMS.items():
        for robot in robots:
            described = machine(robot, mode)
            goals = [draw(described, number) for number in range(max(counts.values()))]
            drawn.setdefault(mode, {})[robot] = [asdict(goal) for goal in goals]
            for lowest, count in counts.items():
                folder = out / lowest / robot / mode
                folder.mkdir(parents=True, exist_ok=True)
                some = goals[:count]
                file = write(folder / f"{mode}.txt", lowest, described, some, fine if lowest == "rest" else 0)
                for name, configuration in programs:
                    program = peers.Program(name, "Python", mode, configuration)
                    result.append(Job(robot, lowest, program, some, file))
    (out / "goals.json").write_text(json.dumps(drawn, indent=1), encoding="utf-8")
    return result


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Markdown."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (header, *rows)]
    return "\n".join([lines[0], "|---" * len(header) + "|", *lines[1:]])


def tables(found: Found) -> str:
    """The page's part: goals reached and all figures by mode; what was not measured."""
    measured = [(job, each) for job, each in found if "absent" not in each]
    parts = []
    for mode in PROGRAMS:
        some = [(job, each) for job, each in measured if job.program.mode == mode]
        parts.append(f"## {mode.capitalize()} mode\n\nGoals reached:\n\n{reached(some, 'rest')}")
        parts.append(f"With a posture below:\n\n{reached(some, 'posture')}")
        rows = [summary(job, each) for job, each in some if job.lowest == "rest"]
        parts.append(f"All figures, without a posture:\n\n{table(HEADER, rows)}")
    for job, each in found:
        if "absent" in each:
            parts.append(f"Not measured: {job.robot}, {job.library}: {each['absent']}.")
    return "\n\n".join(parts)


def summary(job: Job, found: Mapping[str, Any]) -> tuple[str, ...]:
    """A program's figures under HEADER."""
    coarse = {run["goal"]: run for run in found["runs"] if run["dt"] == scenario.DT}
    reached, count = reached_of(found["runs"])
    others = [miss(run) for run in coarse.values() if miss(run) >= peers.REACHED]
    inside = [coarse[f"goal_{number}"] for number, goal in enumerate(job.goals) if goal.distance < MARGIN]
    pairs = jumps(found["runs"])
    ratios = [jump / fine_jump if fine_jump > 0 else math.inf for jump, fine_jump in pairs]
    jump, fine_jump = (f"{100 * median(jumps):.3g} %" for jumps in zip(*pairs, strict=True))
    beyond = max(run["violation"] for run in found["runs"])
    failures = sum(run["failures"] for run in coarse.values())
    failed = sum(run["failures"] > 0 for run in coarse.values())
    return (
        job.robot,
        job.library,
        f"{reached} of {count}",
        f"{sum(miss(run) < peers.REACHED for run in inside)} of {len(inside)}",
        f"{sum(run['orientation_error'] < peers.REACHED for run in coarse.values())} of {count}",
        f"{1e3 * median(others):.2g}" if others else "-",
        f"{beyond:.1e}" if beyond > peers.ROUNDING else "0",
        jump,
        fine_jump,
        f"{median(ratios):.1f}",
        f"{sum(ratio >= CONTINUOUS for ratio in ratios)} of {len(pairs)}",
        f"{100 * max(run['jump'] for run in coarse.values()):.3g} %",
        f"{failures}, {failed} of {count}" if failures else "0",
    )


def miss(run: Mapping[str, Any]) -> float:
    """The larger of the errors at the end [m and rad]."""
    return float(max(run["position_error"], run["orientation_error"]))


def reached_of(runs: Iterable[Mapping[str, Any]]) -> tuple[int, int]:
    """How many goals are reached at the ordinary period, of how many."""
    coarse = [run for run in runs if run["dt"] == scenario.DT]
    return sum(miss(run) < peers.REACHED for run in coarse), len(coarse)


def jumps(runs: Sequence[Mapping[str, Any]]) -> list[tuple[float, float]]:
    """The largest jump at the ordinary and at the short period, of goals that are run at both."""
    coarse = {run["goal"]: run["jump"] for run in runs if run["dt"] == scenario.DT}
    return [(coarse[run["goal"]], run["jump"]) for run in runs if run["dt"] < scenario.DT]


def reached(found: Found, lowest: str) -> str:
    """Goals reached with that last task: a row a robot, a column a library."""
    counts: dict[str, dict[str, np.ndarray]] = {"all": {}}  # reached, of so many
    for job, each in found:
        if job.lowest == lowest:
            count = np.array(reached_of(each["runs"]))
            counts.setdefault(job.robot, {})[job.library] = count
            counts["all"][job.library] = counts["all"].get(job.library, 0) + count
    counts["all"] = counts.pop("all")  # last
    rows = []
    for robot, by_library in counts.items():
        cells = (by_library.get(library) for library in counts["all"])
        rows.append((robot, *("-" if cell is None else f"{cell[0]} of {cell[1]}" for cell in cells)))
    return table(("robot", *counts["all"]), rows)


def run_all(wanted: Sequence[Job], at_once: int | None, label: str) -> list[dict[str, Any]]:
    """What all jobs measured, so many at a time."""
    with ThreadPoolExecutor(at_once) as pool:
        return list(track(pool.map(Job.run, wanted), total=len(wanted), description=label, transient=True))


def publish(text: str, page: Path | None, mark: str) -> None:
    """Print the tables, and write them to a page behind its mark."""
    print(text)
    if page is not None:
        before = page.read_text(encoding="utf-8").partition(mark)[0]
        page.write_text(f"{before}{mark}\n\n{text}\n", encoding="utf-8")


def main() -> None:
    """Draw the goals, run every program on every robot, write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="goals of each robot")
    parser.add_argument("--fine", type=int, default=6, help="how many of them at a tenth of the period too")
    parser.add_argument("--posture", type=int, default=20, help="how many of them with a posture as well")
    parser.add_argument("--robots", nargs="+", default=list(SCENARIOS), choices=SCENARIOS)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="programs at a time")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "runs" / "near-goals", help="folder of all figures"
    )
    parser.add_argument("--page", action="store_true", help=f"write the tables to {PAGE.relative_to(ROOT)}")
    arguments = parser.parse_args()
    counts = {"rest": arguments.count, "posture": min(arguments.posture, arguments.count)}
    wanted = jobs(arguments.robots, counts, arguments.fine, arguments.out)
    found = run_all(wanted, arguments.jobs, "programs")
    (arguments.out / "figures.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    publish(tables(list(zip(wanted, found, strict=True))), PAGE if arguments.page else None, MARK)


if __name__ == "__main__":
    main()
