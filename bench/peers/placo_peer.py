"""PlaCo: a quadratic program with soft and hard tasks. Configurations:

weights                  orientation and position soft, weighted 1e4 to 1
orientation-constraint   orientation hard, position soft; the orientation's target is kept within 0.75 rad:
                         further, the program is infeasible from the start

Settings: joint and velocity limits enabled, floating base masked, regularisation 1e-3 as its
documentation advises. Its tasks have no gain: the targets are moved by gain x dt of the error a cycle,
which is not timed. Its posture is a soft joints task of weight 1e-6.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import placo
from closed_loop import NEAR, ORIENTATION_WEIGHT, Peer, Setup, main
from geometry import Pose, exp3, log3, towards

REGULARISATION = 1e-3
POSTURE_WEIGHT = 1e-6
FLOATING_BASE = 7  # coordinates before those of the joints; 6 velocities


class Placo(Peer):
    """placo.KinematicsSolver."""

    package = "placo"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        self.hard = configuration == "orientation-constraint"
        self.priorities = "orientation a constraint, rest by weights" if self.hard else "weights 1e4:1"
        self.settings = f"regularisation {REGULARISATION:g}, posture weight {POSTURE_WEIGHT:g}"
        with tempfile.TemporaryDirectory() as folder:  # it wants a folder with a robot.urdf
            (Path(folder) / "robot.urdf").write_bytes(Path(setup.urdf).read_bytes())
            self.robot = placo.RobotWrapper(folder, placo.Flags.ignore_collisions)
        if list(self.robot.joint_names()) != [joint.name for joint in setup.joints]:
            raise RuntimeError(f"another order of joints: {list(self.robot.joint_names())}")

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        self.goal, self.dt = goal, dt
        self.solver = placo.KinematicsSolver(self.robot)
        self.solver.mask_fbase(True)
        self.solver.dt = dt
        self.solver.enable_joint_limits(True)
        self.solver.enable_velocity_limits(True)
        self.orientation = self.solver.add_orientation_task("ee", goal.rotation)
        self.orientation.configure(
            "orientation", "hard" if self.hard else "soft", 1.0 if self.hard else ORIENTATION_WEIGHT
        )
        self.position = self.solver.add_position_task("ee", goal.position)
        self.position.configure("position", "soft", 1.0)
        self.posture = self.solver.add_joints_task()
        self.posture.configure("posture", "soft", POSTURE_WEIGHT)
        self.solver.add_regularization_task(REGULARISATION)

    def prepare(self, q: np.ndarray) -> None:
        """The targets, one cycle ahead."""
        here = self.setup.tip_at(q)
        part = self.setup.gain * self.dt
        wanted = towards(here.rotation, self.goal.rotation, NEAR) if self.hard else self.goal.rotation
        self.next = Pose(
            here.rotation @ exp3(part * log3(here.rotation.T @ wanted)),
            here.position + part * (self.goal.position - here.position),
        )
        posture = q + self.setup.posture_gain * self.dt * (self.setup.start - q)
        self.next_posture = dict(zip((joint.name for joint in self.setup.joints), posture, strict=True))

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        state = self.robot.state
        coordinates = state.q
        coordinates[FLOATING_BASE:] = q
        state.q = coordinates
        self.robot.state = state
        self.robot.update_kinematics()
        self.orientation.R_world_frame = self.next.rotation
        self.position.target_world = self.next.position
        self.posture.set_joints(self.next_posture)
        return np.array(self.solver.solve(False))[FLOATING_BASE - 1 :] / self.dt


if __name__ == "__main__":
    main(Placo)
