"""The Python twin of the controller: names, conversions and errors, and the law against numpy.

The laws themselves are tested in C++; here one cycle of the default law is compared with its definition.
"""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import tope

ROOT = Path(__file__).parents[2]
URDF = ROOT / "robots/youbot/youbot.urdf"
CONFIG = ROOT / "robots/youbot/youbot.yaml"
Q0 = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])


@pytest.fixture
def robot() -> tope.Robot:
    return tope.Robot.from_urdf(URDF, CONFIG)


def controller(robot: tope.Robot, **options: object) -> tope.Controller:
    return tope.Controller(robot, mode="velocity", dt=1e-3, **options)


def frame_terms(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position of ee and the Jacobian of its linear velocity, by Pinocchio's own Python."""
    full = pin.buildModelFromUrdf(str(URDF))
    fingers = [full.getJointId(f"gripper_finger_joint_{side}") for side in "lr"]
    model = pin.buildReducedModel(full, fingers, pin.neutral(full))
    data = model.createData()
    configuration = np.concatenate([q[:2], [np.cos(q[2]), np.sin(q[2])], q[3:]])
    pin.computeJointJacobians(model, data, configuration)
    pin.updateFramePlacements(model, data)
    ee = model.getFrameId("ee")
    jacobian = pin.getFrameJacobian(model, data, ee, pin.LOCAL_WORLD_ALIGNED)
    return data.oMf[ee].translation, jacobian[:3]


def test_names(robot: tope.Robot) -> None:
    assert (robot.nq, robot.nv) == (8, 8)
    assert robot.joint_names[0] == "base_x"
    assert robot.position_upper.shape == robot.effort_limit.shape == (8,)
    assert np.isinf(robot.position_upper[2])


def test_bounds_are_settable_whole_and_by_entry(robot: tope.Robot) -> None:
    robot.position_upper[0] = 0.35
    assert robot.position_upper[0] == 0.35
    robot.velocity_limit = np.full(8, 0.5)
    assert robot.velocity_limit[7] == 0.5
    robot.position_upper[0] = -100.0
    with pytest.raises(
        tope.ConfigError, match=r"position limits of base_x: lower -50.*must be below upper -100"
    ):
        controller(robot)


def test_one_task_is_the_damped_inverse(robot: tope.Robot) -> None:
    target = np.array([0.7, 0.2, 0.3])
    c = controller(robot)
    c.add(tope.FramePosition(frame="ee", target=target, reference=tope.Exponential(gain=1.5)), level=1)
    u = c.update(Q0, np.zeros(8), 0.0)
    position, jacobian = frame_terms(Q0)
    rate = -1.5 * (position - target)
    squared = rate @ rate
    damping = 0.02**2 + (0.05**2 - 0.02**2) * squared / (squared + 0.05**2)
    expected = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping * np.eye(3), rate)
    assert np.abs(u) == pytest.approx(np.abs(expected), abs=1e-9)
    assert u == pytest.approx(expected, abs=1e-9)
    assert c.status.ok


def test_activations_name_limited_sides(robot: tope.Robot) -> None:
    c = controller(robot, limits=tope.LimitOptions(method="chain", buffer=0.1))
    c.add(tope.Damping(), level=1)
    q = Q0.copy()
    q[7] = robot.position_upper[7] - 0.05
    c.update(q, np.zeros(8), 0.0)
    assert c.activations["arm_joint_5.upper"] == pytest.approx(0.5)
    assert c.activations["arm_joint_5.lower"] == 0.0
    assert "base_yaw.upper" not in c.activations
    assert c.status.events == ["limit"]


def test_joint_weights_choose_who_moves(robot: tope.Robot) -> None:
    def base_speed(weights: list[float]) -> float:
        c = controller(robot, joint_weights=weights)
        c.add(tope.FramePosition(frame="ee", target=[0.7, 0.2, 0.3]), level=1)
        return float(np.linalg.norm(c.update(Q0, np.zeros(8), 0.0)[:3]))

    assert base_speed([100.0] * 3 + [1.0] * 5) < 0.2 * base_speed([])


def test_task_leaves_over_time(robot: tope.Robot) -> None:
    c = controller(robot)
    handle = c.add(tope.FramePosition(frame="ee", target=[0.7, 0.2, 0.3]), level=1)
    full = c.update(Q0, np.zeros(8), 0.0)
    c.remove(handle, over=0.5)
    assert c.update(Q0, np.zeros(8), 1.0) == pytest.approx(full)
    assert c.update(Q0, np.zeros(8), 1.25) == pytest.approx(0.5 * full)
    assert c.update(Q0, np.zeros(8), 1.5) == pytest.approx(np.zeros(8))


def test_moving_target_is_led_by_its_velocity(robot: tope.Robot) -> None:
    position, jacobian = frame_terms(Q0)
    velocity = np.array([0.1, 0.0, -0.05])
    c = controller(robot, limits=tope.LimitOptions(method="none"))
    c.add(tope.FramePosition(frame="ee", target=lambda t: (position + t * velocity, velocity)), level=1)
    assert jacobian @ c.update(Q0, np.zeros(8), 0.0) == pytest.approx(velocity, abs=1e-12)


def test_limits_move(robot: tope.Robot) -> None:
    def used(bound: float) -> float:
        """What level 1 leaves free: half of the headroom, 0.01 at a limit and up to 0.05 m/s."""
        return bound - 0.5 * (0.01 + 0.04 * bound / (bound + 0.08))

    c = controller(robot)
    c.add(tope.JointPosition(target={"base_x": 5.0}), level=1)
    assert c.update(Q0, np.zeros(8), 0.0)[0] == pytest.approx(used(0.8))
    # 0.05 m ahead, coming at 0.1 m/s: 10/s of the distance less the margin, less the rate
    c.move_limits("base_x", lower=-50.0, upper=0.2, upper_rate=-0.1)
    assert c.update(Q0, np.zeros(8), 1e-3)[0] == pytest.approx(used(10 * 0.049 - 0.1))
    with pytest.raises(tope.ConfigError, match=r"move_limits: base_x: .* further apart"):
        c.move_limits("base_x", lower=0.0, upper=0.1)
    with pytest.raises(tope.ConfigError, match="unknown joint 'base_z'"):
        c.move_limits("base_z", lower=0.0, upper=1.0)


def test_error_in_a_moving_target_is_raised_after_the_cycle(robot: tope.Robot) -> None:
    def target(t: float) -> tuple[list[float], list[float]]:
        if t > 0:
            raise ValueError("no such place")
        return [0.7, 0.2, 0.3], [0.0, 0.0, 0.0]

    c = controller(robot)
    c.add(tope.FramePosition(frame="ee", target=target), level=1)
    c.update(Q0, np.zeros(8), 0.0)
    with pytest.raises(ValueError, match="no such place"):
        c.update(Q0, np.zeros(8), 1.0)


def test_bad_state_commands_no_motion(robot: tope.Robot) -> None:
    c = controller(robot)
    c.add(tope.FramePosition(frame="ee", target=[0.7, 0.2, 0.3]), level=1)
    assert not c.update(np.full(8, np.nan), np.zeros(8), 0.0).any()
    assert c.status.events == ["bad_input"]
    assert not c.update(np.zeros(7), np.zeros(8), 0.0).any()
    assert "wrong size" in c.status_text


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda r: controller(r, limits=tope.LimitOptions(method="chian")),
            "unknown limit method 'chian'; did you",
        ),
        (lambda r: tope.Controller(r, mode="torqe", dt=1e-3), "unknown mode 'torqe'"),
        (
            lambda r: controller(r, limits=tope.LimitOptions(gain=-1.0)),
            "gain must be positive and finite, got -1",
        ),
        (lambda r: controller(r, joint_weights=[1.0]), "joint_weights: expected 8 values, got 1"),
        (lambda r: tope.Exponential(gain=-2.0), "Exponential: gain .* must be positive"),
        (lambda r: controller(r).add(tope.Damping(), level=0), "level: must be at least 1"),
        (
            lambda r: controller(r).add(tope.FramePosition(frame="eee", target=[0, 0, 0]), level=1),
            "unknown frame 'eee'; did you mean 'ee'",
        ),
        (
            lambda r: controller(r).add(tope.FrameOrientation(frame="ee", target=2 * np.eye(3)), level=1),
            "not a rotation",
        ),
        (lambda r: tope.FrameOrientation(frame="ee", target=[1, 1, 0, 0]), "not a rotation: the norm"),
        (lambda r: tope.FramePosition(frame="ee", target=[1, 2]), "expected a point of three numbers"),
        (
            lambda r: controller(r).add(tope.Posture(target=[0.0]), level=1),
            "Posture: target: expected 8 values",
        ),
        (lambda r: tope.Robot.from_urdf("nowhere.urdf"), "nowhere.urdf: no such URDF file"),
    ],
)
def test_bad_input_is_refused(robot: tope.Robot, build: object, message: str) -> None:
    with pytest.raises(tope.ConfigError, match=message):
        build(robot)  # type: ignore[operator]


def test_errors_quote_what_is_no_text(tmp_path: Path) -> None:
    file = tmp_path / "broken.yaml"
    file.write_bytes(b"*\xff\xff\n")
    with pytest.raises(tope.ConfigError, match=r"broken\.yaml:1: not YAML: .*\\xff"):
        tope.load_scenario(file)


def test_a_task_moves_to_another_level_and_is_replaced_without_a_jump(robot):
    dt = 1e-3
    c = controller(robot)
    c.add(tope.FrameOrientation(frame="ee", target=[0.0397, 0.9811, 0.1867, -0.0322]), level=2)
    reach = c.add(tope.FramePosition(frame="ee", target=[0.6, 0.1, 0.1]), level=3)
    q, v, t = Q0.copy(), np.zeros(robot.nv), 0.0
    jumps = []
    for cycle in range(700):
        if cycle == 100:
            c.move(reach, level=1, over=0.2)
        if cycle == 200:  # before it has arrived
            c.replace(reach, tope.FramePosition(frame="ee", target=[0.5, -0.1, 0.2]), over=0.3)
        u = c.update(q, v, t)
        jumps.append(np.max(np.abs(u - v) / robot.velocity_limit))
        q, v, t = q + dt * u, u, t + dt
    assert max(jumps[1:]) < 0.02
    position, jacobian = frame_terms(q)
    np.testing.assert_allclose(jacobian @ v, -2.0 * (position - [0.5, -0.1, 0.2]), atol=2e-3)
    c.remove(reach, over=0.0)
    c.update(q, v, t)
    c.add(tope.Damping(), level=4)
    with pytest.raises(tope.Error, match="no task with handle"):
        c.move(reach, level=2)


def test_smoothing_weakens_kinks_and_keeps_bounds(robot: tope.Robot) -> None:
    def commands(smoothing: tope.Smoothing | None) -> np.ndarray:
        limits = tope.LimitOptions(unilateral=tope.UnilateralOptions(smoothing=smoothing))
        c = controller(robot, limits=limits)
        beyond = robot.position_upper[4] + 0.1
        c.add(tope.JointPosition(target={"arm_joint_2": beyond}), level=1)
        q, u = Q0.copy(), []
        q[4] = robot.position_upper[4] - 0.4
        for cycle in range(2000):
            u.append(c.update(q, np.zeros(8), cycle * 1e-3))
            q += 1e-3 * u[-1]
        assert np.all(q < robot.position_upper)
        return np.array(u)

    plain, smooth = (np.abs(np.diff(commands(s), 2, axis=0)).max() for s in (None, tope.Smoothing()))
    assert smooth < 0.6 * plain
    with pytest.raises(tope.ConfigError, match=r"smoothing\.solutions must be from 2 to 16, got 1"):
        tope.Smoothing(solutions=1)
