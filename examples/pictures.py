"""Run: make pictures. Draws examples/pictures/ from what the examples themselves record.

A Python example is run as it stands, and the function of its name draws its variables. 08 is C++ alone:
what it prints is drawn.
"""

import re
import runpy
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

EXAMPLES = Path(__file__).parent
PROGRAMS = EXAMPLES.parent / "build/Release/examples"
STYLE: dict[str, Any] = {
    "svg.hashsalt": "tope",  # the same file from the same curves
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.grid": True,
    "grid.color": "#e5e5e5",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.2,
}
COLOURS = ("#111111", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#999999")
LIMIT: dict[str, Any] = {"color": "#cc3333", "linestyle": "--", "linewidth": 1.0}
POINTS = 200  # of a curve

Variables = dict[str, Any]


def curve(axes: Axes, t: np.ndarray, values: Iterable[float], colour: int, label: str | None = None) -> None:
    """A curve of few enough points."""
    every = max(1, len(t) // POINTS)
    axes.plot(t[::every], np.asarray(values)[::every], color=COLOURS[colour], label=label)


def cycles(values: Any, dt: float = 1e-3) -> np.ndarray:
    """The times of values that were recorded in each cycle [s]."""
    return dt * np.arange(len(values))


def joints(axes: Axes, values: np.ndarray, names: Iterable[str]) -> None:
    """A curve for each joint, named beside the picture."""
    for colour, name in enumerate(names):
        curve(axes, cycles(values), values[:, colour], colour, name)
    axes.get_figure().legends.clear()
    axes.get_figure().legend(*axes.get_legend_handles_labels(), loc="outside right upper")


def reach_a_pose(example: Variables, axes: list[Axes]) -> None:
    """Joints that come to their limits."""
    path = np.array(example["path"])
    for place, joint, unit in ((0, "base_x", "m"), (1, "arm_joint_5", "rad")):
        index = example["robot"].joint_names.index(joint)
        curve(axes[place], cycles(path), path[:, index], 0)
        axes[place].axhline(example["robot"].position_upper[index], **LIMIT)
        axes[place].set_title(f"{joint} [{unit}] and its limit")


def torque_mode(example: Variables, axes: list[Axes]) -> None:
    """Torques and where they lead."""
    names = [joint["name"] for joint in example["joints"]]
    joints(axes[0], example["torque"] / [joint["bound"] for joint in example["joints"]], names)
    axes[0].set_title("torques, shares of their bounds")
    log = example["run"].log
    for colour, (task, unit) in enumerate({"orientation": "rad", "position": "m"}.items()):
        error = np.linalg.norm([log[f"e.{task}.{i}"] for i in range(3)], axis=0)
        curve(axes[1], log["t"], np.maximum(error, 1e-6), colour, f"{task} [{unit}]")
    axes[1].set_yscale("log")
    axes[1].axvline(5.0, **LIMIT)
    axes[1].set_title("errors; promised for 5 s")
    axes[1].legend()


def change_tasks(example: Variables, axes: list[Axes]) -> None:
    """The same changes, smooth and at once."""
    robot = example["robot"]
    for place, sent, title in ((0, "smooth", "over 0.5 s"), (1, "abrupt", "at once")):
        joints(axes[place], example[sent] / robot.velocity_limit, robot.joint_names)
        axes[place].set_title(f"velocities, shares of their bounds: {title}")
        axes[place].set_ylim(-1.1, 1.1)


def compare_limits(example: Variables, axes: list[Axes]) -> None:
    """Two commands, as each method shapes them."""
    robot = example["robot"]
    for colour, method in enumerate(example["ratios"]):
        sent = example["commands"](method, 1e-3)
        for place, joint, unit in ((0, "base_x", "m/s"), (1, "arm_joint_5", "rad/s")):
            curve(axes[place], cycles(sent), sent[:, robot.joint_names.index(joint)], colour, method)
            axes[place].set_title(f"command of {joint} [{unit}]")
    axes[0].legend()


def moving_target(example: Variables, axes: list[Axes]) -> None:
    """Errors with and without the target's velocity."""
    t = cycles(example["led"])
    curve(axes[0], t, 1e3 * example["led"], 0, "velocity known")
    curve(axes[0], t, 1e3 * example["behind"], 1, "not known")
    axes[0].set_title("distance from the target [mm]")
    axes[0].legend()
    curve(axes[1], t, 1e3 * example["led"], 0)
    axes[1].set_ylim(0, 1.0)
    axes[1].set_title("the first, closer [mm]")


def moving_obstacle(example: Variables, axes: list[Axes]) -> None:
    """The base before the wall."""
    t = cycles(example["where"])
    curve(axes[0], t, [example["wall"](now)[0] for now in t], 1, "wall")
    curve(axes[0], t, example["where"], 0, "base_x")
    axes[0].set_title("base_x and the wall [m]")
    axes[0].legend()
    curve(axes[1], t, 1e3 * np.array(example["error"]), 0)
    axes[1].set_ylim(0, 5)
    axes[1].set_title("gripper's distance from its place [mm]")


def point_and_keep_height(example: Variables, axes: list[Axes]) -> None:
    """Errors, and joints that repeat themselves."""
    t = cycles(example["angle"])
    curve(axes[0], t, np.maximum(example["angle"], 1e-6), 0, "pointing [rad]")
    curve(axes[0], t, np.maximum(example["off"], 1e-6), 1, "height [m]")
    axes[0].set_yscale("log")
    axes[0].set_title("errors")
    axes[0].legend()
    joints(axes[1], np.array(example["path"]) - example["start"], example["robot"].joint_names)
    axes[1].set_title("joints, from the start [m, rad]")


def own_task(table: np.ndarray, axes: list[Axes]) -> None:
    """Both distances of the program's table."""
    for place, title in ((0, "distance from the sphere [mm]"), (1, "distance from the swinging point [mm]")):
        axes[place].plot(table[:, 0], table[:, place + 1], color=COLOURS[0], marker=".")
        axes[place].set_title(title)


def safe_settings_and_status(example: Variables, axes: list[Axes]) -> None:
    """When which event was told."""
    events = example["events"]
    t = cycles(events)
    for row, event in enumerate(example["count"]):
        told = np.array([event in now for now in events])
        axes[0].fill_between(t[::40], row - 0.3, row + 0.3, where=told[::40], color=COLOURS[row], linewidth=0)
    axes[0].set_yticks(range(len(example["count"])), list(example["count"]))
    axes[0].set_xlim(0, t[-1])
    axes[0].grid(visible=False)
    axes[0].set_title("events told by the status")
    curve(axes[1], t, example["distance"], 0)
    axes[1].axvline(2.0, **LIMIT)
    axes[1].set_title("distance from the goal [m]; promised for 2 s")


def distances(example: Variables, axes: list[Axes]) -> None:
    """How near the robot comes, told of it and not."""
    for place, what in enumerate(("the post", "the robot itself")):
        for colour, (run, told) in enumerate({"kept": "told of it", "ignored": "not told"}.items()):
            curve(axes[place], cycles(example[run]), 1e3 * example[run][:, place], colour, told)
        axes[place].axhline(1e3 * example["margin"], **LIMIT)
        axes[place].set_title(f"distance from {what} and its margin [mm]")
    axes[0].legend()


def another_robot(example: Variables, axes: list[Axes]) -> None:
    """Which goals are reached, and the joints beside one's limit."""
    for colour, (name, (_, _, error)) in enumerate(example["runs"].items()):
        curve(axes[0], cycles(error), np.maximum(error, 1e-6), colour, name)
    axes[0].set_yscale("log")
    axes[0].set_title("distance from the goal [m]")
    axes[0].legend()
    robot, path, _ = example["runs"]["on a table, behind"]
    span = robot.position_upper - robot.position_lower
    joints(axes[1], (path - robot.position_lower) / span, robot.joint_names)
    axes[1].axhline(0.0, **LIMIT)
    axes[1].axhline(1.0, **LIMIT)
    axes[1].set_title("joints on the table, shares of their ranges")


def targets_from_outside(example: Variables, axes: list[Axes]) -> None:
    """Waypoints that are passed, and a command with and without a stream."""
    t = cycles(example["planned"])
    for axis, name in enumerate("xyz"):
        curve(axes[0], t, example["planned"][:, axis], axis, name)
        axes[0].plot(example["times"], example["points"][:, axis], "o", color=COLOURS[axis], markersize=4)
    axes[0].set_ylim(-0.4, 0.9)
    axes[0].set_title("gripper and its waypoints [m]")
    axes[0].legend(loc="lower left", ncols=3)
    base_y = example["robot"].joint_names.index("base_y")
    curve(axes[1], t, example["abrupt"][:, base_y], 1, "as they come")
    curve(axes[1], t, example["smooth"][:, base_y], 0, "stream")
    axes[1].set_title("command of base_y under samples [m/s]")
    axes[1].legend(loc="upper center", bbox_to_anchor=(0.35, 1.0))


def arm_and_base(example: Variables, axes: list[Axes]) -> None:
    """Errors of base and gripper in each run."""
    for colour, (name, errors) in enumerate(example["runs"].items()):
        for place in range(2):
            curve(axes[place], cycles(errors), np.maximum(errors[:, place], 1e-6), colour, name)
    for place, what in enumerate(("base [m, rad]", "gripper [m, rad]")):
        axes[place].set_yscale("log")
        axes[place].set_title(f"error of the {what}")
    axes[0].lines[1].set_linestyle("--")  # it lies on the first
    axes[0].legend()


def printed_table(program: str) -> np.ndarray:
    """The lines of a program's output that are numbers alone."""
    text = subprocess.run([PROGRAMS / program], check=True, capture_output=True, text=True).stdout
    return np.array([line.split() for line in re.findall(r"^[ \d.-]+$", text, re.MULTILINE)], dtype=float)


def draw(name: str, recorded: Any, fill: Callable[[Any, list[Axes]], None]) -> None:
    """Write a picture of two plots."""
    figure = Figure(figsize=(8.0, 2.4), layout="constrained")
    axes = list(figure.subplots(1, 2))
    fill(recorded, axes)
    for plot in axes:
        plot.set_xlabel("t [s]")
    file = EXAMPLES / "pictures" / f"{name}.svg"
    figure.savefig(file, metadata={"Date": None, "Creator": None})
    print(f"wrote {file}")


def main() -> None:
    """Draw all."""
    mpl.rcParams.update(STYLE)
    for example in sorted(EXAMPLES.glob("[0-9]*.py")):
        fill = globals()[example.stem.partition("_")[2]]
        draw(example.stem, runpy.run_path(str(example), run_name="example"), fill)
    draw("08_own_task", printed_table("example_08_own_task"), own_task)


if __name__ == "__main__":
    main()
