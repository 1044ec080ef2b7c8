"""Where a frame is at given joint positions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from tope import _core
from tope.simulation import as_text

ORIGIN = {
    "orientation": {"type": "frame_orientation", "target": {"quaternion": [1, 0, 0, 0]}},
    "position": {"type": "frame_position", "target": {"position": [0, 0, 0]}},
}


def pose(
    scenario: str, fixed: Mapping[str, Any], frame: str, joints: Mapping[str, float]
) -> dict[str, list[float]]:
    """Position [m] and quaternion (w, x, y, z) of a frame of a scenario's robot; other joints are at 0.

    These are the errors of tasks whose goal is the origin.
    """
    tasks = [
        {"name": name, "level": level, "frame": frame, **task}
        for level, (name, task) in enumerate(ORIGIN.items(), start=1)
    ]
    still = {
        "tasks": tasks,
        "initial": dict(joints),
        "dt": 1e-3,
        "duration": 1e-3,
        "limits.conditions": "report",
    }
    whole = {key: value for key, value in fixed.items() if key.split(".")[0] not in ("tasks", "initial")}
    loaded = _core.load_scenario(scenario, as_text({**whole, **still}))
    result = _core.simulate(loaded, None, None, True)
    first = dict(zip(result["columns"], result["data"][0], strict=True))
    turned = np.array([first[f"e.orientation.{i}"] for i in range(3)])
    return {
        "position": [float(first[f"e.position.{i}"]) for i in range(3)],
        "quaternion": quaternion(turned),
    }


def quaternion(turned: Any) -> list[float]:
    """Of a rotation vector [rad]."""
    angle = float(np.linalg.norm(turned))
    if angle == 0.0:
        return [1.0, 0.0, 0.0, 0.0]
    return [math.cos(0.5 * angle), *(float(each) for each in math.sin(0.5 * angle) / angle * turned)]
