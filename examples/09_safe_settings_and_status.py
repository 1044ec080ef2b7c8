"""Run: .venv/bin/python examples/09_safe_settings_and_status.py        Twin: 09_safe_settings_and_status.cpp.

Settings that cannot keep a limit are refused with what would; in the loop nothing is thrown, and a status
says what acted in a cycle. All inequalities with their margins: `tope check SCENARIO`.
"""

import sys
from collections import Counter

import numpy as np

import tope

robot = tope.Robot.from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml")
robot.position_upper[robot.joint_names.index("base_x")] = 0.35  # an obstacle on the floor
refused = 0
for dt, limits in (
    (0.02, {"gain": 60.0}),  # too hard for so slow a loop
    (0.02, {"method": "chain", "buffer": 0.01}),  # a cycle would leap across the buffer
    (1e-3, {"method": "unilaterl"}),
):
    try:
        tope.Controller(robot, mode="velocity", dt=dt, limits=tope.LimitOptions(**limits))
    except tope.ConfigError as error:
        refused += 1
        print(f"refused: {error}")

dt = 1e-3
controller = tope.Controller(robot, mode="velocity", dt=dt)
promise = tope.PredefinedTime(2.0)
goal = [1.4, 0.2, 0.4]  # out of reach
reach = controller.add(tope.FramePosition(frame="ee", target=goal, reference=promise), level=1)
q, u = np.array([0, 0, 0, 0, 0.4, 0.9, 0.6, 1.8]), np.zeros(robot.nv)
events, distance = [], []
for cycle in range(4000):
    u = controller.update(q, u, cycle * dt)
    q += dt * u
    events.append(controller.status.events)
    distance.append(np.linalg.norm(controller.error(reach)))
count = Counter(event for cycle in events for event in cycle)
print(f"of 4000 cycles: {dict(count)}; at the end: {controller.status_text}")

u = controller.update(np.full(robot.nq, np.nan), u, 4.0)  # a sensor fails
print(f"state that is no number: command {u}, status {controller.status}")
stopped = not u.any() and controller.status.events == ["bad_input"]
if __name__ == "__main__":
    sys.exit(0 if refused == 3 and stopped and count["limit"] > 1000 and count["held"] > 1000 else 1)
