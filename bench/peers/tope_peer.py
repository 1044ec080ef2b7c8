"""tope itself, through the loop that its peers go through. Configurations: ways to meet limits,
`unilateral`, `chain`.

Settings: tope's defaults. Orientation in level 1, position in level 2, posture in level 3; or, if the joints
are to rest, nothing there and damping in torque mode.
"""

from __future__ import annotations

import numpy as np
from closed_loop import Peer, Plant, Setup, main
from geometry import Pose

import tope


class Tope(Peer):
    """tope.Controller."""

    package = "tope"
    priorities = "strict levels"
    settings = "defaults"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        self.robot = tope.Robot.from_urdf(setup.urdf, setup.config)
        self.limits = tope.LimitOptions(method=configuration)
        self.controller: tope.Controller
        self.t = 0.0

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        reference = tope.Exponential(gain=self.setup.gain)
        self.controller = tope.Controller(self.robot, mode=self.setup.mode, dt=dt, limits=self.limits)
        tasks = [
            tope.FrameOrientation(frame="ee", target=goal.rotation, reference=reference),
            tope.FramePosition(frame="ee", target=goal.position, reference=reference),
        ]
        if self.setup.lowest == "posture":
            posture = tope.Exponential(gain=self.setup.posture_gain)
            tasks.append(tope.Posture(target=self.setup.start, reference=posture))
        elif self.setup.torque:
            tasks.append(tope.Damping())  # velocities of least norm are at rest by themselves
        for level, task in enumerate(tasks, start=1):
            self.controller.add(task, level=level)
        self.t, self.dt = 0.0, dt

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        u = self.controller.update(q, v, self.t)
        self.t += self.dt
        return u


def plant(setup: Setup) -> Plant:
    """The robot; Pinocchio's Python is needed in torque mode alone."""
    from rigid_body import RigidBody  # noqa: PLC0415

    return RigidBody(setup)


if __name__ == "__main__":
    main(Tope, plant)
