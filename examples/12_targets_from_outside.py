"""Run: .venv/bin/python examples/12_targets_from_outside.py        Twin: 12_targets_from_outside.cpp.

Targets from a planner and from a camera: waypoints, passed at their times, and samples at 50 Hz that stay out
for half a second. A stream makes no jump of what would be one where samples are taken as they come.
"""

import sys
from collections.abc import Callable

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
dt, period, rate = 1e-3, 0.02, 20.0  # of the loop and of the camera [s], of the stream's follower [1/s]
home, radius, turn = (
    np.array([0.6, 0.0, 0.35]),
    0.1,
    1.2,
)  # of the circle on which a thing moves [m, m, rad/s]


def thing(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the thing is at time t, and its velocity."""
    c, s = radius * np.cos(turn * t), radius * np.sin(turn * t)
    return home + np.array([0.0, c, s]), turn * np.array([0.0, -s, c])


def follow(target: object, put: Callable = lambda *sample: None) -> tuple[np.ndarray, np.ndarray]:
    """The gripper's places and the commands in each cycle of eight seconds."""
    controller, observer = (tope.Controller(robot, mode="velocity", dt=dt) for _ in range(2))
    stiff = tope.Exponential(gain=20.0)
    controller.add(tope.FramePosition(frame="ee", target=target, reference=stiff), level=1)
    place = observer.add(tope.FramePosition(frame="ee", target=np.zeros(3)), level=1)  # its error: p
    q, u = np.array([0, 0, 0, 0, 0.4, 0.9, 0.6, 0]), np.zeros(robot.nv)
    places, sent = [], []
    for cycle in range(8000):
        if cycle >= 1000 and cycle % round(period / dt) == 0 and not 4000 <= cycle < 4500:
            put(cycle * dt, *thing(cycle * dt))  # in the loop to be repeatable; any thread may
        observer.update(q, u, cycle * dt)
        u = controller.update(q, u, cycle * dt)
        places.append(observer.error(place))
        sent.append(u)
        q += dt * u
    return np.array(places), np.array(sent)


def largest_jump(sent: np.ndarray) -> float:
    """Largest change of a command in a cycle, once the start is forgotten [% of the joint's bound]."""
    return 100 * np.abs(np.diff(sent[500:], axis=0) / robot.velocity_limit).max()


times, points = [1.0, 3.0, 5.0, 7.0], np.array([home, [0.7, 0.2, 0.3], [0.8, 0.0, 0.5], [0.6, -0.1, 0.2]])
planned, along = follow(tope.PointPath(times, points))
missed = np.linalg.norm(planned[np.rint(np.array(times) / dt).astype(int)] - points, axis=1).max()

stream = tope.PointStream(start=home, rate=rate)
streamed, smooth = follow(stream, stream.put)
latest = home.copy()  # a sample taken as it comes
stepped, abrupt = follow(lambda t: (latest, np.zeros(3)), lambda t, point, velocity: np.copyto(latest, point))

moved = np.array([thing(cycle * dt)[0] for cycle in range(8000)])
behind = np.linalg.norm(streamed - moved, axis=1)
lag = max(behind[2500:4000].max(), behind[6000:].max())
expected = 3 * radius * turn**2 / rate * (1 / rate + period / 2)  # a follower of three poles, fed so often
print(f"waypoints passed within {1e3 * missed:.3f} mm, largest jump {largest_jump(along):.2f} %")
print(f"behind the thing {1e3 * lag:.2f} mm, {1e3 * expected:.2f} expected")
print(f"largest jump {largest_jump(smooth):.2f} % by the stream, {largest_jump(abrupt):.1f} % without it")
if __name__ == "__main__":
    passed = missed < 1e-3 and abs(lag - expected) < 0.05 * expected
    continuous = max(largest_jump(along), largest_jump(smooth)) < 1 and largest_jump(abrupt) > 20
    sys.exit(0 if passed and continuous else 1)
