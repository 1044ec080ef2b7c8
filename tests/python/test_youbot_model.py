"""The youBot's URDF and configuration against their published figures and mechanics written anew."""

import importlib.util
import sys
import xml.etree.ElementTree as ET
from math import radians
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml

SEED = 4711
FOLDER = Path(__file__).resolve().parents[2] / "robots" / "youbot"
URDF = FOLDER / "youbot.urdf"
ARM = [f"arm_joint_{i}" for i in range(1, 6)]
JOINTS = ["base_x", "base_y", "base_yaw", *ARM, "gripper_finger_joint_l", "gripper_finger_joint_r"]
MANUAL_RANGE = [(-168, 168), (-64, 89), (-150, 145), (-102, 102), (-166, 166)]  # deg
WHEEL_GEAR = 9405 / 364
PAYLOAD = 0.5  # kg
GRAVITY = 9.81

# KUKA's joint frames, their axes as columns in base_link while the arm stands straight up, and in them the
# published mass [kg], centre [mm], principal moments [kg m2] and turn of the principal axes A, B, C [deg].
PUBLISHED_LINKS = {
    "arm_link_1": (
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        (1.390, (15.16, 3.59, 31.05), (0.0029525, 0.0060091, 0.0058821), (180, 20, 0)),
    ),
    "arm_link_2": (
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        (1.318, (113.97, 15.0, -19.03), (0.0031145, 0.0005843, 0.0031631), (-90, 0, -90)),
    ),
    "arm_link_3": (
        [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
        (0.821, (0.13, 104.41, 20.22), (0.00172767, 0.00041967, 0.0018468), (0, 0, 90)),
    ),
    "arm_link_4": (
        [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
        (0.769, (0.15, 53.53, -24.64), (0.0006764, 0.0010573, 0.000661), (0, 180, 0)),
    ),
    "arm_link_5": (
        [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
        (0.687, (0, 1.2, -16.48), (0.0001934, 0.0001602, 0.0000689), (0, 90, 0)),
    ),
}


@pytest.fixture(scope="module")
def generator():
    """The script that writes the URDF, as a module."""
    spec = importlib.util.spec_from_file_location("youbot_make_urdf", FOLDER / "make_urdf.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up by name
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def model():
    """The robot as Pinocchio reads it."""
    return pin.buildModelFromUrdf(str(URDF))


@pytest.fixture(scope="module")
def inertials():
    """Mass, centre and tensor of every link that has them, from the file itself."""
    found = {}
    for link in ET.parse(URDF).getroot().iter("link"):
        if (element := link.find("inertial")) is None:
            continue
        assert element.find("origin").get("rpy") == "0 0 0", link.get("name")
        centre = np.array([float(x) for x in element.find("origin").get("xyz").split()])
        i = {key: float(value) for key, value in element.find("inertia").items()}
        tensor = np.array(
            [
                [i["ixx"], i["ixy"], i["ixz"]],
                [i["ixy"], i["iyy"], i["iyz"]],
                [i["ixz"], i["iyz"], i["izz"]],
            ]
        )
        found[link.get("name")] = float(element.find("mass").get("value")), centre, tensor
    return found


@pytest.fixture(scope="module")
def config():
    """The YAML's content."""
    return yaml.safe_load((FOLDER / "youbot.yaml").read_text(encoding="utf-8"))


def random_positions(rng):
    """Base anywhere within 3 m, at any heading, the rest within its limits; in the order of JOINTS."""
    lower = np.array([-3, -3, -np.pi, *(radians(low) for low, _ in MANUAL_RANGE), 0, 0])
    upper = np.array([3, 3, np.pi, *(radians(high) for _, high in MANUAL_RANGE), 0.0115, 0.0115])
    return rng.uniform(lower, upper)


def configuration(model, positions):
    """Pinocchio's q; it keeps the cosine and the sine of an angle without limits."""
    q = pin.neutral(model)
    for name, position in zip(JOINTS, positions, strict=True):
        at = model.idx_qs[model.getJointId(name)]
        if model.nqs[model.getJointId(name)] == 2:
            q[at : at + 2] = np.cos(position), np.sin(position)
        else:
            q[at] = position
    return q


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def turn_about(axis, angle):
    """Rodrigues' formula."""
    return np.eye(3) + np.sin(angle) * skew(axis) + (1 - np.cos(angle)) * skew(axis) @ skew(axis)


def screw_motion(axis, point, angle):
    """Exponential of a twist that turns about a line."""
    motion = np.eye(4)
    motion[:3, :3] = turn_about(axis, angle)
    motion[:3, 3] = point - motion[:3, :3] @ point
    return motion


def product_of_exponentials(positions):
    """Pose of the gripper's tip from the manual's lengths alone."""
    x, y, yaw, *arm = positions[:8]
    up, left = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])
    mount_ahead, mount_height = 0.1662, 0.0989
    shoulder = np.array([mount_ahead + 0.033, 0, mount_height + 0.147])
    elbow = shoulder + 0.155 * up
    wrist = elbow + 0.135 * up
    tip = wrist + 0.2176 * up
    pose = np.eye(4)
    pose[:2, 3] = x, y
    pose = pose @ screw_motion(up, np.zeros(3), yaw)
    pose = pose @ screw_motion(-up, np.array([mount_ahead, 0, 0]), arm[0])
    for point, angle in zip((shoulder, elbow, wrist), arm[1:4], strict=True):
        pose = pose @ screw_motion(left, point, angle)
    pose = pose @ screw_motion(-up, tip, arm[4])
    home = np.eye(4)
    home[:3, 3] = tip
    return pose @ home


def stretched_torques(model, payload):
    """Torque that holds joints 2, 3, 4 of the arm stretched forward, level, a payload [kg] at the tip."""
    data = model.createData()
    positions = np.zeros(len(JOINTS))
    positions[JOINTS.index("arm_joint_2")] = np.pi / 2
    q = configuration(model, positions)
    torque = pin.computeGeneralizedGravity(model, data, q)
    tip = model.getFrameId("ee")
    jacobian = pin.computeFrameJacobian(model, data, q, tip, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    torque = torque + jacobian[2] * payload * GRAVITY
    return np.abs([torque[model.idx_vs[model.getJointId(name)]] for name in ARM[1:4]])


def test_generator_reproduces_the_file(generator):
    assert generator.urdf_text().encode() == URDF.read_bytes(), "run python robots/youbot/make_urdf.py"


def test_joints_and_frame(model):
    assert sorted(model.names[1:]) == sorted(JOINTS)
    assert model.existFrame("ee")
    assert model.existFrame("base_link")


def test_total_mass(model):
    arm = 0.961 + 1.390 + 1.318 + 0.821 + 0.769 + 0.687
    gripper = 0.199 + 2 * 0.010
    assert pin.computeTotalMass(model) == pytest.approx(24.0 + arm + gripper, abs=1e-5)
    # The manual's weights: platform 20, battery 4, arm 5.69, gripper 0.245.
    assert pin.computeTotalMass(model) == pytest.approx(29.94, abs=0.25)


def test_forward_kinematics_is_a_product_of_exponentials(model):
    rng = np.random.default_rng(SEED)
    data = model.createData()
    tip = model.getFrameId("ee")
    for trial in range(200):
        positions = random_positions(rng)
        pin.framesForwardKinematics(model, data, configuration(model, positions))
        error = np.abs(data.oMf[tip].homogeneous - product_of_exponentials(positions)).max()
        assert error < 1e-12, f"seed {SEED}, trial {trial}: off by {error:.1e} at {positions.tolist()}"


def test_inertias_are_those_of_bodies(inertials):
    for name, (mass, _, tensor) in inertials.items():
        assert mass > 0, name
        small, middle, large = np.linalg.eigvalsh(tensor)
        assert small > 0, f"{name}: not positive definite"
        assert small + middle > large, f"{name}: breaks the triangle inequality"


@pytest.mark.parametrize("link", PUBLISHED_LINKS)
def test_link_inertia_is_the_published_one(inertials, link):
    axes, (mass, centre, moments, (a, b, c)) = PUBLISHED_LINKS[link]
    to_base = np.array(axes, dtype=float)
    assert np.linalg.det(to_base) == pytest.approx(1)
    principal = turn_about(np.array([1.0, 0, 0]), radians(c))
    principal = principal @ turn_about(np.array([0, 1.0, 0]), radians(b))
    principal = to_base @ principal @ turn_about(np.array([0, 0, 1.0]), radians(a))
    expected = principal @ np.diag(moments) @ principal.T
    # Published with the smallest moment across these two links, modelled with it along them: axes swapped.
    swap = {"arm_link_3": (1, 2), "arm_link_5": (0, 2)}.get(link)
    if swap:
        order = np.arange(3)
        order[list(swap)] = order[list(swap[::-1])]
        expected = expected[np.ix_(order, order)]
    written_mass, written_centre, written_tensor = inertials[link]
    assert written_mass == mass
    np.testing.assert_allclose(written_centre, to_base @ centre / 1e3, atol=1e-9)
    np.testing.assert_allclose(written_tensor, expected, atol=1e-7)


def test_position_limits_are_the_manuals(model):
    for name, (low, high) in zip(ARM, MANUAL_RANGE, strict=True):
        at = model.idx_qs[model.getJointId(name)]
        assert model.lowerPositionLimit[at] == pytest.approx(radians(low), abs=1e-6), name
        assert model.upperPositionLimit[at] == pytest.approx(radians(high), abs=1e-6), name


def test_speed_limits(model):
    expected = [0.8, 0.8, 0.8 / 0.385, *[radians(90)] * 5]
    for name, speed in zip(JOINTS, expected, strict=False):
        assert model.velocityLimit[model.idx_vs[model.getJointId(name)]] == pytest.approx(speed, abs=1e-6), (
            name
        )


def test_effort_limits(model, config):
    wheels = config["mecanum_base"]
    force = 4 * wheels["wheel_effort_limit"] / wheels["wheel_radius"]
    moment = force * (wheels["half_wheelbase"] + wheels["half_track"])
    expected = [force, force, moment, 12.9, 12.9, 8.27, 4.17, 1.755]
    for name, effort in zip(JOINTS, expected, strict=False):
        assert model.effortLimit[model.idx_vs[model.getJointId(name)]] == pytest.approx(effort, abs=1e-6), (
            name
        )


def test_stretched_arm_needs_more_than_ros_allows(model):
    empty = stretched_torques(model, 0.0)
    assert empty == pytest.approx([9.78, 4.51, 1.45], abs=0.005)
    loaded = stretched_torques(model, PAYLOAD)
    reach = np.array([0.5076, 0.3526, 0.2176])  # from axes 2, 3, 4 to the tip
    assert loaded - empty == pytest.approx(PAYLOAD * GRAVITY * reach, abs=1e-9)
    assert empty[0] > 9.5
    assert np.all(loaded > [9.5, 6.0, 2.0])
    limits = [model.effortLimit[model.idx_vs[model.getJointId(name)]] for name in ARM[1:4]]
    assert np.all(loaded < limits)


def test_configuration_has_the_schemas_keys(config):
    assert set(config) == {"name", "locked_joints", "rotor_inertia", "mecanum_base", "collisions"}
    assert config["name"] == "youbot"
    assert config["locked_joints"] == {"gripper_finger_joint_l": 0.0, "gripper_finger_joint_r": 0.0}
    assert list(config["rotor_inertia"]) == ARM
    assert set(config["mecanum_base"]) == {
        "joints",
        "wheel_radius",
        "half_wheelbase",
        "half_track",
        "wheel_effort_limit",
        "wheel_rotor_inertia",
    }
    assert config["mecanum_base"]["joints"] == {"x": "base_x", "y": "base_y", "yaw": "base_yaw"}


def test_rotor_inertias_are_reflected_through_the_gears(config):
    rotors = [1.35e-5, 1.35e-5, 1.35e-5, 9.25e-6, 3.5e-6]
    gears = [156, 156, 100, 71, 71]
    reflected = [rotor * gear**2 for rotor, gear in zip(rotors, gears, strict=True)]
    assert list(config["rotor_inertia"].values()) == pytest.approx(reflected, rel=5e-4)
    wheels = config["mecanum_base"]
    assert wheels["wheel_rotor_inertia"] == pytest.approx(1.35e-5 * WHEEL_GEAR**2, rel=5e-4)
    assert wheels["wheel_effort_limit"] == pytest.approx(0.0827 * WHEEL_GEAR, rel=5e-4)


def test_configuration_and_urdf_have_the_same_wheels(config, generator):
    wheels = config["mecanum_base"]
    assert wheels["wheel_radius"] == generator.WHEEL_RADIUS
    assert wheels["half_wheelbase"] == generator.HALF_WHEELBASE
    assert wheels["half_track"] == generator.HALF_TRACK
    assert wheels["wheel_effort_limit"] == generator.WHEEL_EFFORT
