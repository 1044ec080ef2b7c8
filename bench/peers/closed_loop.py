"""The closed loop that every Python peer goes through, and what is measured in it. cpp/closed_loop.hpp is
its twin.

A program of a peer is run as `python tsid_peer.py SCENARIO CONFIGURATION` and prints one JSON object.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from geometry import Joint, Pose, forward, rotation_angle

FINE = 10  # the continuity of a command is judged by cycles so many times shorter
NAMED = ("near", "main")  # goals of the benchmark beside the random ones
GIVE_UP = 0.2  # s of failures in a row after which a run ends
NEAR = (
    0.75  # rad; a target turned as far asks for no more than the joints' speed, which a constraint must not
)
ORIENTATION_WEIGHT = 1e4  # beside 1 of the position, where weights stand for levels; a cost is its root
CHECK = 0.05  # s, between looks whether a run has settled
BRAKING = 50.0  # rad/s2 or m/s2; how joints stop where a torque controller fails


class NoCommandError(Exception):
    """The peer gave no command; its message says why."""


@dataclass
class Setup:
    """The scenario's file; arrays are over the joints of the chain."""

    urdf: str = ""
    config: str = ""
    mode: str = ""
    dt: float = 0.0  # s
    duration: float = 0.0  # s
    repeats: int = 1
    gain: float = 0.0  # 1/s
    posture_gain: float = 0.0  # 1/s
    lowest: str = "posture"  # the last task: towards the start, or `rest`
    limit_gain: float = 0.0  # 1/s
    start: np.ndarray = field(default_factory=lambda: np.zeros(0))  # m and rad, as are the limits
    lower: np.ndarray = field(default_factory=lambda: np.zeros(0))
    upper: np.ndarray = field(default_factory=lambda: np.zeros(0))
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(0))
    effort: np.ndarray = field(default_factory=lambda: np.zeros(0))
    rotor_inertia: np.ndarray = field(default_factory=lambda: np.zeros(0))
    joints: list[Joint] = field(default_factory=list)
    tip: Pose = field(default_factory=lambda: Pose(np.eye(3), np.zeros(3)))
    goals: dict[str, Pose] = field(default_factory=dict)
    starts: dict[str, np.ndarray] = field(default_factory=dict)  # by goal, where each has its own
    chain: np.ndarray | slice = field(default_factory=lambda: slice(None))  # which of the joints move the tip
    fine: tuple[str, ...] = NAMED  # goals that are run with the short cycle too, and timed if there are any
    settled: float = 0.0  # m and rad; a run ends early once both errors are smaller

    def tip_at(self, q: np.ndarray) -> Pose:
        """Pose of the end-effector."""
        return forward(self.joints, self.tip, q[self.chain])

    @property
    def torque(self) -> bool:
        """Whether commands are torques, not velocities."""
        return self.mode == "torque"

    @property
    def bounds(self) -> np.ndarray:
        """Of the command, by joint."""
        return self.effort if self.torque else self.velocity


def read(file: Path) -> Setup:
    """Read a scenario's file."""
    setup = Setup()
    for line in file.read_text(encoding="utf-8").splitlines():
        key, *values = line.split()
        if key == "joint":
            axis, rotation, position = np.split(np.array(values[2:], dtype=float), [3, 12])
            prismatic = values[1] == "prismatic"
            setup.joints.append(Joint(values[0], prismatic, axis, rotation.reshape(3, 3), position))
        elif key == "goal":
            setup.goals[values[0]] = read_pose(values[1:])
        elif key == "start_of":
            setup.starts[values[0]] = np.array(values[1:], dtype=float)
        elif key == "tip":
            setup.tip = read_pose(values)
        elif key in ("urdf", "config", "mode", "lowest"):
            setattr(setup, key, values[0])
        elif key == "repeats":
            setup.repeats = int(values[0])
        elif key in ("dt", "duration", "gain", "posture_gain", "limit_gain", "settled"):
            setattr(setup, key, float(values[0]))
        elif key == "fine":
            setup.fine = tuple(values)
        elif key == "chain":
            setup.chain = np.array(values, dtype=int)
        else:
            setattr(setup, key, np.array(values, dtype=float))
    return setup


def read_pose(values: list[str]) -> Pose:
    """Nine numbers of a rotation, row by row, and three of a position."""
    return Pose(np.array(values[:9], dtype=float).reshape(3, 3), np.array(values[9:], dtype=float))


class Peer(Protocol):
    """A controller under measurement; inherited for prepare() alone."""

    package: str  # on PyPI
    priorities: str  # how it ranks its tasks
    settings: str  # all that its documentation leaves to the user

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew towards a goal."""

    def prepare(self, q: np.ndarray) -> None:
        """What its user has to compute for it: not timed."""

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """The velocities or torques of one cycle, its kinematics included: what is timed.

        May raise NoCommandError.
        """


class Plant(Protocol):
    """The robot that torques act on."""

    def acceleration(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """What the joints do."""


def run(
    peer: Peer, setup: Setup, goal: str, dt: float, plant: Plant | None = None
) -> tuple[dict[str, Any], np.ndarray]:
    """One run from rest towards a goal: what is reported of it, and the time of each cycle [us]."""
    cycles = round(setup.duration / dt)
    n = len(setup.start)
    q, v = setup.start.copy(), np.zeros(n)
    positions, velocities, commands = (np.zeros((cycles, n)) for _ in range(3))
    answered = np.zeros(cycles, dtype=bool)
    times = np.zeros(cycles)
    reasons: dict[str, int] = {}
    failing = 0
    cycle = 0
    peer.start(setup.goals[goal], dt)
    check = round(CHECK / dt)
    while cycle < cycles and failing * dt < GIVE_UP:
        peer.prepare(q)
        begin = time.perf_counter_ns()
        try:
            u = peer.command(q, v)
            times[cycle] = (time.perf_counter_ns() - begin) / 1e3
            if not np.all(np.isfinite(u)):
                raise NoCommandError("the command is not finite")
            answered[cycle] = True
        except Exception as error:  # whatever a peer raises is what it failed with
            times[cycle] = (time.perf_counter_ns() - begin) / 1e3
            reason = f"{type(error).__name__}: {error}".splitlines()[0][:100]
            reasons[reason] = reasons.get(reason, 0) + 1
            u = np.zeros(n)
        failing = 0 if answered[cycle] else failing + 1
        if plant is None:
            v = u.copy()
            q = q + v * dt
        else:
            braking = np.clip(-v / dt, -BRAKING, BRAKING)
            a = plant.acceleration(q, v, u) if answered[cycle] else braking
            q = q + v * dt + a * (dt * dt / 2)
            v = v + a * dt
        positions[cycle], velocities[cycle], commands[cycle] = q, v, u
        cycle += 1
        if cycle % check == 0 and max(errors(setup, goal, q).values()) < setup.settled:
            break
    done = slice(cycle)
    return {
        "goal": goal,
        "dt": dt,
        "cycles": cycle,
        "failures": int(np.sum(~answered[done])),
        "reasons": reasons,
        "gave_up": failing * dt >= GIVE_UP,
        **measured(setup, positions[done], velocities[done], commands[done], answered[done]),
        **errors(setup, goal, q),
    }, times[done]


def measured(
    setup: Setup, positions: np.ndarray, velocities: np.ndarray, commands: np.ndarray, answered: np.ndarray
) -> dict[str, float]:
    """Violation of limits [rad or m, negative: distance kept], excess over bounds, largest jump [share]."""
    beyond = np.maximum(positions - setup.upper, setup.lower - positions)
    jumps = np.abs(np.diff(commands, axis=0)) / setup.bounds
    jumps = jumps[answered[1:] & answered[:-1]]  # a failure is counted as such
    return {
        "violation": float(beyond.max()),
        "speed_excess": float((np.abs(velocities) / setup.velocity).max() - 1),
        "command_excess": float((np.abs(commands) / setup.bounds).max() - 1),
        "jump": float(jumps.max()) if len(jumps) else 0.0,
    }


def errors(setup: Setup, goal: str, q: np.ndarray) -> dict[str, float]:
    """How far the end-effector is from the goal [m and rad]."""
    there, wanted = setup.tip_at(q), setup.goals[goal]
    return {
        "position_error": float(np.linalg.norm(wanted.position - there.position)),
        "orientation_error": rotation_angle(there.rotation.T @ wanted.rotation),
    }


def measure(peer: Peer, setup: Setup, plant: Plant | None = None) -> dict[str, Any]:
    """All runs of a peer, and the cost of its cycle along those towards the named goals."""
    runs, times = [], []
    for goal in setup.goals:
        setup.start = setup.starts.get(goal, setup.start)
        done, cost = run(peer, setup, goal, setup.dt, plant)
        runs.append(done)
        if goal in (setup.fine or setup.goals):
            times.append(cost)
        if goal in setup.fine:
            runs.append(run(peer, setup, goal, setup.dt / FINE, plant)[0])
    p50, p99 = np.percentile(np.concatenate(times), [50, 99])
    return {
        "package": peer.package,
        "version": version(peer.package),
        "language": "Python",
        "priorities": peer.priorities,
        "settings": peer.settings,
        "p50_us": float(p50),
        "p99_us": float(p99),
        "runs": runs,
    }


def main(make: Callable[[Setup, str], Peer], make_plant: Callable[[Setup], Plant] | None = None) -> None:
    """The program of a peer."""
    scenario, configuration = sys.argv[1:]
    setup = read(Path(scenario))
    plant = make_plant(setup) if setup.torque and make_plant is not None else None
    print(json.dumps(measure(make(setup, configuration), setup, plant)))
