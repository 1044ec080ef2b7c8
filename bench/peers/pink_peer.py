"""Pink: a quadratic program of weighted tasks. Configurations:

default                  one FrameTask, costs 1 and 1
weights                  orientation and position at costs 100 to 1, weights 1e4 to 1, damping 1e-3
orientation-constraint   orientation as an equality, by the argument `constraints` of solve_ik, its target
                         kept within 0.75 rad: further, the program is infeasible from the start

Settings: gain x dt as the tasks' gain, PostureTask of cost 1e-3, configuration and velocity limits, solver
quadprog, which its documentation names. The configuration limit's gain is 0.5, as it comes, in
`default`, else limit gain x dt. Its safety check is off: it ends the program on an overshoot of 1e-6.
"""

from __future__ import annotations

import numpy as np
import pink
import pinocchio
from closed_loop import NEAR, ORIENTATION_WEIGHT, Peer, Setup, main
from geometry import Pose, towards
from pink.limits import ConfigurationLimit, VelocityLimit
from pink.tasks import FrameTask, PostureTask

POSTURE_COST = 1e-3
PRIORITIES = {
    "default": "weights 1:1",
    "weights": "weights 1e4:1",
    "orientation-constraint": "orientation a constraint, rest by weights",
}


class OrientationTask(FrameTask):
    """The last three rows: as a constraint, a FrameTask is all six whatever its costs."""

    def compute_error(self, configuration: pink.Configuration) -> np.ndarray:
        """Orientation alone."""
        return super().compute_error(configuration)[3:]

    def compute_jacobian(self, configuration: pink.Configuration) -> np.ndarray:
        """Orientation alone."""
        return super().compute_jacobian(configuration)[3:]


class Pink(Peer):
    """pink.solve_ik."""

    package = "pin-pink"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup, self.kind = setup, configuration
        self.priorities = PRIORITIES[configuration]
        self.damping = 1e-12 if configuration == "default" else 1e-3
        self.settings = f"quadprog, damping {self.damping:g}, posture cost {POSTURE_COST:g}"
        self.model = pinocchio.buildModelFromUrdf(setup.urdf)

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        self.goal, self.dt = goal, dt
        self.configuration = pink.Configuration(self.model, self.model.createData(), self.setup.start)
        target = pinocchio.SE3(goal.rotation, goal.position)
        part = self.setup.gain * dt
        self.constraints: list[OrientationTask] | None = None
        orientation_cost = ORIENTATION_WEIGHT**0.5 if self.kind == "weights" else 1.0
        if self.kind == "orientation-constraint":
            orientation = OrientationTask("ee", position_cost=0.0, orientation_cost=1.0, gain=part)
            orientation.set_target(target)
            self.constraints = [orientation]
            orientation_cost = 0.0
        task = FrameTask("ee", position_cost=1.0, orientation_cost=orientation_cost, gain=part)
        task.set_target(target)
        posture_gain = 0.0 if self.setup.lowest == "rest" else self.setup.posture_gain
        posture = PostureTask(cost=POSTURE_COST, gain=posture_gain * dt)
        posture.set_target(self.setup.start)
        self.tasks = [task, posture]
        self.limits = None  # its own: both kinds, gain 0.5 a cycle
        if self.kind != "default":
            limit = ConfigurationLimit(self.model, config_limit_gain=self.setup.limit_gain * dt)
            self.limits = [limit, VelocityLimit(self.model)]

    def prepare(self, q: np.ndarray) -> None:
        """A target that is near enough for a constraint."""
        if self.constraints is not None:
            here = self.setup.tip_at(q).rotation
            target = pinocchio.SE3(towards(here, self.goal.rotation, NEAR), self.goal.position)
            self.constraints[0].set_target(target)

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        self.configuration.update(q)
        return pink.solve_ik(
            self.configuration,
            self.tasks,
            self.dt,
            solver="quadprog",
            damping=self.damping,
            constraints=self.constraints,
            safety_break=False,
            limits=self.limits,
        )


if __name__ == "__main__":
    main(Pink)
