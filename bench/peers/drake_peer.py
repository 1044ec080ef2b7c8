"""Drake's differential inverse kinematics: a quadratic program. Configurations:

function   DoDifferentialInverseKinematics: keeps the direction of the end-effector's twist, scales it down
system     DifferentialInverseKinematicsSystem: least squares on the twist, with a joint-centring cost

Settings: position and velocity limits. `function`: joint centring of 0.1 x the posture's gain.
`system`: Cartesian weight 100, posture gain the scenario's, velocity limits with its margins 0.01 and
0.1 to the position limits.
"""

from __future__ import annotations

import logging

import numpy as np
from closed_loop import NoCommandError, Peer, Setup, main
from geometry import Pose, log3
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import (
    DifferentialInverseKinematicsParameters,
    DifferentialInverseKinematicsStatus,
    DifferentialInverseKinematicsSystem,
    DoDifferentialInverseKinematics,
)
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import DofMask, JointLimits, RobotDiagramBuilder, SceneGraphCollisionChecker
from pydrake.systems.framework import BusValue

FASTEST = 100.0  # rad/s and m/s; the twist is bounded by the joints alone


class Function(Peer):
    """DoDifferentialInverseKinematics."""

    package = "drake"
    priorities = "direction kept, speed scaled; no order"

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self.settings = f"joint centring gain {0.1 * setup.posture_gain:g}"
        self.plant = MultibodyPlant(0.0)
        Parser(self.plant).AddModels(setup.urdf)
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        self.frame = self.plant.GetFrameByName("ee")

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        setup, n = self.setup, len(self.setup.start)
        self.goal = goal
        self.parameters = DifferentialInverseKinematicsParameters(n, n)
        self.parameters.set_time_step(dt)
        self.parameters.set_joint_position_limits((setup.lower, setup.upper))
        self.parameters.set_joint_velocity_limits((-setup.velocity, setup.velocity))
        self.parameters.set_nominal_joint_position(setup.start)
        self.parameters.set_joint_centering_gain(0.1 * setup.posture_gain * np.eye(n))

    def prepare(self, q: np.ndarray) -> None:
        """The twist towards the goal."""
        here = self.setup.tip_at(q)
        turn = here.rotation @ log3(here.rotation.T @ self.goal.rotation)
        self.twist = self.setup.gain * np.concatenate([turn, self.goal.position - here.position])

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, v)
        result = DoDifferentialInverseKinematics(
            self.plant, self.context, self.twist, self.frame, self.parameters
        )
        if result.status != DifferentialInverseKinematicsStatus.kSolutionFound:
            raise NoCommandError(str(result.status))
        return np.array(result.joint_velocities)


class System(Peer):
    """DifferentialInverseKinematicsSystem."""

    package = "drake"
    priorities = "weights"
    settings = "Cartesian weight 100, margins 0.01 and 0.1"

    def __init__(self, setup: Setup) -> None:
        self.setup = setup

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        system = DifferentialInverseKinematicsSystem
        builder = RobotDiagramBuilder(0.0)
        builder.parser().AddModels(self.setup.urdf)
        model = builder.plant().GetModelInstanceByName("youbot")
        diagram = builder.Build()
        checker = SceneGraphCollisionChecker(
            model=diagram,
            robot_model_instances=[model],
            edge_step_size=0.1,
            configuration_distance_function=lambda a, b: float(np.linalg.norm(a - b)),
        )
        recipe = system.Recipe()
        least_squares = system.LeastSquaresCost.Config()
        least_squares.cartesian_qp_weight = 100.0
        recipe.AddIngredient(system.LeastSquaresCost(least_squares))
        centring = system.JointCenteringCost.Config()
        centring.posture_gain = self.setup.posture_gain
        recipe.AddIngredient(system.JointCenteringCost(centring))
        limits = system.JointVelocityLimitConstraint.Config()
        limits.min_margin, limits.influence_margin = 0.01, 0.1
        recipe.AddIngredient(system.JointVelocityLimitConstraint(limits, JointLimits(diagram.plant())))
        fastest = SpatialVelocity(w=[FASTEST] * 3, v=[FASTEST] * 3)
        self.system = system(
            recipe,
            "world",
            checker,
            DofMask(len(self.setup.start), True),
            dt,
            K_VX=self.setup.gain * dt,
            Vd_TG_limit=fastest,
        )
        self.context = self.system.CreateDefaultContext()
        self.system.GetInputPort("nominal_posture").FixValue(self.context, self.setup.start)
        bus = BusValue()
        bus.Set("youbot::ee", Value(RigidTransform(RotationMatrix(goal.rotation), goal.position)))
        self.system.GetInputPort("desired_cartesian_poses").FixValue(self.context, Value(bus))
        self.position = self.system.GetInputPort("position")
        self.velocity = self.system.GetOutputPort("commanded_velocity")

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        self.position.FixValue(self.context, q)
        return np.array(self.velocity.Eval(self.context))


if __name__ == "__main__":
    logging.getLogger("drake").setLevel(logging.ERROR)
    main(lambda setup, configuration: {"function": Function, "system": System}[configuration](setup))
