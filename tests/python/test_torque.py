"""Torque mode against the paper's formulas (9)-(10), (14)-(15), written naively on Pinocchio's Python."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import linprog

import tope

ROOT = Path(__file__).parents[2]
URDF = ROOT / "robots/youbot/youbot.urdf"
CONFIG = ROOT / "robots/youbot/youbot.yaml"
SEED = 20
KP, KV = 9.0, 6.0  # of tope.Exponential(gain=3)


def build() -> tuple[pin.Model, pin.Data]:
    """The youBot as Pinocchio reads it, with the rotors of the YAML file."""
    full = pin.buildModelFromUrdf(str(URDF))
    fingers = [full.getJointId(f"gripper_finger_joint_{side}") for side in "lr"]
    model = pin.buildReducedModel(full, fingers, pin.neutral(full))
    wheel, radius, arm = 0.00901, 0.0475, 0.385
    base = 4 * wheel / radius**2
    rotors = [0.3285, 0.3285, 0.135, 0.04663, 0.01764]
    model.armature = np.array([base, base, base * arm**2, *rotors])
    return model, model.createData()


class Terms:
    """H, h and the task terms at one state."""

    def __init__(self, q: np.ndarray, v: np.ndarray) -> None:
        self.model, self.data = build()
        self.v = v
        full = np.concatenate([q[:2], [np.cos(q[2]), np.sin(q[2])], q[3:]])
        upper = np.triu(pin.crba(self.model, self.data, full))
        self.mass = upper + np.triu(upper, 1).T
        self.bias = pin.rnea(self.model, self.data, full, v, np.zeros(8)).copy()
        pin.forwardKinematics(self.model, self.data, full, v, np.zeros(8))
        pin.computeJointJacobians(self.model, self.data, full)
        pin.updateFramePlacements(self.model, self.data)

    def position_task(self, frame: str, target: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Jacobian, drift and desired acceleration of a frame's position."""
        index = self.model.getFrameId(frame)
        jacobian = pin.getFrameJacobian(self.model, self.data, index, pin.LOCAL_WORLD_ALIGNED)[:3]
        acceleration = pin.getFrameClassicalAcceleration(
            self.model, self.data, index, pin.LOCAL_WORLD_ALIGNED
        )
        error = self.data.oMf[index].translation - target
        return jacobian, acceleration.linear, -KP * error - KV * jacobian @ self.v


def papers_law(terms: Terms, tasks: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> np.ndarray:
    """u of (15), with Q = J H^-1, W = H and the accumulated residual."""
    inverse = np.linalg.inv(terms.mass)
    u, null_space = np.zeros(8), np.eye(8)
    for jacobian, drift, desired in tasks:
        q_map = jacobian @ inverse
        mu = q_map @ terms.bias - drift
        # (14) acts on torques: N = I - Q^#W Q, and Q_bar = Q N
        q_bar = q_map @ null_space
        weighted = terms.mass @ q_bar.T @ np.linalg.inv(q_bar @ terms.mass @ q_bar.T)
        u = u + weighted @ (desired + mu - q_map @ u)
        null_space = null_space - weighted @ q_bar
    return u


def random_state(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    q = np.concatenate(
        [random.uniform(-1, 1, 3), random.uniform(-2, 2, 1), random.uniform(0.3, 0.9, 3), [1.0]]
    )
    return q, random.uniform(-0.2, 0.2, 8)


@pytest.mark.parametrize("levels", [1, 2, 3, 4])
def test_zero_torque_null_space_is_the_papers_law(levels: int) -> None:
    random = np.random.default_rng(SEED)
    robot = tope.Robot.from_urdf(URDF, CONFIG)
    robot.effort_limit = np.full(8, 1e6)
    lower_levels = ["arm_joint_5", "arm_joint_4", "base_yaw"][: levels - 1]
    compared = 0
    for _ in range(60):
        q, v = random_state(random)
        terms = Terms(q, v)
        limits = tope.LimitOptions(method="none")
        c = tope.Controller(
            robot, mode="torque", dt=1e-3, midpoint=False, limits=limits, null_space="zero_torque"
        )
        reference = tope.Exponential(gain=3.0)
        near = terms.data.oMf[terms.model.getFrameId("ee")].translation + random.uniform(-0.002, 0.002, 3)
        tasks = [terms.position_task("ee", near)]
        c.add(tope.FramePosition(frame="ee", target=near, reference=reference), level=1)
        for level, name in enumerate(lower_levels, start=2):
            joint = robot.joint_names.index(name)
            target = q[joint] + random.uniform(-0.01, 0.01)
            tasks.append((np.eye(8)[[joint]], np.zeros(1), -KP * (q[[joint]] - target) - KV * v[[joint]]))
            c.add(tope.JointPosition(target={name: target}, reference=reference), level=level)
        u = c.update(q, v, 0.0)
        if c.status.events:
            continue  # damped or scaled by design
        expected = papers_law(terms, tasks)
        assert np.abs(u - expected).max() <= 1e-8 * max(1.0, np.abs(expected).max()), f"seed {SEED}"
        compared += 1
    assert compared >= 10


def test_compensated_null_space_differs_by_the_projected_bias() -> None:
    random = np.random.default_rng(SEED)
    robot = tope.Robot.from_urdf(URDF, CONFIG)
    q, v = random_state(random)
    terms = Terms(q, v)
    target = terms.data.oMf[terms.model.getFrameId("ee")].translation + 0.001
    rows = terms.position_task("ee", target)

    def torque(null_space: str) -> np.ndarray:
        controller = tope.Controller(
            robot,
            mode="torque",
            dt=1e-3,
            midpoint=False,
            limits=tope.LimitOptions(method="none"),
            null_space=null_space,
        )
        task = tope.FramePosition(frame="ee", target=target, reference=tope.Exponential(gain=3.0))
        controller.add(task, level=1)
        return controller.update(q, v, 0.0)

    q_map = rows[0] @ np.linalg.inv(terms.mass)
    weighted = terms.mass @ q_map.T @ np.linalg.inv(q_map @ terms.mass @ q_map.T)
    projected = (np.eye(8) - weighted @ q_map) @ terms.bias
    assert torque("compensated") - torque("zero_torque") == pytest.approx(projected, abs=1e-8)


def test_least_peak_wheel_torques_solve_a_linear_program() -> None:
    """min t subject to -t <= f_i <= t and the wrench of the commanded base forces, by SciPy."""
    overrides = {"wheel_distribution": "minimum_peak", "duration": 1.5, "log.every": 10}
    overrides |= {f"tasks.{name}.reference.duration": 1.2 for name in ("orientation", "position")}
    run = tope.simulate(ROOT / "scenarios/youbot_torque.yaml", overrides=overrides)
    arm, radius = 0.385, 0.0475
    to_wrench = np.array([[1, 1, 1, 1], [-1, 1, 1, -1], [-arm, arm, -arm, arm]]) / radius
    peaks = []
    for row in range(len(run.time)):
        force = np.array([run.log[f"u.base_{axis}"][row] for axis in ("x", "y", "yaw")])
        yaw = run.log["q.base_yaw"][row]
        world_from_base = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        wrench = world_from_base.T @ force
        wheels = np.array([run.log[f"wheel.{i}"][row] for i in range(4)])
        bounds = np.vstack([np.hstack([sign * np.eye(4), -np.ones((4, 1))]) for sign in (1, -1)])
        least = linprog(
            [0, 0, 0, 0, 1],
            A_ub=bounds,
            b_ub=np.zeros(8),
            A_eq=np.hstack([to_wrench, np.zeros((3, 1))]),
            b_eq=wrench,
            bounds=[(None, None)] * 5,
        )
        assert to_wrench @ wheels == pytest.approx(wrench, abs=1e-6)
        assert np.abs(wheels).max() == pytest.approx(least.fun, abs=1e-7)
        peaks.append(least.fun)
    assert max(peaks) > 0.5  # the base did push


LIMITED = """<robot name="r"><link name="base"/><link name="arm">{inertial}</link>
<joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="{velocity}" effort="{effort}"/></joint></robot>"""
HEAVY = (
    '<inertial><origin xyz="0.5 0 0"/><mass value="4"/>'
    '<inertia ixx="0" iyy="0.1" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>'
)


@pytest.mark.parametrize(
    ("urdf", "limits", "messages"),
    [
        ({"inertial": ""}, {}, ["needs the inertia of every link", "swing moves no mass", "rotor_inertia"]),
        ({"effort": 0}, {}, ["robot.urdf: effort_limit: swing: must be positive", "YAML"]),
        ({"effort": 10}, {}, ["drive strong enough", "swing", "cannot hold the robot against gravity"]),
        ({}, {"gain": 9.0}, ["drive strong enough to brake (swing)", "lower limits.gain to at most"]),
        ({}, {"lambda_p": 100, "lambda_v": 10}, ["lambda_v^2 < 4 lambda_p", "raise lambda_v to at least 20"]),
        ({}, {"lambda_p": 100}, ["one complete pair"]),
        ({}, {"lambda_p": 16, "lambda_v": 10, "gain": 2.0}, ["one complete pair"]),
    ],
)
def test_bad_robots_and_gains_are_refused(
    tmp_path: Path, urdf: dict[str, object], limits: dict[str, float], messages: list[str]
) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(LIMITED.format(**({"inertial": HEAVY, "velocity": 2, "effort": 30} | urdf)))
    with pytest.raises(tope.ConfigError) as refusal:
        robot = tope.Robot.from_urdf(file)
        tope.Controller(robot, mode="torque", dt=1e-3, limits=tope.LimitOptions(**limits))
    for message in messages:
        assert message in str(refusal.value)


def test_limited_joints_need_a_speed_limit() -> None:
    robot = tope.Robot.from_urdf(URDF, CONFIG)
    robot.velocity_limit[4] = np.inf
    with pytest.raises(tope.ConfigError, match="arm_joint_2 has position limits but no speed limit"):
        tope.Controller(robot, mode="torque", dt=1e-3)
    tope.Controller(robot, mode="velocity", dt=1e-3)


def test_gain_left_open_is_what_the_drive_can_brake_with(tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(LIMITED.format(inertial=HEAVY, velocity=2, effort=30))
    controller = tope.Controller(tope.Robot.from_urdf(file), mode="torque", dt=1e-3)
    authority = (30 - 4 * 9.81 * 0.5) / (4 * 0.25 + 0.1)  # stretched out
    assert controller.limit_gains[0] == pytest.approx(0.8 * authority / 2, rel=1e-3)


def test_torque_mode_refuses_joint_weights() -> None:
    robot = tope.Robot.from_urdf(URDF, CONFIG)
    with pytest.raises(tope.ConfigError, match="joint_weights: torque mode"):
        tope.Controller(robot, mode="torque", dt=1e-3, joint_weights=[1.0] * 8)
