"""Run: .venv/bin/python examples/06_moving_obstacle.py        Twin: 06_moving_obstacle.cpp.

A wall drives at the base and away again. The base gives way and comes back; the gripper stays where it is,
since the base's place is a lower level.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
base_x = robot.joint_names.index("base_x")
dt = 1e-3


def wall(t: float) -> tuple[float, float]:
    """How far the wall lets base_x go at time t [m], and how fast that changes [m/s]."""
    phase = 2 * np.pi * t / 10.0
    return 0.05 + 0.2 * np.cos(phase), -0.2 * 2 * np.pi / 10.0 * np.sin(phase)


controller = tope.Controller(robot, mode="velocity", dt=dt)
stiff = tope.Exponential(gain=10.0)
hold = controller.add(tope.FramePosition(frame="ee", target=[0.45, 0.0, 0.3], reference=stiff), level=1)
controller.add(tope.JointPosition(target={"base_x": 0.0}), level=2)
q = np.array([0, 0, 0, 0, 0.2, 0.9, 1.2, 0.3])
u = np.zeros(robot.nv)
where, room, error = [], [], []  # of base_x, before the wall, of the gripper
for cycle in range(20000):
    upper, rate = wall(cycle * dt)
    controller.move_limits("base_x", lower=-50.0, upper=upper, upper_rate=rate)
    u = controller.update(q, u, cycle * dt)
    q += dt * u
    where.append(q[base_x])
    room.append(wall((cycle + 1) * dt)[0] - q[base_x])
    error.append(np.linalg.norm(controller.error(hold)))

settled = max(error[5000:])
print(f"least distance from the wall {1e3 * min(room):.2f} mm, base_x pushed to {min(where):.3f} m")
print(f"gripper within {1e3 * settled:.3f} mm of its place from 5 s on")
if __name__ == "__main__":
    sys.exit(0 if min(room) > 0 and min(where) < -0.14 and settled < 1e-3 else 1)
