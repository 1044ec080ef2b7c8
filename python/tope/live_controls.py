"""The sliders and buttons of the live page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import viser

from tope import _core
from tope.session import Session

Scenario = Mapping[str, Any]
Keys = dict[str, Any]

SIDES = ("lower", "upper")
STEP = 0.001  # of a limit [m, rad]
WIDEST = 2.0  # slider of a limit that the robot itself hardly has [m, rad]


class LiveControls:
    """Controls that change a session. Those of the scenario are labelled with its keys."""

    def __init__(
        self, gui: viser.GuiApi, session: Session, change: Callable[[Mapping[str, Any]], None]
    ) -> None:
        """Add all controls; `change` replaces keys of the scenario."""
        self.gui, self.session, self.change = gui, session, change
        self.bound: list[tuple[Any, Callable[[Scenario], Any]]] = []
        scenario = session.scenario
        self.add_run_buttons()
        self.add_method(scenario)
        self.add_slider("limits.buffer", 0.02, 0.3, lambda now: now["joints"][0]["buffer"])
        self.add_slider("limits.gain", 0.5, 20.0, lambda now: now["limit_gain"])
        with gui.add_folder("Tasks"):
            for number, task in enumerate(scenario["tasks"]):
                self.add_task(number, task)
        with gui.add_folder("Limits", expand_by_default=False):
            for number, joint in enumerate(scenario["joints"]):
                self.add_limits(number, joint)

    def show(self, scenario: Scenario) -> None:
        """Show the scenario as it is."""
        for handle, read in self.bound:
            handle.value = read(scenario)

    def bind(self, handle: Any, keys: Callable[[], Keys], read: Callable[[Scenario], Any]) -> None:
        """Let a control replace keys of the scenario, and show what `read` finds there."""
        self.bound.append((handle, read))

        def moved(event: viser.GuiEvent[Any]) -> None:
            if event.client is not None:  # else we moved it ourselves
                self.change(keys())

        handle.on_update(moved)

    def add_run_buttons(self) -> None:
        """Pause and restart."""
        pause = self.gui.add_checkbox("Pause", initial_value=False)

        @pause.on_update
        def _(_: Any) -> None:
            self.session.paused = pause.value

        self.gui.add_button("Restart").on_click(lambda _: self.session.restart())

    def add_method(self, scenario: Scenario) -> None:
        """The way to keep limits."""
        method = self.gui.add_dropdown("limits.method", _core.LIMIT_METHODS, initial_value=scenario["method"])
        self.bind(method, lambda: {"limits.method": method.value}, lambda now: now["method"])

    def add_slider(self, key: str, low: float, high: float, read: Callable[[Scenario], float]) -> None:
        """A slider for a key of the scenario."""
        value = read(self.session.scenario)
        low, high = min(low, value), max(high, value)
        slider = self.gui.add_slider(key, min=low, max=high, step=(high - low) / 500, initial_value=value)
        self.bind(slider, lambda: {key: slider.value}, read)

    def add_task(self, number: int, task: Mapping[str, Any]) -> None:
        """A task's presence and its gain."""
        present = self.gui.add_checkbox(f"{task['level']}. {task['name']}", initial_value=task["starts"])
        present.on_update(lambda _: self.session.show_task(task["name"], present.value))
        if task["type"] == "damping":
            return
        key = f"tasks.{number}.reference"
        kind = "exponential" if task["goal_time"] is None else "predefined_time"  # the file need not say it
        high = max(20.0, task["gain"])
        slider = self.gui.add_slider(
            f"gain of {task['name']}", min=0.2, max=high, step=0.1, initial_value=task["gain"]
        )
        self.bind(
            slider,
            lambda: {f"{key}.type": kind, f"{key}.gain": slider.value},
            lambda now: now["tasks"][number]["gain"],
        )

    def add_limits(self, number: int, joint: Mapping[str, Any]) -> None:
        """A joint's limits, to pull in."""
        lower, upper = shown_limits(joint)
        slider = self.gui.add_multi_slider(
            f"{joint['name']} [{joint['unit']}]",
            min=min(lower, -WIDEST),
            max=max(upper, WIDEST),
            step=STEP,
            initial_value=(lower, upper),
            min_range=4 * joint["buffer"],
        )

        def moved() -> Keys:
            shown = shown_limits(self.session.scenario["joints"][number])
            return {
                f"limits.joints.{joint['name']}.{side}": now
                for side, now, was in zip(SIDES, slider.value, shown, strict=True)
                if abs(now - was) > 0.6 * STEP  # more than the slider rounds
            }

        self.bind(slider, moved, lambda now: shown_limits(now["joints"][number]))


def shown_limits(joint: Mapping[str, Any]) -> tuple[float, float]:
    """A joint's limits as a slider shows them; one that is missing or far away at its end."""
    lower, upper = (
        joint[side] if joint[side] is not None and abs(joint[side]) < 2 * np.pi else sign * WIDEST
        for side, sign in zip(SIDES, (-1.0, 1.0), strict=True)
    )
    return lower, upper
