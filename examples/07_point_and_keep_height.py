"""Run: .venv/bin/python examples/07_point_and_keep_height.py        Twin: 07_point_and_keep_height.cpp.

The gripper points at a thing that goes round, as a camera would, and keeps its height: one row of a position.
Its posture takes what these leave, so that the joints are the same after each round.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
dt, turns_per_second = 1e-3, 0.2


def thing(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the thing is at time t, and its velocity."""
    rate = 2 * np.pi * turns_per_second
    c, s = np.cos(rate * t), np.sin(rate * t)
    return np.array([1.5 + 0.3 * c, 0.3 * s, 0.2]), np.array([-0.3 * rate * s, 0.3 * rate * c, 0.0])


start = np.array([0, 0, 0, 0, 0.3, 0.5, 0.5, 0.0])
controller = tope.Controller(robot, mode="velocity", dt=dt)
point = controller.add(tope.Pointing(frame="ee", axis=[0, 0, 1], target=thing), level=1)
height = tope.SelectedRows(tope.FramePosition(frame="ee", target=[0, 0, 0.4]), rows=[2])
keep = controller.add(height, level=2)
controller.add(tope.Posture(target=start), level=3)
q, u = start.copy(), np.zeros(robot.nv)
path, angle, off = [], [], []
for cycle in range(15000):
    u = controller.update(q, u, cycle * dt)
    q += dt * u
    path.append(q.copy())
    angle.append(np.linalg.norm(controller.error(point)))
    off.append(abs(controller.error(keep)[0]))

drift = np.abs(path[-1] - path[-5001]).max()  # a round takes 5000 cycles
worst_angle, worst_off = max(angle[5000:]), max(off[5000:])
print(f"from 5 s on: points within {1e3 * worst_angle:.2f} mrad, height within {1e3 * worst_off:.3f} mm")
print(f"joints after another round: within {drift:.1e}")
if __name__ == "__main__":
    sys.exit(0 if worst_angle < 1e-3 and worst_off < 1e-3 and drift < 1e-3 else 1)
