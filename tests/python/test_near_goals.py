"""bench/near_goals.py: its goals and robots are what it says, and a run goes from a goal's start to the goal.

Pinocchio reads the packages' own URDFs here, the programs read what near_goals.py writes. Not covered: Pink
and tsid.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pinocchio
import pytest

from tope import _core

BENCH = Path(__file__).parents[2] / "bench"
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import closed_loop  # noqa: E402
import near_goals  # noqa: E402
from rigid_body import RigidBody  # noqa: E402
from tope_peer import Tope  # noqa: E402

COUNT = 5
CASES = [(name, mode) for name in near_goals.SCENARIOS for mode in near_goals.PROGRAMS]


def whole_model(name):
    """The robot of the package, its locked joints where its file holds them, and its hand's name."""
    described = _core.load_scenario(near_goals.SCENARIOS[name]).describe()
    model = pinocchio.buildModelFromUrdf(described["robot"]["urdf"])
    q = pinocchio.neutral(model)
    locked = described["robot"]["locked_joints"]
    for joint, position in locked.items():
        q[model.joints[model.getJointId(joint)].idx_q] = position
    reduced = pinocchio.buildReducedModel(model, [model.getJointId(joint) for joint in locked], q)
    return reduced, described["tasks"][0]["frame"]


def configuration(model, q):
    """Pinocchio's, with cosine and sine where a joint turns without end."""
    whole = pinocchio.neutral(model)
    for joint, position in zip(list(model.joints)[1:], q, strict=True):
        turned = [np.cos(position), np.sin(position)] if joint.nq == 2 else position
        whole[joint.idx_q : joint.idx_q + joint.nq] = turned
    return whole


def setup_of(folder, name, mode, count=COUNT, fine=1):
    """A robot, its goals, and what a program reads of them."""
    robot = near_goals.machine(name, mode)
    goals = [near_goals.draw(robot, number) for number in range(count)]
    return (
        robot,
        goals,
        closed_loop.read(near_goals.write(folder / f"{mode}.txt", "rest", robot, goals, fine)),
    )


@pytest.mark.parametrize(("name", "mode"), CASES)
def test_one_joint_of_the_hand_is_within_two_milliradians_of_a_limit(name, mode, tmp_path):
    robot, goals, setup = setup_of(tmp_path, name, mode)
    span = robot.upper - robot.lower
    for goal in goals:
        q, start = np.array(goal.q), np.array(goal.start)
        near = robot.names.index(goal.joint)
        room = np.minimum(robot.upper - q, q - robot.lower)
        assert near in robot.chain
        assert 2e-4 <= room[near] <= 2e-3
        assert room[near] == pytest.approx(goal.distance, rel=1e-9)
        assert goal.side == ("lower" if q[near] - robot.lower[near] < 1e-2 else "upper")
        others = np.arange(len(q)) != near
        limited = others & (robot.upper < near_goals.scenario.FAR)
        assert np.all(room[limited] >= 0.1 * span[limited] * (1 - 1e-12))
        assert np.all(np.minimum(robot.upper - start, start - robot.lower) >= near_goals.INSIDE * (1 - 1e-9))
        assert 0 < np.abs(start - q).max() <= near_goals.OFFSET
        assert np.minimum(robot.upper - start, start - robot.lower)[near] > room[near]
    np.testing.assert_array_equal(setup.starts["goal_1"], goals[1].start)


@pytest.mark.parametrize(("name", "mode"), CASES)
def test_pinocchio_and_tope_find_the_hand_at_the_goal(name, mode, tmp_path):
    _, goals, setup = setup_of(tmp_path, name, mode)
    model, hand = whole_model(name)
    data, frame = model.createData(), model.getFrameId(hand)
    robot = _core.Robot.from_urdf(setup.urdf, setup.config)
    assert list(model.names)[1:] == robot.joint_names
    np.testing.assert_array_equal(robot.velocity_limit, model.upperVelocityLimit)
    for number, goal in enumerate(goals):
        q, pose = np.array(goal.q), setup.goals[f"goal_{number}"]
        pinocchio.framesForwardKinematics(model, data, configuration(model, q))
        there = data.oMf[frame]
        assert closed_loop.errors(setup, f"goal_{number}", q)["position_error"] < 1e-9
        np.testing.assert_allclose(pose.position, there.translation, atol=1e-9)
        np.testing.assert_allclose(pose.rotation, there.rotation, atol=1e-9)
        controller = _core.Controller(robot, mode=mode, dt=1e-3)
        handles = [
            controller.add(_core.FrameOrientation(frame="ee", target=there.rotation), level=1),
            controller.add(_core.FramePosition(frame="ee", target=there.translation), level=2),
        ]
        controller.update(q, np.zeros(len(q)), 0.0)
        assert max(np.abs(controller.error(handle)).max() for handle in handles) < 1e-9


@pytest.mark.parametrize("name", near_goals.SCENARIOS)
def test_the_plant_is_the_robot_of_the_package(name, tmp_path):
    _, goals, setup = setup_of(tmp_path, name, "torque", count=1)
    model, _ = whole_model(name)
    model.armature = setup.rotor_inertia
    q, random = np.array(goals[0].q), np.random.default_rng(1)
    v, tau = random.standard_normal((2, len(q)))
    expected = pinocchio.aba(model, model.createData(), configuration(model, q), v, tau)
    np.testing.assert_allclose(RigidBody(setup).acceleration(q, v, tau), expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("mode", near_goals.PROGRAMS)
def test_a_run_goes_from_its_start_to_the_goal_and_ends_there(mode, tmp_path):
    _, goals, setup = setup_of(tmp_path, "kinova", mode, count=2, fine=0)
    plant = RigidBody(setup) if setup.torque else None
    runs = closed_loop.measure(Tope(setup, "unilateral"), setup, plant)["runs"]
    np.testing.assert_array_equal(setup.start, goals[1].start)
    assert [run["goal"] for run in runs] == ["goal_0", "goal_1"]
    for run in runs:
        assert near_goals.miss(run) < setup.settled
        assert 1.0 < run["cycles"] * run["dt"] < near_goals.DURATION
        assert (run["failures"], run["gave_up"]) == (0, False)
        assert run["violation"] < 0


def test_the_summary_counts(tmp_path):
    goals = [
        near_goals.Goal("joint", "upper", distance, [0.0], [0.1]) for distance in (2e-3, 5e-4, 1.5e-3, 8e-4)
    ]
    program = near_goals.peers.Program("tope", "Python", "velocity", "chain")
    job = near_goals.Job("arm", "rest", program, goals, tmp_path)
    run = {"dt": 1e-3, "failures": 0, "violation": -1e-3, "jump": 0.02, "orientation_error": 0.0}
    found = {
        "runs": [
            run | {"goal": "goal_0", "position_error": 9e-4},
            run | {"goal": "goal_0", "position_error": 9e-4, "dt": 1e-4, "jump": 0.002},
            run | {"goal": "goal_1", "position_error": 4e-3, "failures": 3},
            run | {"goal": "goal_1", "position_error": 4e-3, "dt": 1e-4, "jump": 0.01, "violation": 2e-5},
            run | {"goal": "goal_2", "position_error": 0.0, "orientation_error": 2e-3},
            run | {"goal": "goal_3", "position_error": 0.0, "jump": 0.03},
        ]
    }
    other = near_goals.Job("leg", "rest", program, goals, tmp_path)
    assert near_goals.reached([(job, found), (other, found)], "rest").splitlines()[2:] == [
        "| arm | 2 of 4 |",
        "| leg | 2 of 4 |",
        "| all | 4 of 8 |",
    ]
    row = dict(zip(near_goals.HEADER, near_goals.summary(job, found), strict=True))
    assert row == {
        "robot": "arm",
        "library": "tope: chain",
        "reached": "2 of 4",
        "of those within 1 mrad": "1 of 2",
        "oriented": "3 of 4",
        "others missed by [mm, mrad]": "3",
        "limit crossed by": "2.0e-05",
        "jump at 1 ms": "2 %",
        "0.1 ms": "0.6 %",
        "ratio": "6.0",
        "ratio ≥ 8": "1 of 2",
        "largest jump of all": "3 %",
        "failed cycles, runs": "3, 1 of 4",
    }
