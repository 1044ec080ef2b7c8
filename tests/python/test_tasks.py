"""Pointing, centre of mass and selected rows from Python, against Pinocchio's own."""

from __future__ import annotations

from pathlib import Path

import kinematics
import numpy as np
import pytest

import tope

ROOT = Path(__file__).parents[2]
Q0 = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
POINT = np.array([1.0, 0.5, 0.3])


@pytest.fixture
def robot() -> tope.Robot:
    return tope.Robot.from_urdf(ROOT / "robots/youbot/youbot.urdf", ROOT / "robots/youbot/youbot.yaml")


def reached(robot: tope.Robot, task: tope.Task) -> np.ndarray:
    """Joint positions after 5 s of following the commands."""
    dt = 5e-3
    c = tope.Controller(robot, mode="velocity", dt=dt)
    c.add(task, level=1)
    q, u = Q0.copy(), np.zeros(8)
    for k in range(1000):
        u = c.update(q, u, k * dt).copy()
        q += dt * u
    return q


def named(robot: tope.Robot, q: np.ndarray) -> dict[str, float]:
    return dict(zip(robot.joint_names, q, strict=True))


def test_axis_points_at_the_point(robot: tope.Robot) -> None:
    q = reached(robot, tope.Pointing(frame="ee", axis=[0, 0, 2], target=POINT))
    ee = kinematics.frames(named(robot, q))["ee"]
    sight = POINT - ee.translation
    assert ee.rotation[:, 2] == pytest.approx(sight / np.linalg.norm(sight), abs=1e-3)


def test_centre_of_mass_is_pinocchios(robot: tope.Robot) -> None:
    target = kinematics.centre_of_mass(named(robot, Q0)) + np.array([0.1, -0.05, 0.005])
    q = reached(robot, tope.CenterOfMass(target=target))
    assert kinematics.centre_of_mass(named(robot, q)) == pytest.approx(target, abs=1e-3)


def test_rows_left_out_are_free(robot: tope.Robot) -> None:
    q = reached(robot, tope.SelectedRows(tope.FramePosition(frame="ee", target=[50, 50, 0.3]), rows=[2]))
    height = kinematics.frames(named(robot, q))["ee"].translation[2]
    assert height == pytest.approx(0.3, abs=1e-3)
    assert q[:3] == pytest.approx(Q0[:3], abs=1e-9)


def test_mistakes_are_named(robot: tope.Robot) -> None:
    c = tope.Controller(robot, mode="velocity", dt=1e-3)
    with pytest.raises(tope.ConfigError, match="axis: expected three numbers"):
        tope.Pointing(frame="ee", axis=[1, 0], target=POINT)
    with pytest.raises(tope.ConfigError, match=r"axis.*must not be zero"):
        c.add(tope.Pointing(frame="ee", axis=[0, 0, 0], target=POINT), level=1)
    with pytest.raises(tope.ConfigError, match=r"target.*finite"):
        c.add(tope.CenterOfMass(target=[np.nan, 0, 0]), level=1)
    with pytest.raises(tope.ConfigError, match="row 8: posture has rows 0 to 7"):
        c.add(tope.SelectedRows(tope.Posture(target=np.zeros(8)), rows=[8]), level=1)
