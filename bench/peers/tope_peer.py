"""tope itself, through the loop that its peers go through. Configurations:

unilateral, chain   ways to meet limits, with tope's defaults
tight               `unilateral` nearer to limits, weak directions given to lower levels later: steeper
margin=1e-4,...     `unilateral` with these options

Settings: orientation in level 1, position in level 2, posture in level 3; where the joints are to rest, no
posture, and damping in torque mode.
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

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        self.robot = tope.Robot.from_urdf(setup.urdf, setup.config)
        self.limits, self.settings = self.options(configuration)
        self.controller: tope.Controller
        self.t = 0.0

    def options(self, configuration: str) -> tuple[tope.LimitOptions, str]:
        """And their description."""
        if configuration in tope.LIMIT_METHODS:
            return tope.LimitOptions(method=configuration), "defaults"
        if configuration == "tight":
            headroom = (
                0.05 if self.setup.torque else 0.001
            )  # rad/s2 or rad/s: a half and a tenth of the default
            configuration = f"margin=1e-4,headroom={headroom},lock=0.02"
        named = {key: float(value) for key, value in (part.split("=") for part in configuration.split(","))}
        margin = {"margin": named.pop("margin")} if "margin" in named else {}
        return tope.LimitOptions(unilateral=tope.UnilateralOptions(**named), **margin), configuration

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
