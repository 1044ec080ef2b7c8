"""Run: .venv/bin/python examples/05_moving_target.py        Twin: 05_moving_target.cpp.

The gripper follows a point that swings to and fro. Told where the point is, it lags behind; told its
velocity too, it does not.
"""

import sys

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
dt, gain = 1e-3, 4.0
centre, amplitude, frequency = np.array([0.6, 0.1, 0.3]), np.array([0.0, 0.15, 0.05]), 0.25  # m, m, Hz


def target(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the point is at time t, and its velocity."""
    phase = 2 * np.pi * frequency * t
    return centre + np.sin(phase) * amplitude, 2 * np.pi * frequency * np.cos(phase) * amplitude


def errors(follow: object) -> np.ndarray:
    """Distance from the point in each cycle of eight seconds."""
    controller = tope.Controller(robot, mode="velocity", dt=dt)
    reference = tope.Exponential(gain=gain)
    reach = controller.add(tope.FramePosition(frame="ee", target=follow, reference=reference), level=1)
    q = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
    u = np.zeros(robot.nv)
    distance = []
    for cycle in range(8000):
        u = controller.update(q, u, cycle * dt)
        q += dt * u
        distance.append(np.linalg.norm(controller.error(reach)))
    return np.array(distance)


behind = errors(lambda t: (target(t)[0], np.zeros(3)))
led = errors(target)
lag, left = behind[4000:].max(), led[4000:].max()  # once the start is forgotten
expected = 2 * np.pi * frequency * np.linalg.norm(amplitude) / np.hypot(gain, 2 * np.pi * frequency)
print(
    f"largest error without the velocity {1e3 * lag:.2f} mm, {1e3 * expected:.2f} expected;"
    f" with it {1e3 * left:.3f}"
)
if __name__ == "__main__":
    sys.exit(0 if abs(lag - expected) < 0.01 * expected and left < 1e-3 else 1)
