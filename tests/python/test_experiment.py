"""The experiments in MuJoCo: goals, contacts, smoothness and faults, from the shipped scenarios.

Errors and limits are those of the true state, not of what the sensors say. Not covered here: the model (in
test_mujoco_model.py), how each part of the plant works (mujoco_test.cpp).
"""

from pathlib import Path

import pytest

from tope import words
from tope.compare import compare
from tope.simulation import simulate

SCENARIOS = Path(__file__).parents[2] / "scenarios"
VELOCITY = SCENARIOS / "youbot_experiment_velocity.yaml"
POTENTIAL_FIELD = SCENARIOS / "youbot_experiment_potential_field.yaml"
TORQUE = SCENARIOS / "youbot_experiment_torque.yaml"
POSITION, ORIENTATION = 5e-3, 20e-3  # m, rad


@pytest.fixture(scope="module")
def summary():
    """The summary of a scenario's run; each run is made once."""
    done = {}

    def run(scenario, **overrides):
        key = (scenario, *sorted(overrides.items()))
        if key not in done:
            dotted = {name.replace("__", "."): value for name, value in overrides.items()}
            done[key] = simulate(scenario, overrides=dotted, report=False).summary
        return done[key]

    return run


def errors(summary, which="final"):
    return summary["task_error"]["position"][which], summary["task_error"]["orientation"][which]


def reached(summary, which="final"):
    position, orientation = errors(summary, which)
    return position < POSITION and orientation < ORIENTATION


def at_stops(summary):
    return [what for what in summary["contacts"] if what.endswith("at its stop")]


@pytest.mark.parametrize("scenario", [VELOCITY, TORQUE], ids=["velocity", "torque"])
def test_goal_is_reached_and_nothing_touched(summary, scenario):
    done = summary(scenario)
    assert reached(done)
    assert done["time_to_goal"] < 5.0
    assert done["contacts"] == {}
    assert done["max_limit_violation"]["overall"] < 0


def test_torque_goal_is_reached_when_promised(summary):
    assert reached(summary(TORQUE), "at_goal_time")


def test_odometry_reaches_what_it_believes_and_drifts(summary):
    done = summary(VELOCITY, plant__sensors__localisation="odometry")
    assert reached(done, "measured")
    drift = done["sensor_error"]
    assert 5e-3 < drift["base_y"] < 50e-3  # six rollers lose 4.5 % sideways, and odometry does not know
    assert drift["arm_joint_5"] < 1e-4
    assert not reached(done)
    assert done["contacts"] == {}


def test_hard_limits_shake_the_end_effector(summary):
    """The oscillation that the paper reports of its first experiment."""
    smooth, hard = summary(VELOCITY), summary(POTENTIAL_FIELD)
    for task in ("position", "orientation"):
        acceleration = smooth["task_error"][task]["acceleration"]
        assert hard["task_error"][task]["acceleration"] > 10 * acceleration
    assert hard["velocity_variation"]["overall"] > 10 * smooth["velocity_variation"]["overall"]


def test_hard_limits_shake_it_in_torque_mode_too(summary):
    smooth, hard = summary(TORQUE), summary(TORQUE, limits__method="potential_field")
    for task in ("position", "orientation"):
        acceleration = smooth["task_error"][task]["acceleration"]
        assert hard["task_error"][task]["acceleration"] > 10 * acceleration
    assert hard["velocity_variation"]["overall"] > 10 * smooth["velocity_variation"]["overall"]


def test_wheels_and_motors_keep_their_bounds():
    run = simulate(TORQUE, report=False)
    wheels = [run.log[f"wheel.{i}"] for i in range(4)]
    assert max(abs(torque).max() for torque in wheels) <= 2.137 * (1 + 1e-9)


@pytest.mark.parametrize("fault", ["lost_grip", "stall", "sensor_noise", "payload"])
def test_goal_is_reached_in_spite_of(summary, fault):
    done = summary(SCENARIOS / "faults" / f"{fault}.yaml")
    assert reached(done)
    assert done["contacts"] == {}
    assert done["max_limit_violation"]["overall"] < 0


def test_robot_gives_way_to_the_moving_obstacle(summary):
    done = summary(SCENARIOS / "faults/moving_obstacle.yaml")
    assert done["contacts"] == {}
    # the limit begins to move at once, the base does not
    assert done["max_limit_violation"]["base_x"] < 3e-3
    assert errors(done)[0] > 20e-3  # the goal is out of reach


def test_without_limits_joint_5_hits_its_stop(summary):
    assert at_stops(summary(VELOCITY, limits__method="none")) == ["arm_joint_5 at its stop"]


def test_faults_act():
    """Each fault changes the run: a scenario whose fault does nothing would prove nothing."""
    base = simulate(VELOCITY, overrides={"duration": 2.5}, report=False).log
    for fault in (
        {"plant.faults.lost_grip": {"wheel": "front_left", "at": 0.5, "for": 0.5}},
        {"plant.faults.stall": {"at": 0.3, "for": 0.005}},
        {"plant.faults.payload": {"mass": 0.5, "at": 2.0}},
        {"plant.sensors.encoder_noise": 1e-3},
    ):
        other = simulate(VELOCITY, overrides={"duration": 2.5, **fault}, report=False).log
        assert abs(other["v.arm_joint_2"] - base["v.arm_joint_2"]).max() > 1e-6, fault


def test_compare_overlays_both_experiments(tmp_path):
    runs = compare(
        VELOCITY, limits=["unilateral"], others=[POTENTIAL_FIELD], out=tmp_path, overrides={"duration": 0.3}
    )
    assert list(runs) == ["unilateral", "youbot experiment, potential field"]
    assert (tmp_path / "report.html").stat().st_size > 0


def test_summary_is_told_in_words(summary):
    rows = dict(words.summary_rows(summary(VELOCITY)))
    assert rows["Contacts"] == "none"
    rows = dict(words.summary_rows(summary(VELOCITY, plant__sensors__localisation="odometry")))
    assert "(base_y)" in rows["As the robot sees it"]
    rows = dict(words.summary_rows(summary(VELOCITY, limits__method="none")))
    assert rows["Contacts"].startswith("arm_joint_5 at its stop (")
