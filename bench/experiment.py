"""Run: make experiment.

The experiments in MuJoCo: goals, smooth against hard limits, faults, and the real-time factor, as Markdown
tables. Errors and limits are those of the true state; "as seen" is what the robot's sensors say. Fails if a
joint touches its stop.
"""

from collections.abc import Mapping
from pathlib import Path
from time import process_time
from typing import Any

from rich import box
from rich.console import Console
from rich.progress import track
from rich.table import Table

import tope
from tope.words import number, percent

SCENARIOS = Path(__file__).parents[1] / "scenarios"
SCENARIO = {mode: SCENARIOS / f"youbot_experiment_{mode}.yaml" for mode in ("velocity", "torque")}
SMOOTH = "unilateral"
HARD = ("switch", "potential_field")
ODOMETRY = {"plant.sensors.localisation": "odometry"}
# The files in scenarios/faults hold one mode each of these.
FAULTS: dict[str, dict[str, Any]] = {
    "none": {},
    "front left wheel without grip, 0.1 s to 0.6 s": {
        "plant.faults.lost_grip": {"wheel": "front_left", "at": 0.1, "for": 0.5}
    },
    "the same, with odometry": {
        "plant.faults.lost_grip": {"wheel": "front_left", "at": 0.1, "for": 0.5},
        **ODOMETRY,
    },
    "front left wheel without grip, 4.3 s to 4.8 s": {
        "plant.faults.lost_grip": {"wheel": "front_left", "at": 4.3, "for": 0.5}
    },
    "controller stalls for 5 ms at 0.05 s": {"plant.faults.stall": {"at": 0.05, "for": 0.005}},
    "controller stalls for 5 ms at 4.45 s": {"plant.faults.stall": {"at": 4.45, "for": 0.005}},
    "encoder noise of 1 mrad": {"plant.sensors.encoder_noise": 1e-3},
    "and localiser noise of 1 mm, 1 mrad": {
        "plant.sensors.encoder_noise": 1e-3,
        "plant.sensors.localiser_noise": 1e-3,
    },
    "all that the sensors say is 10 ms old": {"plant.sensors.latency": 0.01},
    "0.5 kg picked up at 2 s": {"plant.faults.payload": {"mass": 0.5, "at": 2.0}},
    "obstacle comes 0.15 m at 0.1 m/s from 4 s on": {
        "plant.faults.obstacle": {"velocity": -0.1, "at": 4.0, "for": 1.5},
        "limits.joints.base_x": {"upper": 0.35, "upper_motion": {"velocity": -0.1, "at": 3.5, "for": 1.5}},
    },
}

Summary = Mapping[str, Any]


def run(mode: str, overrides: Mapping[str, Any]) -> Summary:
    """The summary of an experiment."""
    return tope.simulate(SCENARIO[mode], overrides=overrides).summary


def table(*columns: str) -> Table:
    """A table that can be pasted into the documents."""
    return Table(*columns, box=box.MARKDOWN)


def errors(summary: Summary, which: str) -> str:
    """Position and orientation error."""
    position, orientation = (summary["task_error"][task][which] for task in ("position", "orientation"))
    return f"{number(1e3 * position, 'mm')}, {number(1e3 * orientation, 'mrad')}"


def goal(summary: Summary) -> str:
    """When both errors went below their tolerances for good."""
    at = summary["time_to_goal"]
    return "no" if at is None else f"{at:.2f} s"


def distance(summary: Summary) -> str:
    """Least distance from a limit, or how far it was crossed."""
    joint, violation = max(
        (each for each in summary["max_limit_violation"].items() if each[0] != "overall"),
        key=lambda each: each[1],
    )
    return f"{joint} {'crossed by' if violation > 0 else 'keeps'} {1e3 * abs(violation):.1f}e-3"


def contacts(summary: Summary) -> str:
    """What was touched."""
    return ", ".join(f"{what} ({force:.0f})" for what, force in summary["contacts"].items()) or "none"


def goals() -> Table:
    """Goals with an ideal localiser and with odometry."""
    rows = table("experiment", "goal reached", "error at the end", "as seen", "drift", "limits", "contacts")
    for mode in SCENARIO:
        for name, overrides in (("ideal localiser", {}), ("odometry", ODOMETRY)):
            done = run(mode, overrides)
            drift = [done["sensor_error"][joint] for joint in ("base_x", "base_y", "base_yaw")]
            rows.add_row(
                f"{mode}, {name}",
                goal(done),
                errors(done, "final"),
                errors(done, "measured"),
                f"{1e3 * drift[0]:.1f}, {1e3 * drift[1]:.1f} mm, {1e3 * drift[2]:.1f} mrad",
                distance(done),
                contacts(done),
            )
    return rows


def smoothness() -> Table:
    """Smooth against hard limits over the last half of the run.

    Root mean square of the end-effector's acceleration, linear and angular, and the largest total variation
    of a joint's velocity, over the joint's speed bound. Jump: the command's largest in a cycle of the whole
    run, as a share of its bound.
    """
    rows = table("mode", "limits", "goal", "m/s2", "rad/s2", "variation of velocity", "jump", "contacts")
    for mode in SCENARIO:
        reference: list[float] = []
        for method in (SMOOTH, *HARD):
            done = hard_run(mode, method)
            figures = [done["task_error"][task]["acceleration"] for task in ("position", "orientation")]
            figures.append(done["velocity_variation"]["overall"])
            reference = reference or figures
            cells = [
                number(value) + ("" if method == SMOOTH else f" (x {value / smooth:.1f})")
                for value, smooth in zip(figures, reference, strict=True)
            ]
            jump = percent(done["max_command_jump"]["overall"])
            rows.add_row(mode, method, goal(done), *cells, jump, contacts(done))
    return rows


def hard_run(mode: str, method: str) -> Summary:
    """A run under a method; the potential field of velocity mode is the paper's first experiment."""
    if mode == "velocity" and method == "potential_field":
        return tope.simulate(SCENARIOS / "youbot_experiment_potential_field.yaml").summary
    return run(mode, {"limits.method": method})


def faults() -> tuple[Table, int]:
    """Every fault in both modes, and how many joints touched a stop."""
    rows = table("fault", "mode", "goal reached", "error at the end", "limits", "contacts")
    stops = 0
    cases = [(name, mode) for name in FAULTS for mode in SCENARIO]
    for name, mode in track(cases, description="faults", transient=True, console=Console(stderr=True)):
        done = run(mode, FAULTS[name])
        stops += sum(what.endswith("at its stop") for what in done["contacts"])
        rows.add_row(name, mode, goal(done), errors(done, "final"), distance(done), contacts(done))
    return rows, stops


def real_time_factor() -> Table:
    """Simulated time over processor time of the one thread, controller and log included."""
    rows = table("mode", "real-time factor")
    for mode in SCENARIO:
        start = process_time()
        done = run(mode, {})
        rows.add_row(mode, f"{done['scenario']['duration'] / (process_time() - start):.0f}")
    return rows


def main() -> None:
    """Print every table."""
    console = Console(width=200)
    fault_rows, stops = faults()
    for rows in (goals(), smoothness(), fault_rows, real_time_factor()):
        console.print(rows)
    raise SystemExit(1 if stops else 0)


if __name__ == "__main__":
    main()
