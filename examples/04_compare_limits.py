"""Run: .venv/bin/python examples/04_compare_limits.py        Twin: 04_compare_limits.cpp.

Three ways to meet the same limits. The largest jump of a command falls tenfold with the period where the
command is continuous, and stays where it is not.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
robot.position_upper[robot.joint_names.index("base_x")] = 0.35  # an obstacle on the floor


def commands(method: str, dt: float) -> np.ndarray:
    """All commands of three seconds in which two joints meet a limit."""
    controller = tope.Controller(robot, mode="velocity", dt=dt, limits=tope.LimitOptions(method=method))
    controller.add(tope.FrameOrientation(frame="ee", target=[0.0397, 0.9811, 0.1867, -0.0322]), level=1)
    controller.add(tope.FramePosition(frame="ee", target=[0.640, 0.105, 0.068]), level=2)
    q = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
    u = np.zeros(robot.nv)
    sent = []
    for cycle in range(round(3.0 / dt)):
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        sent.append(u)
    return np.array(sent)


def largest_jump(sent: np.ndarray) -> float:
    """Largest change of a command from one cycle to the next [% of the joint's bound]."""
    return 100 * np.abs(np.diff(sent, axis=0) / robot.velocity_limit).max()


ratios = {}
for method in ("unilateral", "chain", "switch"):
    coarse, fine = largest_jump(commands(method, 1e-3)), largest_jump(commands(method, 1e-4))
    ratios[method] = coarse / fine
    print(f"{method:10} jump {coarse:6.3f} % at 1 ms, {fine:6.3f} % at 0.1 ms, ratio {ratios[method]:5.2f}")
if __name__ == "__main__":
    sys.exit(0 if min(ratios["unilateral"], ratios["chain"]) > 9 and ratios["switch"] < 1.5 else 1)
