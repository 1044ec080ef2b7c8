"""TSID: inverse dynamics as one quadratic program a cycle. Configurations:

weights                  orientation and position in level 1, weighted 1e4 to 1
weights+torque-bounds    the same with bounds of the torques
orientation-constraint   orientation in level 0, an equality beside the limits; its target is kept within
                         0.75 rad: further, the program is infeasible from the start

Settings: as its examples do, TaskSE3Equality twice with a mask, k_p = gain^2 and k_d = 2 gain in the
world's axes; TaskJointPosture with weight 1e-3; TaskJointPosVelAccBounds in level 0 with position,
velocity and acceleration bounds; SolverHQuadProgFast. It takes levels 0 and 1 alone, so strict order of
three tasks is not to be had. Its limits need acceleration bounds and a horizon, which are the user's
choice: those here make it fail and jump least (of 2, 5, 20 and 50 rad/s2; of 1 ms to 0.2 s).
"""

from __future__ import annotations

import numpy as np
import tsid
from closed_loop import NEAR, ORIENTATION_WEIGHT, NoCommandError, Peer, Setup, main
from geometry import Pose, towards
from rigid_body import RigidBody

ACCELERATION = {
    False: 2.0,
    True: 20.0,
}  # rad/s2 or m/s2, of the limits; by whether the orientation is a constraint
HORIZON = 0.2  # s, in which its limits must not be reached
POSTURE_WEIGHT = 1e-3


class Tsid(Peer):
    """tsid.InverseDynamicsFormulationAccForce."""

    package = "tsid"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        kind, _, self.torque_bounds = configuration.partition("+")
        self.constrained = kind == "orientation-constraint"
        self.acceleration = ACCELERATION[self.constrained]
        self.priorities = "orientation a constraint, rest by weights" if self.constrained else "weights 1e4:1"
        bounds = f"acceleration bounds {self.acceleration:g}, horizon of limits {HORIZON:g} s"
        self.settings = f"k_p {setup.gain**2:g}, k_d {2 * setup.gain:g}, {bounds}"

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        setup, n = self.setup, len(self.setup.start)
        self.goal, self.t, self.dt = goal, 0.0, dt
        self.robot = tsid.RobotWrapper(setup.urdf, [], False)
        self.robot.set_rotor_inertias(setup.rotor_inertia)
        self.robot.set_gear_ratios(np.ones(n))
        self.formulation = tsid.InverseDynamicsFormulationAccForce("tsid", self.robot, False)
        self.formulation.computeProblemData(0.0, setup.start, np.zeros(n))
        self.kept: list[object] = []  # the formulation does not keep its tasks alive
        if self.constrained:
            self.orientation = self.add_frame_task("orientation", goal, 3, 1.0, 0)
        else:
            self.orientation = self.add_frame_task("orientation", goal, 3, ORIENTATION_WEIGHT, 1)
        self.add_frame_task("position", goal, 0, 1.0, 1)
        self.add_posture()
        self.add_limits()
        self.solver = tsid.SolverHQuadProgFast("solver")
        self.solver.resize(self.formulation.nVar, self.formulation.nEq, self.formulation.nIn)

    def add_frame_task(
        self, name: str, goal: Pose, first: int, weight: float, level: int
    ) -> tsid.TaskSE3Equality:
        """Position or orientation of the end-effector, whose rows begin at `first`."""
        task = tsid.TaskSE3Equality(name, self.robot, "ee")
        task.setKp(self.setup.gain**2 * np.ones(6))
        task.setKd(2 * self.setup.gain * np.ones(6))
        task.useLocalFrame(False)
        mask = np.zeros(6)
        mask[first : first + 3] = 1.0
        task.setMask(mask)
        task.setReference(sample_of(goal.rotation, goal.position))
        self.formulation.addMotionTask(task, weight, level, 0.0)
        self.kept.append(task)
        return task

    def add_posture(self) -> None:
        """The start's posture, or rest."""
        n = len(self.setup.start)
        task = tsid.TaskJointPosture("posture", self.robot)
        stiffness = 0.0 if self.setup.lowest == "rest" else self.setup.posture_gain**2
        task.setKp(stiffness * np.ones(n))
        task.setKd(2 * self.setup.posture_gain * np.ones(n))
        sample = tsid.TrajectorySample(n)
        sample.value(self.setup.start)
        task.setReference(sample)
        self.formulation.addMotionTask(task, POSTURE_WEIGHT, 1, 0.0)
        self.kept += [task, sample]

    def add_limits(self) -> None:
        """Of positions, speeds and, where asked for, torques."""
        setup = self.setup
        limits = tsid.TaskJointPosVelAccBounds("limits", self.robot, HORIZON, False)
        limits.setPositionBounds(setup.lower, setup.upper)
        limits.setVelocityBounds(setup.velocity)
        limits.setAccelerationBounds(self.acceleration * np.ones(len(setup.start)))
        limits.setImposeBounds(True, True, True, True)
        self.formulation.addMotionTask(limits, 1.0, 0, 0.0)
        self.kept.append(limits)
        if self.torque_bounds:
            bounds = tsid.TaskActuationBounds("torque", self.robot)
            bounds.setBounds(-setup.effort, setup.effort)
            self.formulation.addActuationTask(bounds, 1.0, 0, 0.0)
            self.kept.append(bounds)

    def prepare(self, q: np.ndarray) -> None:
        """A target that is near enough for a constraint."""
        if self.constrained:
            here = self.setup.tip_at(q).rotation
            turned = towards(here, self.goal.rotation, NEAR)
            self.orientation.setReference(sample_of(turned, self.goal.position))

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        solution = self.solver.solve(self.formulation.computeProblemData(self.t, q, v))
        self.t += self.dt
        if solution.status != 0:
            raise NoCommandError(f"solver status {solution.status}")
        return self.formulation.getActuatorForces(solution)


def sample_of(rotation: np.ndarray, position: np.ndarray) -> tsid.TrajectorySample:
    """A pose at rest."""
    sample = tsid.TrajectorySample(12, 6)
    sample.value(np.concatenate([position, rotation.flatten("F")]))
    sample.derivative(np.zeros(6))
    sample.second_derivative(np.zeros(6))
    return sample


if __name__ == "__main__":
    main(Tsid, RigidBody)
