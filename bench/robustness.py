"""Run: make campaign-robustness.

The torque scenario on robots that differ from the one the controller believes in: what becomes of limits and
errors.
"""

from pathlib import Path

from rich.console import Console
from rich.table import Table

import tope
from tope import words

SCENARIO = Path(__file__).parents[1] / "scenarios/youbot_torque.yaml"
ROBOTS: dict[str, dict[str, object]] = {
    "as believed": {},
    "links 20 % heavier": {"plant.inertia_scale": 1.2},
    "links 20 % lighter": {"plant.inertia_scale": 0.8},
    "0.5 kg in the gripper": {"plant.payload": 0.5},
    "commands 2 ms late": {"plant.delay": 0.002},
    "joint friction": {"plant.friction": True},
    "torque noise, 1 % of the effort": {"plant.torque_noise": 0.01},
}


def main() -> None:
    """Run the scenario on each robot."""
    table = Table("robot", "limits", "orientation at 5 s", "position at 5 s", "and at the end", "jump")
    for name, keys in ROBOTS.items():
        summary = tope.simulate(SCENARIO, overrides=keys).summary
        errors = summary["task_error"]
        turn, reach = errors["orientation"], errors["position"]
        table.add_row(
            name,
            words.limits(summary),
            f"{1e3 * turn['at_goal_time']:.2f} mrad",
            f"{1e3 * reach['at_goal_time']:.2f} mm",
            f"{1e3 * turn['final']:.2f} mrad, {1e3 * reach['final']:.2f} mm",
            words.percent(summary["max_command_jump"]["overall"]),
        )
    Console().print(table)


if __name__ == "__main__":
    main()
