"""mink: a quadratic program of weighted tasks, on MuJoCo. Configurations:

default                  one FrameTask, costs 1 and 1
weights                  orientation and position at costs 100 to 1, weights 1e4 to 1, damping 1e-3
orientation-constraint   orientation as an equality, by the argument `constraints` of solve_ik, its target
                         kept within 0.75 rad: further, the program is infeasible from the start

Settings: gain x dt as the tasks' gain, PostureTask of cost 1e-3, ConfigurationLimit and VelocityLimit,
solver daqp as in its examples. The configuration limit's gain is 0.95, as it comes, in `default`, else
limit gain x dt.
"""

from __future__ import annotations

import mink
import mujoco
import numpy as np
from closed_loop import NEAR, ORIENTATION_WEIGHT, Peer, Setup, main
from geometry import Pose, towards

POSTURE_COST = 1e-3
PRIORITIES = {
    "default": "weights 1:1",
    "weights": "weights 1e4:1",
    "orientation-constraint": "orientation a constraint, rest by weights",
}


class OrientationTask(mink.FrameTask):
    """The last three rows: as a constraint, a FrameTask is all six whatever its costs."""

    def compute_error(self, configuration: mink.Configuration) -> np.ndarray:
        """Orientation alone."""
        return super().compute_error(configuration)[3:]

    def compute_jacobian(self, configuration: mink.Configuration) -> np.ndarray:
        """Orientation alone."""
        return super().compute_jacobian(configuration)[3:]


class Mink(Peer):
    """mink.solve_ik."""

    package = "mink"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup, self.kind = setup, configuration
        self.priorities = PRIORITIES[configuration]
        self.damping = 1e-12 if configuration == "default" else 1e-3
        self.settings = f"daqp, damping {self.damping:g}, posture cost {POSTURE_COST:g}"
        self.model = mujoco.MjModel.from_xml_path(setup.urdf)
        speeds = {joint.name: bound for joint, bound in zip(setup.joints, setup.velocity, strict=True)}
        self.velocity_limit = mink.VelocityLimit(self.model, speeds)

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        self.goal, self.dt = goal, dt
        self.configuration = mink.Configuration(self.model, self.setup.start)
        target = mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(goal.rotation), goal.position)
        part = self.setup.gain * dt
        self.constraints: list[OrientationTask] | None = None
        orientation_cost = ORIENTATION_WEIGHT**0.5 if self.kind == "weights" else 1.0
        if self.kind == "orientation-constraint":
            orientation = OrientationTask("ee", "body", position_cost=0.0, orientation_cost=1.0, gain=part)
            orientation.set_target(target)
            self.constraints = [orientation]
            orientation_cost = 0.0
        task = mink.FrameTask("ee", "body", position_cost=1.0, orientation_cost=orientation_cost, gain=part)
        task.set_target(target)
        posture = mink.PostureTask(self.model, cost=POSTURE_COST, gain=self.setup.posture_gain * dt)
        posture.set_target(self.setup.start)
        self.tasks = [task, posture]
        if self.kind == "default":
            limit = mink.ConfigurationLimit(self.model)
        else:
            limit = mink.ConfigurationLimit(self.model, gain=self.setup.limit_gain * dt)
        self.limits = [limit, self.velocity_limit]

    def prepare(self, q: np.ndarray) -> None:
        """A target that is near enough for a constraint."""
        if self.constraints is not None:
            here = self.setup.tip_at(q).rotation
            turned = mink.SO3.from_matrix(towards(here, self.goal.rotation, NEAR))
            target = mink.SE3.from_rotation_and_translation(turned, self.goal.position)
            self.constraints[0].set_target(target)

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        self.configuration.update(q)
        return mink.solve_ik(
            self.configuration,
            self.tasks,
            self.dt,
            "daqp",
            damping=self.damping,
            limits=self.limits,
            constraints=self.constraints,
        )


if __name__ == "__main__":
    main(Mink)
