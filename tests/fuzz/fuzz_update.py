"""Run: make fuzz. Controllers of any stack at any state: a finite command within its bounds, and a status.

libFuzzer (by atheris) chooses mode, method, tasks and states from bytes. See fuzz_files.py for what ends it.
"""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

import atheris
import numpy as np

import tope

ROOT = Path(__file__).parents[2]
ROBOT = tope.Robot.from_urdf(ROOT / "robots/youbot/youbot.urdf", ROOT / "robots/youbot/youbot.yaml")
METHODS = ("unilateral", "chain", "multilinear", "intermediate", "paper", "switch", "potential_field", "none")
FRAMES = ("ee", "arm_link_3", "base_link")


def number(data: atheris.FuzzedDataProvider) -> float:
    """Any finite one, mostly of a usual size."""
    if data.ConsumeBool():
        return data.ConsumeFloatInRange(-10.0, 10.0)
    value = data.ConsumeFloat()
    return value if np.isfinite(value) else 0.0


def vector(data: atheris.FuzzedDataProvider, size: int) -> np.ndarray:
    """So many numbers."""
    return np.array([number(data) for _ in range(size)])


def reference(data: atheris.FuzzedDataProvider) -> object:
    """Either kind."""
    gain = data.ConsumeFloatInRange(0.01, 100.0)
    if data.ConsumeBool():
        return tope.Exponential(gain=gain)
    return tope.PredefinedTime(
        data.ConsumeFloatInRange(0.01, 10.0), gain=gain, replan_over=data.ConsumeFloatInRange(0.0, 2.0)
    )


def task(data: atheris.FuzzedDataProvider) -> object:
    """Any kind; raises tope.Error where it refuses the target."""
    kind = data.ConsumeIntInRange(0, 4)
    frame = FRAMES[data.ConsumeIntInRange(0, len(FRAMES) - 1)]
    if kind == 0:
        return tope.FramePosition(frame=frame, target=vector(data, 3), reference=reference(data))
    if kind == 1:
        return tope.FrameOrientation(frame=frame, target=vector(data, 4), reference=reference(data))
    if kind == 2:
        return tope.Posture(target=vector(data, ROBOT.nq), reference=reference(data))
    if kind == 3:
        name = ROBOT.joint_names[data.ConsumeIntInRange(0, ROBOT.nv - 1)]
        return tope.JointPosition(target={name: number(data)}, reference=reference(data))
    return tope.Damping()


def one_input(raw: bytes) -> None:
    """Build, update a few times, move limits on the way."""
    data = atheris.FuzzedDataProvider(raw)
    mode = ("velocity", "torque")[data.ConsumeIntInRange(0, 1)]
    limits = tope.LimitOptions(
        method=METHODS[data.ConsumeIntInRange(0, len(METHODS) - 1)],
        buffer=data.ConsumeFloatInRange(0.001, 0.5),
        gain=data.ConsumeFloatInRange(0.1, 50.0),
        potential_field=tope.PotentialFieldOptions(joints=["base_x"]),
        enforce_conditions=False,
    )
    controller = tope.Controller(ROBOT, mode=mode, dt=1e-3, limits=limits)
    handles = []
    for _ in range(data.ConsumeIntInRange(0, 6)):
        try:
            level, over = data.ConsumeIntInRange(1, 4), data.ConsumeFloatInRange(0.0, 1.0)
            handles.append(controller.add(task(data), level=level, over=over))
        except tope.Error:
            continue
    bound = ROBOT.velocity_limit if mode == "velocity" else ROBOT.effort_limit
    for _ in range(data.ConsumeIntInRange(1, 5)):
        if handles and data.ConsumeBool():
            controller.remove(handles.pop(), over=data.ConsumeFloatInRange(0.0, 1.0))
        if data.ConsumeBool():
            lower, upper, rate = vector(data, 3)
            with suppress(tope.Error):
                controller.move_limits("base_x", lower=lower, upper=upper, upper_rate=rate)
        u = controller.update(vector(data, ROBOT.nq), vector(data, ROBOT.nv), number(data))
        assert np.all(np.isfinite(u)), u
        assert np.all(np.abs(u) <= bound * (1 + 1e-9)), (u, controller.status_text)
        assert controller.status_text


if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
