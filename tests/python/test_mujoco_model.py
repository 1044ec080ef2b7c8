"""The youBot for MuJoCo: file against generator, bodies against the URDF, wheels against theory.

Not covered here: the plant that drives it (mujoco_test.cpp), whole experiments (test_experiment.py).
"""

import importlib.util
import sys
from math import pi, radians, sin
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

SEED = 31
FOLDER = Path(__file__).resolve().parents[2] / "robots" / "youbot"
MJCF = FOLDER / "youbot_rollers.xml"
URDF = FOLDER / "youbot.urdf"
ARM = [f"arm_joint_{i}" for i in range(1, 6)]
WHEELS = ["wheel_fl", "wheel_fr", "wheel_bl", "wheel_br"]
ROTORS = [0.3285, 0.3285, 0.1350, 0.04663, 0.01764]  # kg m2, as youbot.yaml
REST = [0.0, 0.4, 0.9, 0.6, 1.8]  # rad: a posture well inside the arm's range
RADIUS, LX, LY = 0.0475, 0.235, 0.150  # m
K = LX + LY
WHEEL_MAP = np.array([[1, -1, -K], [1, 1, K], [1, 1, -K], [1, -1, K]]) / RADIUS
ROLLERS = 6
# Away from its lowest point a roller is no longer at 45 degrees to the floor; over its share of the turn that
# costs this.
ASIDE = sin(pi / ROLLERS) / (pi / ROLLERS)
MOTORS, SERVOS = 0, 1


@pytest.fixture(scope="module")
def generator():
    """The script that writes the MJCF, as a module."""
    sys.path.insert(0, str(FOLDER))  # it imports make_urdf
    spec = importlib.util.spec_from_file_location("youbot_make_mjcf", FOLDER / "make_mjcf.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    yield module
    sys.path.remove(str(FOLDER))
    del sys.modules["make_urdf"]


@pytest.fixture
def model():
    """The model, the obstacle out of the way."""
    loaded = mujoco.MjModel.from_xml_path(str(MJCF))
    loaded.body("obstacle").pos[0] = 15.0
    return loaded


@pytest.fixture(scope="module")
def urdf():
    """The URDF as Pinocchio reads it: base and arm, the gripper closed, the arm's rotors at the joints."""
    full = pin.buildModelFromUrdf(str(URDF))
    fingers = [full.getJointId(f"gripper_finger_joint_{side}") for side in "lr"]
    reduced = pin.buildReducedModel(full, fingers, pin.neutral(full))
    reduced.armature = np.array([0.0, 0.0, 0.0, *ROTORS])
    return reduced


def address(model, joints, of):
    """Places of joints in qpos ("qposadr") or qvel ("dofadr")."""
    return [int(getattr(model.joint(name), of)[0]) for name in joints]


def placed(model, base, arm):
    """Data with the base at (x, y, yaw), its frame on the floor, and the arm at its joint angles."""
    data = mujoco.MjData(model)
    x, y, yaw = base
    data.qpos[:7] = x, y, 0.0, np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
    data.qpos[address(model, ARM, "qposadr")] = arm
    return data


def planar_map(model):
    """Velocities of all of MuJoCo's joints for those of the URDF's: upright base, wheels and rollers at rest.

    MuJoCo's free joint has linear velocity along the world's axes and angular velocity along the body's; for
    an upright base both are the URDF's own.
    """
    to_mujoco = np.zeros((model.nv, 8))
    to_mujoco[[0, 1, 5], [0, 1, 2]] = 1.0
    to_mujoco[address(model, ARM, "dofadr"), range(3, 8)] = 1.0
    return to_mujoco


def random_state(random):
    """A base pose and arm angles in their range, and velocities."""
    pose = random.uniform([-3, -3, -pi], [3, 3, pi])
    low, high = np.radians([-168, -64, -150, -102, -166]), np.radians([168, 89, 145, 102, 166])
    return pose, random.uniform(low, high), random.uniform(-1.5, 1.5, 8)


def configuration(pose, arm):
    """Pinocchio's q."""
    return np.array([pose[0], pose[1], np.cos(pose[2]), np.sin(pose[2]), *arm])


def test_generator_reproduces_the_file(generator):
    assert generator.mjcf_text().encode() == MJCF.read_bytes(), "run python robots/youbot/make_mjcf.py"


def test_masses_are_the_urdfs(model, urdf):
    obstacle = model.body("obstacle").mass[0]
    assert model.body_mass.sum() - obstacle == pytest.approx(pin.computeTotalMass(urdf), abs=5e-6)
    for link in range(1, 6):
        joint = urdf.getJointId(f"arm_joint_{link}")
        below = model.body_subtreemass[model.body(f"arm_link_{link}").id]
        carried = sum(urdf.inertias[i].mass for i in range(joint, urdf.njoints))
        assert below == pytest.approx(carried, abs=1e-8), link


def test_kinematics_and_dynamics_are_the_urdfs(model, urdf):
    """FK, mass matrix and bias at random states, of the arm and of the base with its wheels locked."""
    random = np.random.default_rng(SEED)
    data_urdf = urdf.createData()
    tip = urdf.getFrameId("ee")
    to_mujoco = planar_map(model)
    full = np.zeros((model.nv, model.nv))
    for trial in range(100):
        pose, arm, velocity = random_state(random)
        q = configuration(pose, arm)
        data = placed(model, pose, arm)
        data.qvel[:] = to_mujoco @ velocity
        mujoco.mj_forward(model, data)
        where = f"seed {SEED}, trial {trial}"

        pin.framesForwardKinematics(urdf, data_urdf, q)
        site = data.site("ee")
        assert np.abs(site.xpos - data_urdf.oMf[tip].translation).max() < 1e-6, where
        assert np.abs(site.xmat.reshape(3, 3) - data_urdf.oMf[tip].rotation).max() < 1e-6, where

        mujoco.mj_fullM(model, data, full)
        upper = np.triu(pin.crba(urdf, data_urdf, q))
        mass = upper + np.triu(upper, 1).T
        difference = to_mujoco.T @ full @ to_mujoco - mass
        # the URDF's base_x and base_y links weigh 1e-6 kg each, and are not there in MuJoCo
        assert np.abs(difference).max() < 3e-6, where
        assert np.abs(difference[3:, 3:]).max() < 1e-6, where

        bias = pin.rnea(urdf, data_urdf, q, velocity, np.zeros(8))
        assert np.abs(to_mujoco.T @ data.qfrc_bias - bias).max() < 1e-6, where


def test_arm_with_the_base_held_is_the_urdfs(urdf):
    """The same to 1e-6 for the arm alone, in a model whose base has no joint."""
    held = mujoco.MjModel.from_xml_string(MJCF.read_text().replace('<freejoint name="base" />', ""))
    random = np.random.default_rng(SEED)
    data_urdf = urdf.createData()
    dofs = address(held, ARM, "dofadr")
    full = np.zeros((held.nv, held.nv))
    for trial in range(100):
        _, arm, velocity = random_state(random)
        data = mujoco.MjData(held)
        data.qpos[address(held, ARM, "qposadr")] = arm
        data.qvel[dofs] = velocity[3:]
        mujoco.mj_forward(held, data)
        where = f"seed {SEED}, trial {trial}"
        q = configuration((0, 0, 0), arm)
        pin.framesForwardKinematics(urdf, data_urdf, q)
        height = np.array([0.0, 0.0, data.body("base_link").xpos[2]])
        tip = data_urdf.oMf[urdf.getFrameId("ee")].translation
        assert np.abs(data.site("ee").xpos - height - tip).max() < 1e-6, where
        mujoco.mj_fullM(held, data, full)
        mass = np.triu(pin.crba(urdf, data_urdf, q))[3:, 3:]
        assert np.abs(np.triu(full[np.ix_(dofs, dofs)]) - mass).max() < 1e-6, where
        bias = pin.rnea(urdf, data_urdf, q, np.array([0, 0, 0, *velocity[3:]]), np.zeros(8))[3:]
        assert np.abs(data.qfrc_bias[dofs] - bias).max() < 1e-6, where


def test_motors_have_the_urdfs_bounds_and_rotors(model, urdf):
    for name, rotor in zip(ARM, ROTORS, strict=True):
        joint = model.joint(name)
        effort = urdf.effortLimit[urdf.idx_vs[urdf.getJointId(name)]]
        assert model.jnt_actfrcrange[joint.id] == pytest.approx([-effort, effort], abs=1e-6), name
        assert joint.armature[0] == pytest.approx(rotor), name
    for name in WHEELS:
        joint = model.joint(name)
        assert model.jnt_actfrcrange[joint.id] == pytest.approx([-2.137, 2.137]), name
        assert joint.armature[0] == pytest.approx(0.00901), name


def test_stops_lie_outside_the_limits(model, urdf):
    for name in ARM:
        low, high = model.joint(name).range
        at = urdf.idx_qs[urdf.getJointId(name)]
        assert radians(0.4) < urdf.lowerPositionLimit[at] - low < radians(1.6), name
        assert radians(0.4) < high - urdf.upperPositionLimit[at] < radians(1.6), name


def test_wheels_are_round(model):
    """The lowest point of the rollers stays within 0.3 % of the radius over a turn."""
    data = placed(model, (0, 0, 0), REST)
    rollers = [model.body(f"roller_fl_{i}").geomadr[0] for i in range(ROLLERS)]
    heights = []
    for angle in np.linspace(0, 2 * pi / ROLLERS, 121):
        data.qpos[address(model, ["wheel_fl"], "qposadr")] = angle
        mujoco.mj_kinematics(model, data)
        axle = data.body("wheel_fl_link").xpos[2]
        # the lowest point of an ellipsoid below its centre is the length of its semi-axes' vertical parts
        reach = [
            axle
            - data.geom_xpos[roller][2]
            + np.linalg.norm(model.geom_size[roller] * data.geom_xmat[roller].reshape(3, 3)[2])
            for roller in rollers
        ]
        heights.append(max(reach))
    assert min(heights) > RADIUS * (1 - 0.003)
    assert max(heights) < RADIUS * (1 + 0.003)


def start_servos(model):
    """Data at rest on the floor, the arm held by its servos."""
    model.opt.disableactuator = 1 << MOTORS
    data = mujoco.MjData(model)
    data.qpos[address(model, ARM, "qposadr")] = REST
    mujoco.mj_forward(model, data)
    for actuator in range(model.nactuator):
        if model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_INTEGRATOR:
            joint = model.actuator_trnid[actuator, 0]
            sag = data.qfrc_bias[model.jnt_dofadr[joint]] / model.actuator_gainprm[actuator, 0]
            data.act[model.actuator_actadr[actuator]] = data.qpos[model.jnt_qposadr[joint]] + sag
    return data


def in_base(data):
    """Velocity of the base along its own axes, and its yaw rate."""
    to_base = data.body("base_link").xmat.reshape(3, 3).T
    return np.array([*(to_base @ data.qvel[:3])[:2], data.qvel[5]])


@pytest.mark.parametrize(
    ("twist", "factor"),
    [
        ((0.3, 0, 0), 1.0),
        ((0, 0.3, 0), ASIDE),
        # a wheel moves ahead and aside as the base turns; only the second part is lost
        ((0, 0, 0.8), ASIDE * K / (ASIDE * LY + LX)),
    ],
    ids=["ahead", "aside", "turning"],
)
def test_wheels_roll_as_the_map_says(model, twist, factor):
    data = start_servos(model)
    speeds = WHEEL_MAP @ twist
    for actuator in range(model.nactuator):
        name = model.joint(model.actuator_trnid[actuator, 0]).name
        if name in WHEELS:
            data.ctrl[model.actuator_ctrladr[actuator]] = speeds[WHEELS.index(name)]
    axis = int(np.argmax(np.abs(twist)))
    moved, rolled = [], []
    for step in range(6000):
        mujoco.mj_step(model, data)
        if step >= 1000:
            moved.append(in_base(data))
            rolled.append(np.linalg.pinv(WHEEL_MAP) @ data.qvel[address(model, WHEELS, "dofadr")])
    moved, rolled = np.mean(moved, axis=0), np.mean(rolled, axis=0)
    assert rolled == pytest.approx(twist, abs=2e-3)  # the servos do what they are told
    assert moved[axis] / rolled[axis] == pytest.approx(factor, rel=0.01)
    others = np.delete(moved, axis)
    assert np.abs(others).max() < 0.01 * np.abs(moved[axis])


@pytest.mark.parametrize("axis", [0, 1, 2], ids=["ahead", "aside", "turning"])
def test_wheel_torques_push_as_the_dual_map_says(model, axis):
    """The base is led slowly along one axis against 0.5 Nm of each wheel; what it takes is their wrench."""
    data = start_servos(model)
    model.opt.disableactuator = 0
    torques = 0.5 * np.sign(WHEEL_MAP[:, axis])
    for actuator in range(model.nactuator):
        name = model.joint(model.actuator_trnid[actuator, 0]).name
        if name in WHEELS and model.actuator_group[actuator] == SERVOS:
            model.actuator_gainprm[actuator] = model.actuator_biasprm[actuator] = 0.0
        elif name in WHEELS:
            data.ctrl[model.actuator_ctrladr[actuator]] = torques[WHEELS.index(name)]
    base = model.body("base_link").id
    target = np.array([0.05, 0.05, 0.15]) * (np.arange(3) == axis)
    stiffness = np.array([4000.0, 4000.0, 400.0])  # N s/m, Nm s
    pushed = []
    for step in range(6000):
        wrench = stiffness * (target - in_base(data))
        to_world = data.xmat[base].reshape(3, 3)
        data.xfrc_applied[base] = [*(to_world @ [wrench[0], wrench[1], 0.0]), 0.0, 0.0, wrench[2]]
        mujoco.mj_step(model, data)
        if step >= 1000:
            pushed.append(-wrench)
    expected = WHEEL_MAP.T @ torques
    mean = np.mean(pushed, axis=0)
    assert mean[axis] == pytest.approx(expected[axis], rel=0.04)
    assert np.abs(np.delete(mean, axis)).max() < 0.05 * expected[axis]
