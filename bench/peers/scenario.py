"""Writes the scenario that tope and its peers are measured in: one file that all of their programs read.

The youBot of robots/youbot, its gripper closed, its base blocked by an obstacle at x = 0.35 m. A robot's
URDF is written anew without what only some peers read: shapes, friction, a joint without an end. Rotor
inertias, which a URDF cannot say, go into the scenario.

Each line of the file is a key and its values: see Setup in closed_loop.py.
"""

from __future__ import annotations

import argparse
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from geometry import Joint, Pose, exp3, forward, rotation_of_quaternion, rotation_of_rpy

ROBOT = Path(__file__).parents[2] / "robots" / "youbot"
OBSTACLE = 0.35  # m; what base_x may reach
FAR = 1000.0  # rad; limits of the yaw, which the robot has none of but some peers ask for
START = np.array([0, 0, 0, 0, 0.6, -1.2, 0.8, 0.3])  # m and rad
TURN = 2.5  # rad about the end-effector's axis: joint 5 comes near its limit
AHEAD = {"near": 0.45, "main": 0.9}  # m; the second one is out of reach behind the obstacle
GAIN = 2.0  # 1/s, of orientation and position
POSTURE_GAIN = 1.0  # 1/s
LIMIT_GAIN = (
    10.0  # 1/s, speed allowed per distance to a limit where a library lets it be chosen; tope's default
)
DT = 1e-3  # s
DURATION = {"velocity": 5.0, "torque": 8.0}  # s; a double pole takes longer than a single one
GOALS = 200
SEED = 42
WHEELS = 4

ZEROS = "0 0 0"  # what a URDF leaves out

Line = tuple[str, Iterable[object]]  # a key and its values


def write(folder: Path, mode: str, goals: int, repeats: int) -> Path:
    """Write the scenario of a mode and the robot's files to a folder; give the scenario's file."""
    robot = ET.parse(ROBOT / "youbot.urdf").getroot()
    plain(robot, locked=("gripper_finger_joint_l", "gripper_finger_joint_r"))
    robot.find("joint[@name='base_x']/limit").set("upper", str(OBSTACLE))
    joints, tip = chain(robot)
    inertia = rotor_inertia((ROBOT / "youbot.yaml").read_text(encoding="utf-8"))
    lines: list[Line] = [("duration", [DURATION[mode]]), ("repeats", [repeats]), ("start", START)]
    lines += [goal_line(*goal) for goal in targets(forward(joints, tip, START), goals).items()]
    return write_scenario(folder, mode, robot, [joint.name for joint in joints], inertia=inertia, more=lines)


def write_scenario(
    folder: Path,
    mode: str,
    robot: ET.Element,
    names: Sequence[str],
    *,
    inertia: Mapping[str, float],
    more: Iterable[Line],
) -> Path:
    """Write a plain robot and a scenario of it, its joints ordered as `names`."""
    urdf = folder / f"{robot.get('name')}.urdf"
    ET.ElementTree(robot).write(urdf)
    config = folder / f"{robot.get('name')}.yaml"
    entries = ", ".join(f"{name}: {inertia[name]!r}" for name in names if name in inertia)
    config.write_text(f"rotor_inertia: {{{entries}}}\n", encoding="utf-8")

    def limits(key: str) -> list[float]:
        return [float(robot.find(f"joint[@name='{name}']/limit").get(key)) for name in names]

    lines: list[Line] = [
        ("urdf", [urdf.resolve()]),
        ("config", [config.resolve()]),
        ("mode", [mode]),
        ("dt", [DT]),
        ("gain", [GAIN]),
        ("posture_gain", [POSTURE_GAIN]),
        ("limit_gain", [LIMIT_GAIN]),
        ("lower", limits("lower")),
        ("upper", limits("upper")),
        ("velocity", limits("velocity")),
        ("effort", limits("effort")),
        ("rotor_inertia", [inertia.get(name, 0.0) for name in names]),
    ]
    joints, tip = chain(robot)
    for joint in joints:
        kind = "prismatic" if joint.prismatic else "revolute"
        lines.append(("joint", [joint.name, kind, *joint.axis, *joint.rotation.flat, *joint.position]))
    lines.append(("tip", [*tip.rotation.flat, *tip.position]))
    file = folder / f"{mode}.txt"
    file.write_text("".join(" ".join([key, *map(text, values)]) + "\n" for key, values in [*lines, *more]))
    return file


def goal_line(name: str, goal: Pose) -> Line:
    """A goal as a scenario tells it."""
    return "goal", [name, *goal.rotation.flat, *goal.position]


def text(value: object) -> str:
    """A value that reads back as the same."""
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)


def plain(robot: ET.Element, locked: Collection[str]) -> None:
    """Change the URDF to what every peer reads alike; `locked` joints, not of the chain, stand at zero."""
    remove(robot, lambda part: part.tag not in ("link", "joint"))
    for link in robot.findall("link"):
        remove(link, lambda part: part.tag in ("visual", "collision"))
    for joint in robot.findall("joint"):
        remove(joint, lambda part: part.tag in ("dynamics", "mimic"))
        limit = joint.find("limit")
        if joint.get("name") in locked:
            joint.set("type", "fixed")
        elif joint.get("type") == "continuous":
            joint.set("type", "revolute")
            limit.attrib |= {"lower": str(-FAR), "upper": str(FAR)}
    mujoco = ET.SubElement(robot, "mujoco")  # read by MuJoCo alone: keeps the frame `ee`
    ET.SubElement(mujoco, "compiler", {"fusestatic": "false"})


def remove(element: ET.Element, unwanted: Callable[[ET.Element], bool]) -> None:
    """Take the unwanted parts out of an element."""
    for part in list(element):
        if unwanted(part):
            element.remove(part)


def chain(robot: ET.Element) -> tuple[list[Joint], Pose]:
    """The moving joints up to the frame `ee`, and the frame's pose in the last one."""
    parents = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    path: list[ET.Element] = []
    link = "ee"
    while link in parents:
        path.insert(0, parents[link])
        link = parents[link].find("parent").get("link")
    joints: list[Joint] = []
    rotation, position = np.eye(3), np.zeros(3)
    for joint in path:
        origin = {"xyz": ZEROS, "rpy": ZEROS} | getattr(joint.find("origin"), "attrib", {})
        position = position + rotation @ numbers(origin["xyz"])
        rotation = rotation @ rotation_of_rpy(*numbers(origin["rpy"]))
        if joint.get("type") != "fixed":
            prismatic = joint.get("type") == "prismatic"
            axis = numbers(joint.find("axis").get("xyz"))
            joints.append(Joint(joint.get("name"), prismatic, axis, rotation, position))
            rotation, position = np.eye(3), np.zeros(3)
    return joints, Pose(rotation, position)


def numbers(values: str) -> np.ndarray:
    """Numbers with blanks between them."""
    return np.array([float(value) for value in values.split()])


def rotor_inertia(config: str) -> dict[str, float]:
    """Rotor inertias at the joints [kg m2 or kg], the base's by way of its wheels, from the robot's file."""
    found = {
        name: float(value) for name, value in re.findall(r"^ +(\w+): +([\d.e+-]+)", config, re.MULTILINE)
    }
    wheels = WHEELS * found["wheel_rotor_inertia"] / found["wheel_radius"] ** 2
    arm = found["half_wheelbase"] + found["half_track"]
    return found | {"base_x": wheels, "base_y": wheels, "base_yaw": wheels * arm**2}


def targets(start: Pose, count: int) -> dict[str, Pose]:
    """A goal in reach, one out of reach, and so many of the two hundred of bench/goals.py, evenly taken."""
    turned = start.rotation @ exp3(np.array([0, 0, -TURN]))
    named = {name: Pose(turned, start.position + np.array([ahead, 0, 0])) for name, ahead in AHEAD.items()}
    random = np.random.default_rng(SEED)
    goals = []
    for _ in range(GOALS):
        box = np.array([random.random(), random.random(), random.random()])
        rotation = rotation_of_quaternion(random.standard_normal(4))
        position = np.array([start.position[0] + 1.5 * box[0], -0.75 + 1.5 * box[1], 1.5 * box[2]])
        goals.append(Pose(rotation, position))
    taken = [index * GOALS // count for index in range(count)]
    return named | {f"goal_{index}": goals[index] for index in taken}


def main() -> None:
    """Write the scenarios of both modes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--goals", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=5, help="of the timed runs of C++ programs")
    arguments = parser.parse_args()
    for mode in DURATION:
        print(write(arguments.folder, mode, arguments.goals, arguments.repeats))


if __name__ == "__main__":
    main()
