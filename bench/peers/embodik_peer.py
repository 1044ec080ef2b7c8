"""EmbodiK: strict levels, velocity solver. Configurations:

scale       orientation and position scaled down together with a level that cannot be met
min-error   the least error of each level

Settings: orientation in priority 0, position in 1, posture in 2; position and velocity limits enabled;
the gain as the tasks' weight, which is what its velocity solver takes it for.
"""

from __future__ import annotations

import embodik
import numpy as np
from closed_loop import NoCommandError, Peer, Setup, main
from geometry import Pose


class Embodik(Peer):
    """embodik.KinematicsSolver."""

    package = "embodik"
    priorities = "strict levels"

    def __init__(self, setup: Setup, configuration: str) -> None:
        self.setup = setup
        modes = embodik.TaskSolveMode
        self.solve_mode = modes.SCALE if configuration == "scale" else modes.MIN_ERROR
        self.settings = f"solve mode {self.solve_mode.name}, posture MIN_ERROR"
        self.robot = embodik.RobotModel(setup.urdf)

    def start(self, goal: Pose, dt: float) -> None:
        """Begin anew."""
        kinds = embodik.TaskType
        self.robot.update_configuration(self.setup.start)
        self.solver = embodik.KinematicsSolver(self.robot)
        self.solver.dt = dt
        self.solver.enable_position_limits(True)
        self.solver.enable_velocity_limits(True)
        orientation = self.solver.add_frame_task("orientation", "ee", kinds.FRAME_ORIENTATION)
        orientation.set_target_orientation(np.asfortranarray(goal.rotation))
        position = self.solver.add_frame_task("position", "ee", kinds.FRAME_POSITION)
        position.set_target_position(goal.position.copy())
        posture = self.solver.add_posture_task("posture")
        posture.set_target_configuration(self.setup.start.copy())
        for priority, task in enumerate((orientation, position, posture)):
            task.priority = priority
            task.solve_mode = self.solve_mode
            task.weight = self.setup.gain
        posture.solve_mode = embodik.TaskSolveMode.MIN_ERROR
        posture.weight = self.setup.posture_gain

    def command(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """One cycle."""
        result = self.solver.solve_velocity(q)
        if result.status != embodik.SolverStatus.SUCCESS:
            raise NoCommandError(f"{result.status} {result.status_message}")
        return np.array(result.joint_velocities)


if __name__ == "__main__":
    main(Embodik)
