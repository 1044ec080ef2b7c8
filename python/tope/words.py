"""A summary said in words and in table rows, for the terminal and for the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Summary = Mapping[str, Any]

PREFIXES = (("m", 1e3), ("µ", 1e6), ("n", 1e9))

COMPARISON_HEADER = (
    "run",
    "limits",
    "final errors",
    "largest jump at dt, dt/10, ratio",
    "time to goal",
    "variation of the command",
)
COMPARISON_NOTE = (
    "A jump is the largest change of a command between two cycles, as a percentage of its joint's bound. "
    "If it falls about tenfold when the cycle is ten times shorter (ratio near 10), the command is "
    "continuous; a ratio near 1 is a true jump. The variation is summed over the last half of the run: "
    "large values mean an oscillating command."
)


def number(value: float | None, unit: str = "") -> str:
    """The value to three digits with its unit, a small length or angle with a prefix; a dash for none."""
    if value is None:
        return "–"
    if unit in ("m", "rad") and 0 < abs(value) < 0.01:
        prefix, factor = next((p, f) for p, f in PREFIXES if abs(value) * f >= 1 or p == "n")
        value, unit = factor * value, prefix + unit
    digits = f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"
    return f"{digits} {unit}".rstrip()


def percent(fraction: float | None) -> str:
    """A fraction as a percentage to three digits."""
    return "–" if fraction is None else number(100 * fraction, "%")


def summary_rows(summary: Summary) -> list[tuple[str, str]]:
    """The run's outcome as (what, sentence) rows."""
    return [
        ("Goal", goal(summary)),
        *(
            (f"Error of {task['name']}", task_error(summary, task))
            for task in summary["scenario"]["tasks"]
            if task["name"] in summary["task_error"]
        ),
        ("Joint limits", limits(summary)),
        *([("Distances", clearance(summary))] if "least_distance" in summary else ()),
        *(experiment_rows(summary) if summary["scenario"].get("plant") == "mujoco" else ()),
        ("Largest jump", jump(summary)),
        ("Cycles", cycles(summary)),
        ("Time per cycle", cycle_time(summary)),
    ]


def experiment_rows(summary: Summary) -> list[tuple[str, str]]:
    """What only a plant with sensors and contacts has to tell."""
    joint, off = worst(summary["sensor_error"])
    units = {each["name"]: each["unit"] for each in summary["scenario"]["joints"]}
    errors = summary["task_error"]
    seen = (
        f"{task['name']} {number(errors[task['name']]['measured'], unit(task))}"
        for task in summary["scenario"]["tasks"]
        if task["name"] in errors
    )
    touched = (f"{what} ({number(force)} N or Nm)" for what, force in summary["contacts"].items())
    return [
        ("Contacts", ", ".join(touched) or "none"),
        (
            "As the robot sees it",
            f"{', '.join(seen)}; its sensors are off by {number(off, units.get(joint, ''))} ({joint})",
        ),
    ]


def tiles(summary: Summary) -> list[tuple[str, str, str]]:
    """The outcome at a glance: (what, figure, what it says)."""
    reached = summary["time_to_goal"]
    jumping, fraction = worst(summary["max_command_jump"])
    return [
        (
            "Goal",
            "not reached" if reached is None else f"reached in {number(reached, 's')}",
            goal_accuracy(summary),
        ),
        ("Limits", *limits_at_a_glance(summary)),
        (
            "Largest jump of a command",
            percent(fraction),
            f"of its bound in one cycle, {jumping}" if jumping else "no cycle",
        ),
        (
            "Computing time",
            number(summary["cycle_time_us"]["p50"], "µs"),
            f"a cycle; slowest {number(summary['cycle_time_us']['max'], 'µs')}",
        ),
    ]


def limits_at_a_glance(summary: Summary) -> tuple[str, str]:
    """Whether all limits were kept, and by how much the nearest one."""
    joint, violation = worst(summary["max_limit_violation"])
    if violation is None:
        return "none", "no joint has one"
    units = {each["name"]: each["unit"] for each in summary["scenario"]["joints"]}
    distance = number(abs(violation), units[joint])
    return ("crossed", f"by {distance}, {joint}") if violation > 0 else ("kept", f"{distance} away, {joint}")


def goal_accuracy(summary: Summary) -> str:
    """The final errors of all tasks that are there at the end."""
    return ", ".join(
        f"{task['name']} {number(summary['task_error'][task['name']]['final'], unit(task))}"
        for task in by_level(summary["scenario"]["tasks"])
        if task["name"] in summary["task_error"] and task.get("stays", True)
    )


def comparison_row(name: str, summary: Summary) -> tuple[str, ...]:
    """One run as a row under COMPARISON_HEADER; the summary has the key "jump"."""
    jumps = summary["jump"]
    errors = (
        f"{task['name']} {number(summary['task_error'][task['name']]['final'], unit(task))}"
        for task in summary["scenario"]["tasks"]
        if task["name"] in summary["task_error"]
    )
    return (
        name,
        limits(summary),
        "\n".join(errors),
        f"{percent(jumps['at_dt'])}, {percent(jumps['at_fine_dt'])}, {number(jumps['ratio'])}",
        number(summary["time_to_goal"], "s") if summary["completed"] else goal(summary),
        number(summary["command_variation"]["overall"]),
    )


def goal(summary: Summary) -> str:
    """Whether the goal was reached, and when."""
    if not summary["completed"]:
        return f"stopped early, after {summary['cycles']} cycles"
    reached = summary["time_to_goal"]
    return "not reached" if reached is None else f"reached after {number(reached, 's')}"


def task_error(summary: Summary, task: Mapping[str, Any]) -> str:
    """A task's error at the end, and at its goal time if it has one."""
    error = summary["task_error"][task["name"]]
    text = f"{number(error['final'], unit(task))} at the end"
    if not task.get("stays", True):
        text += " (the task had left)"
    if error["at_goal_time"] is not None and task["goal_time"] is not None:
        at_goal_time = number(error["at_goal_time"], unit(task))
        text += f", {at_goal_time} at its goal time, {number(task['goal_time'], 's')}"
    return text


def limits(summary: Summary) -> str:
    """The joint that came closest to a limit or crossed it farthest, with its distance."""
    joint, violation = worst(summary["max_limit_violation"])
    if violation is None:
        return "no joint has one"
    units = {each["name"]: each["unit"] for each in summary["scenario"]["joints"]}
    if violation > 0:
        return f"crossed by {number(violation, units[joint])} ({joint})"
    return f"kept, {number(0.0 - violation, units[joint])} away ({joint})"


def clearance(summary: Summary) -> str:
    """The pair of a sphere and a body that came closest, with its distance."""
    pair, least = nearest_pair(summary)
    distance = number(abs(least), "m")
    return f"{distance} kept ({pair})" if least > 0 else f"penetration by {distance} ({pair})"


def jump(summary: Summary) -> str:
    """The largest change of the command between two cycles."""
    joint, fraction = worst(summary["max_command_jump"])
    return f"{percent(fraction)} of the bound in one cycle" + (f" ({joint})" if joint else "")


def cycles(summary: Summary) -> str:
    """How many cycles ran, and under which status flags."""
    counts = summary["status_counts"].items()
    return f"{summary['cycles']}: " + ", ".join(f"{flag} {count}" for flag, count in counts)


def cycle_time(summary: Summary) -> str:
    """Percentiles of the controller's computing time."""
    took = summary["cycle_time_us"]
    names = (("p50", "median"), ("p99", "99 % under"), ("p999", "99.9 % under"), ("max", "slowest"))
    return ", ".join(f"{label} {number(took[key], 'µs')}" for key, label in names)


def nearest_pair(summary: Summary) -> tuple[str, float]:
    """The pair of a sphere and a body that came closest, and its least distance [m]."""
    pairs = {pair: each for pair, each in summary["least_distance"].items() if pair != "overall"}
    pair = min(pairs, key=lambda pair: pairs[pair])
    return pair, pairs[pair]


def worst(by_joint: Mapping[str, float | None]) -> tuple[str, float | None]:
    """The joint with the largest value, and the value; ("", None) if there is none."""
    known = ((value, joint) for joint, value in by_joint.items() if joint != "overall" and value is not None)
    value, joint = max(known, default=(None, ""))
    return joint, value


def unit(task: Mapping[str, Any]) -> str:
    """The unit of a task's error."""
    return "m, rad" if task["unit"] == "mixed" else str(task["unit"])


def unit_of_rate(joint: Mapping[str, Any]) -> str:
    """The unit of a joint's velocity."""
    return f"{joint['unit']}/s"


def unit_of_command(joint: Mapping[str, Any], mode: str) -> str:
    """The unit of a joint's command in this mode."""
    if mode == "velocity":
        return unit_of_rate(joint)
    return "Nm" if joint["unit"] == "rad" else "N"


def scenario_facts(scenario: Mapping[str, Any], methods: Sequence[str]) -> list[tuple[str, str]]:
    """What was asked for, as (what, sentence) rows."""
    return [
        ("Scenario", str(scenario["file"])),
        ("Control", f"{scenario['mode']} mode, every {number(1e3 * scenario['dt'], 'ms')}"),
        ("Limits by", ", ".join(dict.fromkeys(methods))),
        ("Duration", number(scenario["duration"], "s")),
        ("Tasks", "; ".join(task_fact(task) for task in by_level(scenario["tasks"]))),
    ]


def by_level(tasks: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The tasks, the most important first."""
    return sorted(tasks, key=lambda task: int(task["level"]))


def task_fact(task: Mapping[str, Any]) -> str:
    """One task's level, name, type and goal time."""
    due = f", due at {number(task['goal_time'], 's')}" if task["goal_time"] is not None else ""
    return f"{task['level']}. {task['name']} ({task['type']}{due})"
