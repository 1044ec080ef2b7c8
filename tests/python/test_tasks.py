"""Tasks and paths from Python, against Pinocchio's own kinematics and numpy."""

from __future__ import annotations

import threading
import time
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


ARM = [f"arm_joint_{i}" for i in range(1, 6)]


def test_frame_is_where_another_is_to_see_it(robot: tope.Robot) -> None:
    frames = kinematics.frames(named(robot, Q0))
    base, ee = frames["base_link"], frames["ee"]
    seen = base.rotation.T @ (ee.translation - base.translation) + np.array([0.02, 0.01, -0.03])
    q = reached(robot, tope.RelativePose(frame="ee", seen_from="base_link", position=seen))
    frames = kinematics.frames(named(robot, q))
    base, ee = frames["base_link"], frames["ee"]
    assert base.rotation.T @ (ee.translation - base.translation) == pytest.approx(seen, abs=1e-3)
    assert q[:3] == pytest.approx(Q0[:3], abs=1e-12)  # the base carries both alike


def test_manipulability_is_raised_where_the_hand_stays(robot: tope.Robot) -> None:
    dt = 5e-3
    stretched = np.array([0, 0, 0, 0, 0.4, 0.3, 0.2, 0])
    c = tope.Controller(robot, mode="velocity", dt=dt)
    start = kinematics.frames(named(robot, stretched))["ee"].translation
    c.add(tope.FramePosition(frame="ee", target=start), level=1)
    raised = c.add(tope.Manipulability(frame="ee", target=0.016, rows=[0, 1, 2], joints=ARM), level=2)
    c.add(tope.Damping(), level=3)
    q, u = stretched.copy(), np.zeros(8)
    for k in range(1000):
        u = c.update(q, u, k * dt).copy()
        q += dt * u
    assert c.error(raised) == pytest.approx([0], abs=1e-3)
    jacobian = kinematics.jacobian(named(robot, q), "ee", ARM)[:3]
    assert np.sqrt(np.linalg.det(jacobian @ jacobian.T)) == pytest.approx(0.016, rel=1e-3)
    assert kinematics.frames(named(robot, q))["ee"].translation == pytest.approx(start, abs=1e-3)


def test_joints_outside_a_group_stay(robot: tope.Robot) -> None:
    target = kinematics.frames(named(robot, Q0))["ee"].translation + np.array([0.02, 0.03, -0.02])
    q = reached(robot, tope.JointGroup(tope.FramePosition(frame="ee", target=target), joints=ARM))
    assert kinematics.frames(named(robot, q))["ee"].translation == pytest.approx(target, abs=1e-3)
    assert (q[:3] == Q0[:3]).all()


def test_paths_pass_their_waypoints(robot: tope.Robot) -> None:
    start = kinematics.frames(named(robot, Q0))["ee"]
    points = start.translation + np.array([[0, 0, 0], [0.1, 0, 0.02], [0.1, 0.1, 0]])
    path = tope.PointPath([0, 2, 4.5], points)
    for t, point in zip([0, 2, 4.5], points, strict=True):
        assert path.at(t)[0] == pytest.approx(point, abs=1e-12)
    step = 1e-5
    for t in [0.3, 1.9, 3.0]:
        slope = (path.at(t + step)[0] - path.at(t - step)[0]) / (2 * step)
        assert path.at(t)[1] == pytest.approx(slope, abs=1e-8)
    q = reached(robot, tope.FramePosition(frame="ee", target=path))
    assert kinematics.frames(named(robot, q))["ee"].translation == pytest.approx(points[-1], abs=1e-3)
    turn = tope.RotationPath([0, 3], [start.rotation, [1, 0, 0, 0]])
    assert turn.at(3)[0] == pytest.approx(np.eye(3), abs=1e-12)
    assert turn.at(0)[1] == pytest.approx(np.zeros(3))


def test_samples_from_another_thread_are_followed(robot: tope.Robot) -> None:
    dt = 1e-3
    start = kinematics.frames(named(robot, Q0))["ee"]
    stream = tope.PointStream(start.translation, hold=10)  # however seldom the other thread comes to run
    turned = tope.RotationStream(start.rotation)
    c = tope.Controller(robot, mode="velocity", dt=dt)
    c.add(tope.FramePosition(frame="ee", target=stream, reference=tope.Exponential(gain=8)), level=1)
    c.add(tope.FrameOrientation(frame="ee", target=turned), level=2)
    now, goal, velocity = [0.0], start.translation + np.array([0.05, 0.03, 0.02]), np.array([0.01, 0, 0])
    heard, done = threading.Event(), threading.Event()

    def camera() -> None:
        last = -1.0
        while not done.is_set():
            t = now[0]
            if t > last:
                assert stream.put(t, goal + t * velocity, velocity)
                assert turned.put(t, start.rotation)
                last = t
                heard.set()
            time.sleep(0)

    writer = threading.Thread(target=camera)
    writer.start()
    q, u = Q0.copy(), np.zeros(8)
    for k in range(4000):
        now[0] = k * dt
        if k == 1000:
            assert heard.wait(10)
        u = c.update(q, u, k * dt).copy()
        q += dt * u
    done.set()
    writer.join()
    reached = kinematics.frames(named(robot, q))["ee"].translation
    assert reached == pytest.approx(goal + 4 * velocity, abs=1e-3)


def test_bad_samples_are_told(robot: tope.Robot) -> None:
    stream = tope.PointStream(POINT)
    assert stream.put(1.0, POINT)
    assert not stream.put(1.0, POINT)
    assert not stream.put(2.0, [np.nan, 0, 0])
    turned = tope.RotationStream([1, 0, 0, 0])
    assert not turned.put(1.0, 2 * np.eye(3))
    assert turned.put(1.0, [0, 1, 0, 0], [0, 0, 0.1])
    with pytest.raises(tope.ConfigError, match=r"PointStream: hold .* positive"):
        tope.PointStream(POINT, hold=0)


def test_scenario_with_changes_says_what_it_did() -> None:
    run = tope.simulate(ROOT / "scenarios/youbot_task_changes.yaml", overrides={"duration": 5.0})
    tasks = {task["name"]: task for task in run.scenario["tasks"]}
    assert [tasks[name]["stays"] for name in ("orientation", "position", "look")] == [False, True, True]
    assert [tasks[name]["starts"] for name in ("orientation", "position", "look")] == [True, True, False]
    assert run.log["a.orientation"][0] == 1
    assert run.log["a.orientation"][-1] == 0
    assert run.log["a.look"][[0, -1]] == pytest.approx([0, 1])
    assert run.summary["task_error"]["orientation"]["measured"] is None
    with pytest.raises(tope.ConfigError, match=r"youbot_task_changes.yaml:\d+: changes.0.remove: no task"):
        tope.load_scenario(ROOT / "scenarios/youbot_task_changes.yaml", {"tasks.0.name": "turn"})


def test_mistakes_are_named(robot: tope.Robot) -> None:
    c = tope.Controller(robot, mode="velocity", dt=1e-3)
    with pytest.raises(tope.ConfigError, match="axis: expected three numbers"):
        tope.Pointing(frame="ee", axis=[1, 0], target=POINT)
    with pytest.raises(tope.ConfigError, match=r"axis.*must not be zero"):
        c.add(tope.Pointing(frame="ee", axis=[0, 0, 0], target=POINT), level=1)
    with pytest.raises(tope.ConfigError, match=r"target.*finite"):
        c.add(tope.CenterOfMass(target=[np.nan, 0, 0]), level=1)
    with pytest.raises(tope.ConfigError, match="as many times as waypoints, got 1 and 2"):
        tope.PointPath([0], [POINT, POINT])
    with pytest.raises(tope.ConfigError, match=r"waypoint 1: its time .* later"):
        tope.PointPath([1, 1], [POINT, POINT])
    with pytest.raises(tope.ConfigError, match="unknown joint 'arm_joint_6'"):
        c.add(tope.JointGroup(tope.CenterOfMass(target=POINT), joints=["arm_joint_6"]), level=1)
    with pytest.raises(tope.ConfigError, match="neither a position nor a rotation"):
        c.add(tope.RelativePose(frame="ee", seen_from="base_link"), level=1)
    with pytest.raises(tope.ConfigError, match="row 8: posture has rows 0 to 7"):
        c.add(tope.SelectedRows(tope.Posture(target=np.zeros(8)), rows=[8]), level=1)
