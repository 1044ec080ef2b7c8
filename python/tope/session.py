"""A scenario that runs at real time and that anyone may change meanwhile."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tope import _core

Array = NDArray[np.float64]

PERIOD = 1 / 120  # between calls of the simulation [s]; it runs all cycles that are due
CATCH_UP = 0.25  # what it makes up for after a delay [s]; longer ones are lost
FADE = 0.5  # how long a task takes to enter or leave [s]


@dataclass(frozen=True)
class State:
    """The simulation at one moment, in the order of the scenario's joints.

    `lost` is the time that the machine was too slow for [s]; errors are None for tasks that are not present.
    """

    time: float
    position: Array
    velocity: Array
    command: Array
    upper: Array
    lower: Array
    errors: Mapping[str, float | None]
    goals: Mapping[str, tuple[Array, Sequence[float]]]
    status: str
    status_text: str
    lost: float


def described(loaded: _core.Scenario, live: _core.LiveSimulation) -> dict[str, Any]:
    """A scenario's description, with the gain that its limits are kept with."""
    return {**loaded.describe(), "limit_gain": live.limit_gain}


class Session:
    """A live simulation on a thread of its own. Every method may be called from any thread."""

    def __init__(self, scenario: str | os.PathLike[str], overrides: Mapping[str, str]) -> None:
        """Errors: Error for a scenario that cannot be loaded."""
        self.file = os.fspath(scenario)
        self.overrides = dict(overrides)
        loaded = _core.load_scenario(self.file, self.overrides)
        self.paused = False
        self._live = _core.LiveSimulation(loaded)
        self.scenario = described(loaded, self._live)
        self._absent: set[str] = set()
        self._lost = 0.0
        self._lock = threading.Lock()  # held while the simulation is used or replaced
        self._changes = threading.Lock()  # held by one change of the scenario at a time
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="simulation", daemon=True)
        self._thread.start()

    def state(self) -> State:
        """The present state."""
        with self._lock:
            live = self._live
            return State(
                time=live.time,
                position=live.position,
                velocity=live.velocity,
                command=live.command,
                upper=live.upper_activation,
                lower=live.lower_activation,
                errors=live.errors,
                goals=live.goals,
                status=live.status,
                status_text=live.status_text,
                lost=self._lost,
            )

    def put_goal(self, frame: str, position: Sequence[float], wxyz: Sequence[float]) -> None:
        """Put the goal of a frame to a position [m] and a unit quaternion."""
        with self._lock:
            self._live.put_goal(frame, np.asarray(position, dtype=float), tuple(wxyz))

    def change(self, keys: Mapping[str, Any]) -> None:
        """Replace keys of the scenario file; raises ConfigError and changes nothing if they do not do."""
        with self._changes:
            overrides = {**self.overrides, **{key: str(value) for key, value in keys.items()}}
            loaded = _core.load_scenario(self.file, overrides)
            with self._lock:
                self._live.adopt(loaded)
                self.scenario = described(loaded, self._live)
            self.overrides = overrides

    def show_task(self, task: str, present: bool) -> None:
        """Let a task enter or leave smoothly."""
        with self._lock:
            if present:
                self._live.insert(task, over=FADE)
                self._absent.discard(task)
            else:
                self._live.remove(task, over=FADE)
                self._absent.add(task)

    def restart(self) -> None:
        """Start anew from the scenario's initial state; goals and tasks stay as they are."""
        with self._changes:
            fresh = _core.LiveSimulation(_core.load_scenario(self.file, self.overrides))
            with self._lock:
                for frame, (position, wxyz) in self._live.goals.items():
                    fresh.put_goal(frame, position, wxyz)
                for task in self._absent:
                    fresh.remove(task, over=0.0)
                self._live = fresh

    def close(self) -> None:
        """End the simulation's thread."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        last = time.perf_counter()
        while not self._stop.wait(PERIOD):
            now = time.perf_counter()
            elapsed, last = now - last, now
            if self.paused:
                continue
            due = min(elapsed, CATCH_UP)
            with self._lock:
                self._lost += elapsed - due
                self._live.advance(due)
