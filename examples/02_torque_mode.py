"""Run: .venv/bin/python examples/02_torque_mode.py        Twin: 02_torque_mode.cpp.

Torques bring a rigid-body youBot to a pose in five seconds, short of an obstacle and of a joint limit. Python
has no plant of its own: a scenario file says what the twin writes out, and runs the same loop in C++.
"""

import sys

import numpy as np

import tope

run = tope.simulate("scenarios/youbot_torque.yaml")
joints = run.scenario["joints"]
torque = np.stack([run.log[f"u.{joint['name']}"] for joint in joints], axis=1)  # a row a cycle
turn_error, reach_error = (
    run.summary["task_error"][task]["at_goal_time"] for task in ("orientation", "position")
)
room = -run.summary["max_limit_violation"]["overall"]
speed = max(abs(run.log[f"v.{joint['name']}"][-1]) for joint in joints)
jump = np.abs(np.diff(torque, axis=0) / [joint["bound"] for joint in joints]).max()

print(
    f"at 5 s: orientation error {turn_error:.2e} rad, position error {reach_error:.2e} m;"
    f" fastest joint at the end {speed:.1e}"
)
print(f"distance kept from limits {room:.4f}, largest jump of a torque {100 * jump:.2f} % of its bound")
if __name__ == "__main__":
    sys.exit(0 if turn_error < 1e-3 and reach_error < 1e-3 and room > 0 and jump < 0.03 else 1)
