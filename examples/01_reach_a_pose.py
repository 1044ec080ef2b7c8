"""Run: .venv/bin/python examples/01_reach_a_pose.py        Twin: 01_reach_a_pose.cpp.

The youBot turns and brings its gripper to a pose, and stops short of an obstacle and of a joint limit.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
robot.position_upper[robot.joint_names.index("base_x")] = 0.35  # an obstacle on the floor

dt = 1e-3
controller = tope.Controller(robot, mode="velocity", dt=dt)
goal_rotation = [0.0397, 0.9811, 0.1867, -0.0322]  # w, x, y, z
goal_position = [0.640, 0.105, 0.068]
reference = tope.Exponential(gain=2.0)
turn = controller.add(tope.FrameOrientation(frame="ee", target=goal_rotation, reference=reference), level=1)
reach = controller.add(tope.FramePosition(frame="ee", target=goal_position, reference=reference), level=2)

q = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
v = np.zeros(robot.nv)
path = []
for cycle in range(8000):
    v = controller.update(q, v, cycle * dt)
    q += dt * v  # a robot that follows its velocity commands
    path.append(q.copy())

turn_error = np.linalg.norm(controller.error(turn))
reach_error = np.linalg.norm(controller.error(reach))
room = np.minimum(robot.position_upper - q, q - robot.position_lower).min()
print(f"orientation error {turn_error:.2e} rad, position error {reach_error:.2e} m, distance kept {room:.4f}")
if __name__ == "__main__":
    sys.exit(0 if turn_error < 1e-3 and reach_error < 1e-3 and room > 0 else 1)
