"""Run: .venv/bin/python examples/03_change_tasks.py        Twin: 03_change_tasks.cpp.

Tasks enter, get another target, change places and leave while the robot moves: over half a second without a
jump, at once with one.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
dt = 1e-3


def commands(over: float) -> np.ndarray:
    """All commands of eight seconds in which every change takes `over` seconds."""
    controller = tope.Controller(robot, mode="velocity", dt=dt)
    turn = tope.FrameOrientation(frame="ee", target=[0.0397, 0.9811, 0.1867, -0.0322])
    near, far = (tope.FramePosition(frame="ee", target=[x, 0.1, 0.2]) for x in (0.6, 0.9))
    q = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
    u = np.zeros(robot.nv)
    sent = []
    for cycle in range(8000):
        if cycle == 1000:
            reach = controller.add(near, level=2, over=over)
        if cycle == 2000:
            turning = controller.add(turn, level=1, over=over)  # above what is there
        if cycle == 4000:
            controller.replace(reach, far, over=over)
        if cycle == 5000:
            controller.move(turning, level=3, over=over)
        if cycle == 6000:
            controller.remove(turning, over=over)
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        sent.append(u)
    return np.array(sent)


def largest_jump(sent: np.ndarray) -> float:
    """Largest change of a command from one cycle to the next [% of the joint's bound]."""
    return 100 * np.abs(np.diff(sent, axis=0) / robot.velocity_limit).max()


smooth, abrupt = commands(over=0.5), commands(over=0.0)
print(f"largest jump: {largest_jump(smooth):.2f} % over 0.5 s, {largest_jump(abrupt):.1f} % at once")
if __name__ == "__main__":
    sys.exit(0 if largest_jump(smooth) < 2 and largest_jump(abrupt) > 20 else 1)
