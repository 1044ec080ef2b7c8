"""Run: .venv/bin/python examples/11_another_robot.py        Twin: 11_another_robot.cpp.

A Panda instead of the youBot, from a package's URDF and with no setting changed: on a table, where it meets a
joint limit on its way to one goal and cannot reach another, and on a base that drives, which can.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import tope

URDF = "package://example-robot-data/robots/panda_description/urdf/panda.urdf"
CONFIG = Path("robots/panda.yaml")
dt = 1e-3
behind, far = [-0.4, 0.2, 0.4], [1.6, 0.8, 0.5]  # m
ready = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])  # rad


def on_a_base() -> tope.Robot:
    """The same arm on joints base_x, base_y and base_yaw, by a key in its YAML file."""
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "panda_on_a_base.yaml"
        base = "base: {type: planar, speed: 0.8, turn_rate: 1.5}\n"  # m/s, rad/s
        config.write_text(CONFIG.read_text() + base)
        return tope.Robot.from_urdf(URDF, config)


def drive(robot: tope.Robot, start: np.ndarray, goal: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Joints and distance from the goal in each cycle of six seconds, the hand pointing down."""
    controller = tope.Controller(robot, mode="velocity", dt=dt)
    hand = "panda_hand_tcp"
    controller.add(tope.FrameOrientation(frame=hand, target=[0, 1, 0, 0]), level=1)  # w, x, y, z
    reach = controller.add(tope.FramePosition(frame=hand, target=goal), level=2)
    q, u = start.copy(), np.zeros(robot.nv)
    path, error = [], []
    for cycle in range(6000):
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        path.append(q.copy())
        error.append(np.linalg.norm(controller.error(reach)))
    return np.array(path), np.array(error)


arm, mobile = tope.Robot.from_urdf(URDF, CONFIG), on_a_base()
runs = {
    "on a table, behind": (arm, *drive(arm, ready, behind)),
    "on a table, far": (arm, *drive(arm, ready, far)),
    "on a base, far": (mobile, *drive(mobile, np.concatenate([np.zeros(3), ready]), far)),
}
left, room = [], []  # distance from the goal at the end [m], least from a limit [rad or m]
for name, (robot, path, error) in runs.items():
    left.append(error[-1])
    room.append(np.minimum(robot.position_upper - path, path - robot.position_lower).min())
    print(f"{name:18} {1e3 * left[-1]:8.2f} mm from the goal, {room[-1]:.4f} kept from limits")
if __name__ == "__main__":
    reached = max(left[0], left[2]) < 1e-3 and left[1] > 0.5
    sys.exit(0 if reached and 0 < room[0] < 0.01 and min(room) > 0 else 1)
