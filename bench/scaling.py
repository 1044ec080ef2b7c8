"""Run: make scaling.

How a cycle's cost grows with joints, with limits in transition and with levels. Robots: youBot arms one on
the other on one base, and serial chains of equal links. Writes docs/scaling.json (every figure),
docs/scaling.svg and the tables of docs/scaling.md.
"""

import argparse
import copy
import json
import math
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from rich.console import Console
from rich.progress import track

import tope
from tope import _core
from tope.bench import pinned, processor

ROOT = Path(__file__).parents[1]
YOUBOT = ROOT / "robots" / "youbot" / "youbot.urdf"
OUT = ROOT / "docs" / "scaling"
MARK = "<!-- tables: make scaling -->"
ARMS = (1, 2, 3, 5, 8, 13, 19)  # 3 + 5 k joints
CHAINS = (8, 13, 18, 28, 40, 60, 80, 100)
WIDE = 40  # joints of the chain on which transitions and levels are counted
TRANSITIONS = range(11)
LEVELS = range(1, 7)
LARGE = 18  # joints from which the exponents are fitted: below, what does not grow counts too
BUFFER = 0.05  # rad; in torque mode gain x buffer must be less than the speed limits


@dataclass(frozen=True)
class Wanted:
    """One case to time."""

    study: str
    robot: str
    size: int  # arms, or joints of the chain
    mode: str
    method: str
    transitions: int = 0
    levels: int = 3


@dataclass(frozen=True)
class Case(Wanted):
    """What was timed [us], medians over the cycles."""

    joints: int = 0
    laws: int = 0
    cycle_us: float = math.nan
    rigid_body_us: float = math.nan


@dataclass(frozen=True)
class Machine:
    """A robot, with the joints in order and some frames from base to tip."""

    urdf: str
    joints: list[str]
    frames: list[str]


def youbot_arms(count: int) -> Machine:
    """The youBot's base with `count` of its arms in series; frames: the last of each arm."""
    robot = ElementTree.parse(YOUBOT).getroot()
    children = {joint.find("child").get("link"): joint for joint in robot.iter("joint")}  # type: ignore[union-attr]
    arm = [f"arm_link_{i}" for i in range(1, 6)]
    links = {link.get("name"): link for link in robot.iter("link")}
    for name, joint in list(children.items()):
        if name is not None and name.startswith(("gripper", "ee")):
            robot.remove(links[name])
            robot.remove(joint)
    for k in range(2, count + 1):
        below = f"arm_link_5{suffix(k - 1)}"
        for name in arm:
            link, joint = copy.deepcopy(links[name]), copy.deepcopy(children[name])
            link.set("name", name + suffix(k))
            joint.set("name", str(joint.get("name")) + suffix(k))
            joint.find("parent").set("link", below)  # type: ignore[union-attr]
            joint.find("child").set("link", name + suffix(k))  # type: ignore[union-attr]
            below = name + suffix(k)
            robot.extend([link, joint])
    for effort in robot.iter("limit"):
        effort.set("effort", "1e5")  # the drives of one arm could not carry several
    joints = ["base_x", "base_y", "base_yaw"]
    joints += [f"arm_joint_{i}{suffix(k)}" for k in range(1, count + 1) for i in range(1, 6)]
    frames = [f"arm_link_5{suffix(k)}" for k in range(1, count + 1)]
    return Machine(ElementTree.tostring(robot, encoding="unicode"), joints, frames)


def suffix(k: int) -> str:
    """Of the names of arm k."""
    return "" if k == 1 else f"_{k}"


def serial_chain(count: int) -> Machine:
    """So many equal links, axes in turn; frames: all but the first few."""
    parts = ['<robot name="chain"><link name="link_0"/>']
    for i in range(1, count + 1):
        axis = ("0 0 1", "0 1 0", "1 0 0")[i % 3]
        parts.append(
            f'<link name="link_{i}"><inertial><origin xyz="0 0 0.05"/><mass value="0.5"/>'
            '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint_{i}" type="revolute"><parent link="link_{i - 1}"/><child link="link_{i}"/>'
            f'<origin xyz="0 0 0.1"/><axis xyz="{axis}"/>'
            '<limit lower="-2.5" upper="2.5" velocity="2" effort="1e5"/></joint>'
        )
    joints = [f"joint_{i}" for i in range(1, count + 1)]
    return Machine("".join([*parts, "</robot>"]), joints, [f"link_{i}" for i in range(4, count + 1)])


def start_of(machine: Machine) -> dict[str, float]:
    """Off the middle of each joint's range, each by another angle."""
    limits = {}
    for joint in ElementTree.fromstring(machine.urdf).iter("joint"):
        limit = joint.find("limit")
        bounded = limit is not None and limit.get("lower") is not None
        limits[joint.get("name")] = (
            (float(limit.get("lower")), float(limit.get("upper"))) if bounded else (0, 0)  # type: ignore[union-attr,arg-type]
        )
    return {
        joint: 0.5 * sum(limits[joint]) + 0.3 * math.sin(1.7 * i + 0.4)
        for i, joint in enumerate(machine.joints)
    }


def tasks_of(machine: Machine, levels: int, posture: list[float]) -> list[dict[str, Any]]:
    """Orientation and position of the last frame, positions of others, posture: `levels` in all."""

    def task(kind: str, frame: str, **target: list[float]) -> dict[str, Any]:
        return {"name": f"{kind}_{frame}", "type": kind, "frame": frame, "target": target}

    frames = machine.frames
    step = max(1, len(frames) // 6)
    tasks = [
        task("frame_orientation", frames[-1], quaternion=[1, 0, 0, 0]),
        task("frame_position", frames[-1], position=[0.3, 0.1, 0.5]),
    ]
    for i in range(1, 4):
        tasks.append(
            task("frame_position", frames[max(0, len(frames) - 1 - i * step)], position=[0.1, 0.1, 0.3])
        )
    tasks = tasks[: levels - 1]
    tasks.append({"name": "posture", "type": "posture", "target": posture})
    for i, one in enumerate(tasks):
        one["level"] = i + 1
        one["reference"] = {"type": "exponential", "gain": 1.0}
    return tasks


def scenario_of(wanted: Wanted, machine: Machine) -> dict[str, Any]:
    """A short motion; the last `transitions` joints begin inside the buffers of their limits."""
    start = start_of(machine)
    pressed = machine.joints[::-1][: wanted.transitions]
    return {
        "mode": wanted.mode,
        "dt": 1e-3,
        "duration": 0.02,
        "robot": {"urdf": "robot.urdf", "config": "robot.yaml"},
        "initial": start,
        "limits": {
            "method": wanted.method,
            "conditions": "report",
            "buffer": BUFFER,
            "joints": {
                joint: {"upper": start[joint] + BUFFER * (0.3 + 0.05 * i)} for i, joint in enumerate(pressed)
            },
        },
        "log": {"every": 1000},
        "tasks": tasks_of(machine, wanted.levels, list(start.values())),
    }


def measure(wanted: Wanted, cycles: int) -> Case:
    """Time one case, in a folder of its own."""
    machine = youbot_arms(wanted.size) if wanted.robot == "youBot arms" else serial_chain(wanted.size)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "robot.urdf").write_text(machine.urdf, encoding="utf-8")
        (folder / "robot.yaml").write_text("name: scaling\n", encoding="utf-8")
        path = folder / "scaling.yaml"
        path.write_text(json.dumps(scenario_of(wanted, machine)), encoding="utf-8")  # YAML holds JSON
        acting = wanted.transitions if wanted.method == "chain" else -1
        timed = _core.benchmark(tope.load_scenario(path), acting, cycles)
    return Case(
        **asdict(wanted),
        joints=len(machine.joints),
        laws=timed["largest_laws"],
        cycle_us=float(np.median(timed["cycle_us"])),
        rigid_body_us=float(np.median(timed["rigid_body_us"])),
    )


def all_wanted() -> list[Wanted]:
    """Every case of the three studies."""
    modes, methods = ("velocity", "torque"), ("unilateral", "chain")
    sizes = [("youBot arms", size) for size in ARMS] + [("serial chain", size) for size in CHAINS]
    joints = [
        Wanted("joints", robot, size, mode, method)
        for robot, size in sizes
        for mode in modes
        for method in methods
    ]
    transitions = [
        Wanted("transitions", "serial chain", WIDE, mode, "chain", transitions=r)
        for mode in modes
        for r in TRANSITIONS
    ]
    levels = [
        Wanted("levels", "serial chain", WIDE, mode, method, levels=p)
        for mode in modes
        for method in methods
        for p in LEVELS
    ]
    return joints + transitions + levels


def exponent(joints: list[int], costs: list[float]) -> float:
    """Of cost ~ joints^exponent, by least squares of the logarithms."""
    return float(np.polyfit(np.log(joints), np.log(costs), 1)[0])


def select(cases: list[Case], **wanted_values: Any) -> list[Case]:
    """Those with these values."""
    return [
        case for case in cases if all(getattr(case, key) == value for key, value in wanted_values.items())
    ]


def joints_table(cases: list[Case]) -> list[str]:
    """Cost over joints, and the exponents."""
    lines = ["| robot | mode | law | cycle [µs] at n joints | exponent, n ≥ 18 |", "|---|---|---|---|---|"]
    for robot in ("youBot arms", "serial chain"):
        for mode in ("velocity", "torque"):
            for method in ("unilateral", "chain", "rigid-body terms"):
                chosen = select(cases, study="joints", robot=robot, mode=mode)
                chosen = select(chosen, method="unilateral" if method == "rigid-body terms" else method)
                costs = [c.rigid_body_us if method == "rigid-body terms" else c.cycle_us for c in chosen]
                large = [(c.joints, cost) for c, cost in zip(chosen, costs, strict=True) if c.joints >= LARGE]
                figures = ", ".join(f"{c.joints}: {cost:.1f}" for c, cost in zip(chosen, costs, strict=True))
                fitted = exponent([n for n, _ in large], [cost for _, cost in large])
                lines.append(f"| {robot} | {mode} | {method} | {figures} | {fitted:.2f} |")
    return lines


def counted_table(cases: list[Case], study: str, counted: str) -> list[str]:
    """Cost over what is counted, with a straight line through it."""
    lines = [
        f"| mode | law | cycle [µs] at {counted} | a straight line's slope [µs] | its largest error |",
        "|---|---|---|---|---|",
    ]
    for mode in ("velocity", "torque"):
        for method in ("unilateral", "chain"):
            chosen = select(cases, study=study, mode=mode, method=method)
            if not chosen:
                continue
            counts = np.array([getattr(c, study) for c in chosen], dtype=float)
            costs = np.array([c.cycle_us for c in chosen])
            kept = counts >= 1
            line = np.polyfit(counts[kept], costs[kept], 1)
            error = np.max(np.abs(np.polyval(line, counts[kept]) / costs[kept] - 1.0))
            figures = ", ".join(f"{getattr(c, study)}: {c.cycle_us:.1f}" for c in chosen)
            lines.append(f"| {mode} | {method} | {figures} | {line[0]:.2f} | {100 * error:.0f} % |")
    return lines


def draw(cases: list[Case], path: Path) -> None:
    """Three panels: joints, transitions, levels."""
    mpl.rcParams["svg.hashsalt"] = "tope"  # the same file from the same figures
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), constrained_layout=True)
    for mode, colour in (("velocity", "tab:blue"), ("torque", "tab:orange")):
        for method, style in (("unilateral", "o-"), ("chain", "s--")):
            chosen = select(cases, study="joints", robot="serial chain", mode=mode, method=method)
            left.loglog(
                [c.joints for c in chosen],
                [c.cycle_us for c in chosen],
                style,
                color=colour,
                label=f"{mode}, {method}",
            )
            chosen = select(cases, study="levels", mode=mode, method=method)
            right.plot([c.levels for c in chosen], [c.cycle_us for c in chosen], style, color=colour)
        terms = select(cases, study="joints", robot="serial chain", mode=mode, method="chain")
        left.loglog(
            [c.joints for c in terms],
            [c.rigid_body_us for c in terms],
            ":",
            color=colour,
            label=f"{mode}, rigid-body terms",
        )
        chosen = select(cases, study="transitions", mode=mode)
        middle.plot([c.transitions for c in chosen], [c.cycle_us for c in chosen], "s--", color=colour)
    left.set(xlabel="joints (serial chain)", ylabel="median cycle [µs]")
    middle.set(xlabel=f"limits in transition (chain, {WIDE} joints)", ylim=0)
    right.set(xlabel=f"levels ({WIDE} joints)", ylim=0)
    left.legend(fontsize=8)
    for axes in (left, middle, right):
        axes.grid(visible=True, which="both", alpha=0.3)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def write_tables(cases: list[Case], core: int) -> None:
    """Replace what stands behind the mark in docs/scaling.md."""
    path = OUT.with_suffix(".md")
    text = path.read_text(encoding="utf-8").partition(MARK)[0]
    lines = [
        MARK,
        "",
        f"Medians on one core of {processor()}.",
        "",
        "## Joints",
        "",
        *joints_table(cases),
        "",
        "## Limits in transition",
        "",
        f"`chain` on a serial chain of {WIDE} joints; r limits in transition are r + 1 laws.",
        "",
        *counted_table(cases, "transitions", "r limits in transition"),
        "",
        "## Levels",
        "",
        f"The same chain of {WIDE} joints; the last level is the posture, each other one has three rows.",
        "",
        *counted_table(cases, "levels", "p levels"),
        "",
    ]
    path.write_text(text + "\n".join(lines), encoding="utf-8")


def main() -> None:
    """Measure, write, draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=5000, help="timed a case, at least")
    cycles = parser.parse_args().cycles
    console = Console()
    with pinned() as core:
        cases = [measure(wanted, cycles) for wanted in track(all_wanted(), "cases", console=console)]
    for case in select(cases, study="transitions"):
        if case.laws != case.transitions + 1:
            raise SystemExit(f"{case}: expected {case.transitions + 1} laws")
    raw = {"processor": processor(), "cycles": cycles, "cases": [asdict(case) for case in cases]}
    OUT.with_suffix(".json").write_text(json.dumps(raw, indent=1) + "\n", encoding="utf-8")
    draw(cases, OUT.with_suffix(".svg"))
    write_tables(cases, core)
    console.print(*joints_table(cases), *counted_table(cases, "transitions", "r"), sep="\n", markup=False)


if __name__ == "__main__":
    main()
