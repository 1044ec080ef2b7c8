"""RoboPlan's OInK: a quadratic program of tasks. Configurations:

default      orientation and position in one priority, costs 1 and 1
weights      the same, weighted 1e4 to 1
priorities   orientation in priority 1, position in 2, posture in 3: projected costs of one program

Settings: gain x dt as the tasks' gain, PositionLimit of limit gain x dt, VelocityLimit, posture cost 1e-3,
regularisation 1e-3.
"""

from __future__ import annotations

import numpy as np
from closed_loop import ORIENTATION_WEIGHT, Peer, Setup, main
from geometry import Pose
from roboplan.core import CartesianConfiguration, Scene, loadUrdfSceneDescription
from roboplan.optimal_ik import (
    ConfigurationTask,
    ConfigurationTaskOptions,
    FrameTask,
    FrameTaskOptions,
    Oink,
    OinkSettings,
    PositionLimit,
    VelocityLimit,
)

POSTURE_COST = 1e-3
REGULARISATION = 1e-3


class Roboplan(Peer):
    """roboplan.optimal_ik.Oink."""

    package = "roboplan"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        self.ranked = configuration == "priorities"
        self.orientation_cost = ORIENTATION_WEIGHT if configuration == "weights" else 1.0
        weights = "weights 1e4:1" if configuration == "weights" else "weights 1:1"
        self.priorities = "priorities by projected costs" if self.ranked else weights
        self.settings = f"regularisation {REGULARISATION:g}, posture cost {POSTURE_COST:g}"
        self.scene = Scene("youbot", loadUrdfSceneDescription(setup.urdf))

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        setup, n = self.setup, len(self.setup.start)
        self.dt = dt
        self.oink = Oink(self.scene, OinkSettings())
        target = np.eye(4, order="F")
        target[:3, :3], target[:3, 3] = goal.rotation, goal.position
        there = CartesianConfiguration("world", "ee", target)

        def frame_task(position: float, orientation: float, priority: int) -> FrameTask:
            options = FrameTaskOptions(
                position_cost=position,
                orientation_cost=orientation,
                task_gain=setup.gain * dt,
                priority=priority,
            )
            return FrameTask(self.oink, self.scene, there, options)

        if self.ranked:
            self.tasks = [frame_task(0.0, 1.0, 1), frame_task(1.0, 0.0, 2)]
        else:
            self.tasks = [frame_task(1.0, self.orientation_cost, 1)]
        options = ConfigurationTaskOptions(
            task_gain=setup.posture_gain * dt, priority=3 if self.ranked else 1
        )
        costs = np.full(n, POSTURE_COST)
        self.tasks.append(ConfigurationTask(self.oink, setup.start.copy(), costs, options))
        self.constraints = [
            PositionLimit(self.oink, setup.limit_gain * dt),
            VelocityLimit(self.oink, dt, setup.velocity.copy()),
        ]
        self.motion = np.zeros(n)

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        self.oink.solveIk(q, self.tasks, self.constraints, [], self.motion, REGULARISATION)
        return self.motion / self.dt


if __name__ == "__main__":
    main(Roboplan)
