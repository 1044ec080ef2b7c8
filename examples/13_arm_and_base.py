"""Run: .venv/bin/python examples/13_arm_and_base.py        Twin: 13_arm_and_base.cpp.

The base drives round a circle. The gripper keeps its pose as the base sees it. Then it is to reach a point
too far for the arm: by the arm alone, so that the base keeps to its circle although its level is the lower
one, and by the whole robot, where the base leaves it.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
dt, radius, turn = 1e-3, 0.5, 0.4  # s, m, rad/s
arm = [name for name in robot.joint_names if name.startswith("arm")]


def on_circle(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the base is to be at time t, and its velocity."""
    c, s = np.cos(turn * t), np.sin(turn * t)
    return radius * np.array([s, 1 - c, 0.0]), radius * turn * np.array([c, s, 0.0])


def heading(t: float) -> tuple[np.ndarray, np.ndarray]:
    """How the base is to be turned at time t, and its angular velocity."""
    return np.array([np.cos(turn * t / 2), 0, 0, np.sin(turn * t / 2)]), np.array([0.0, 0.0, turn])


def drive(*tasks: tope.Task) -> np.ndarray:
    """Error of each task, each below the one before, in each cycle of six seconds [m, rad]."""
    controller = tope.Controller(robot, mode="velocity", dt=dt)
    handles = [controller.add(task, level=level) for level, task in enumerate(tasks, start=1)]
    q, u = np.array([0, 0, 0, 0, 0.2, 0.6, 0.6, 0.3]), np.zeros(robot.nv)
    errors = []
    for cycle in range(6000):
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        errors.append([np.linalg.norm(controller.error(handle)) for handle in handles])
    return np.array(errors)


stiff = tope.Exponential(gain=5.0)
pose = tope.FramePose(frame="base_link", position=on_circle, rotation=heading, reference=stiff)
base = tope.SelectedRows(pose, rows=[0, 1, 5])  # what a base has of a pose: x, y and yaw
ahead, pitched = [0.6, 0.0, 0.35], [np.cos(0.95), 0.0, np.sin(0.95), 0.0]  # by 1.9 rad
carry = tope.RelativePose(
    frame="ee", seen_from="base_link", position=ahead, rotation=pitched, reference=stiff
)
reach = tope.FramePosition(frame="ee", target=[1.4, 0.3, 0.3], reference=stiff)
carried = drive(base, carry)
alone = drive(tope.JointGroup(reach, joints=arm), base)
whole = drive(reach, base)

runs = {"carried": carried, "arm alone": alone[:, ::-1], "whole robot": whole[:, ::-1]}  # base, gripper
worst = {name: run[2500:].max(axis=0) for name, run in runs.items()}  # once the start is forgotten
for name, (off, missed) in worst.items():
    print(f"{name:11} base off by {1e3 * off:7.2f} mm or mrad, gripper by {1e3 * missed:7.2f}")
if __name__ == "__main__":
    follows = max(*worst["carried"], worst["arm alone"][0], worst["whole robot"][1]) < 1e-3
    sys.exit(0 if follows and min(worst["arm alone"][1], worst["whole robot"][0]) > 0.1 else 1)
