"""URDF and scene: kinematics against Pinocchio on a made-up robot, shapes, obstacles; what was saturated.

Not covered here: how it is drawn (test_report_page.py, test_play.py).
"""

from __future__ import annotations

import numpy as np
import pinocchio
import pytest
from scipy.spatial.transform import Rotation
from test_report import make_run

from tope import _core
from tope.saturation import distances, saturation, stretches
from tope.scene import obstacles, reach
from tope.urdf import quaternions, read_urdf, rotations

ROBOT = """<robot name="crooked">
  <material name="paint"><color rgba="0.2 0.4 0.6 1"/></material>
  <link name="tip">
    <visual><geometry><sphere radius="0.05"/></geometry><material name="paint"/></visual>
  </link>
  <link name="ground"/>
  <link name="cart"/>
  <link name="body">
    <visual><origin xyz="0.1 0 0.2" rpy="0 0 1.5707963267948966"/>
      <geometry><box size="0.2 0.6 0.4"/></geometry>
      <material name=""><color rgba="1 0 0 1"/></material></visual>
    <visual><geometry><mesh filename="body.stl"/></geometry></visual>
  </link>
  <link name="arm"><visual><geometry><cylinder radius="0.03" length="0.5"/></geometry></visual></link>
  <joint name="wrist" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0 0.1 0.3" rpy="0.3 -0.2 1"/></joint>
  <joint name="slide" type="prismatic"><parent link="ground"/><child link="cart"/><axis xyz="2 0 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="spin" type="continuous"><parent link="cart"/><child link="body"/><axis xyz="0 0 1"/>
    <limit effort="1" velocity="1"/></joint>
  <joint name="lift" type="revolute"><parent link="body"/><child link="arm"/>
    <origin xyz="0.3 0 0.4" rpy="0.1 0.2 -0.7"/>
    <axis xyz="1 2 -0.5"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
</robot>"""


@pytest.fixture
def urdf(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(ROBOT)
    return file


def described(**limits):
    return [{"name": "slide", "lower": -3.0, "upper": 3.0, **limits}]


@pytest.mark.parametrize("seed", range(5))
def test_links_are_where_pinocchio_says(urdf, seed):
    tree = read_urdf(urdf)
    model = pinocchio.buildModelFromXML(ROBOT)
    data = model.createData()
    slide, spin, lift = np.random.default_rng(seed).uniform(-2, 2, 3)
    values = {"slide": [slide], "spin": [np.cos(spin), np.sin(spin)], "lift": [lift]}
    q = np.concatenate([values[name] for name in list(model.names)[1:]])
    pinocchio.framesForwardKinematics(model, data, q)
    positions = {
        name: np.array([0.0, value]) for name, value in zip(values, (slide, spin, lift), strict=True)
    }
    placements = tree.placements(positions, 2)
    assert set(placements) == {"ground", "cart", "body", "arm", "tip"}
    for link, found in placements.items():
        expected = data.oMf[model.getFrameId(link)].homogeneous
        np.testing.assert_allclose(found[1], expected, atol=1e-12, err_msg=f"{link}, seed {seed}")


def test_rotations_and_quaternions_are_those_of_scipy():
    rng = np.random.default_rng(3)
    vectors = rng.normal(size=(200, 3)) * rng.uniform(0, np.pi, size=(200, 1))
    vectors[0] = 0.0
    vectors[1] = [np.pi, 0.0, 0.0]
    vectors[2] = [1e-9, 0.0, 0.0]
    np.testing.assert_allclose(rotations(vectors), Rotation.from_rotvec(vectors).as_matrix(), atol=1e-12)
    q = quaternions(rotations(vectors))
    np.testing.assert_allclose(Rotation.from_quat(q).as_matrix(), rotations(vectors), atol=1e-12)


def test_quaternions_of_a_motion_do_not_change_sign():
    turns = rotations(np.outer(np.linspace(0, 20, 2000), [0.6, 0.0, 0.8]))
    assert np.abs(np.diff(quaternions(turns), axis=0)).max() < 0.01


def test_shapes_have_size_colour_and_meshes_are_counted(urdf):
    tree = read_urdf(urdf)
    [box] = tree.visuals["body"]
    assert (box.shape, box.size, box.colour) == ("box", (0.2, 0.6, 0.4), (1.0, 0.0, 0.0))
    assert tree.visuals["tip"][0].colour == (0.2, 0.4, 0.6)
    assert tree.visuals["arm"][0].colour == (0.6, 0.6, 0.6)
    assert tree.meshes == 1


def test_a_limit_tighter_than_the_robots_own_is_an_obstacle_where_the_body_meets_it(urdf):
    tree = read_urdf(urdf)
    assert list(obstacles(tree, described())) == []
    [found] = obstacles(tree, described(upper=0.5))
    # the box is 0.6 m deep once turned, about 0.1 m: it reaches 0.4 m ahead
    near_face = found["xyz"][0] - found["size"][0] / 2
    assert near_face == pytest.approx(0.5 + 0.1 + 0.3)
    [behind] = obstacles(tree, described(lower=-1.0))
    assert behind["xyz"][0] + behind["size"][0] / 2 == pytest.approx(-1.0 + 0.1 - 0.3)
    assert reach(tree, tree.joints[0], np.array([1.0, 0.0, 0.0])) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (ROBOT[:200], "cannot be read"),
        (ROBOT.replace('<child link="cart"/>', ""), "has no <child>"),
        (ROBOT.replace('radius="0.05"', 'radius="wide"'), "not a robot's URDF"),
        ("<robot/>", "not a robot's URDF"),
    ],
)
def test_a_broken_urdf_is_an_error_that_names_it(tmp_path, broken, said):
    file = tmp_path / "broken.urdf"
    file.write_text(broken)
    with pytest.raises(_core.Error, match=rf"broken\.urdf: .*{said}"):
        read_urdf(file)


def test_saturation_names_limits_bounds_and_flags_with_their_times():
    run = make_run(rows=10001)
    t = run.time
    run.log["xi.base_x.upper"][:] = np.where((t >= 2) & (t <= 3), 0.5, 0.0)
    run.log["xi.arm_joint_5.lower"][:] = np.where(t >= 6, 1.0, 0.0)
    run.log["scale"][:] = np.where(t < 1, 0.25, 1.0)
    run.log["u.arm_joint_2"][500] = -1.5
    flags = np.where((t >= 4) & (t <= 4.5), "limit|cut_off", "ok")
    run.log["status"] = flags
    assert saturation(run) == [
        "The upper limit of base_x acted from 2 s to 3 s, by up to 50 %",
        "The lower limit of arm_joint_5 acted from 6 s to the end, by up to 100 %",
        "The tasks were slowed by the bound of arm_joint_2 from 0 s to 1 s, to 25 %",
        "The solver was cut off: limits held, tasks were served less well from 4 s to 4.5 s",
    ]


def test_many_stretches_are_told_briefly():
    run = make_run(rows=10001)
    for name in list(run.log):
        if name.startswith("xi."):
            run.log[name][:] = 0.0
    run.log["status"][:] = "ok"
    run.log["xi.base_y.upper"][::1000] = 1.0
    assert saturation(run) == [
        "The upper limit of base_y acted at 0 s and at 1 s and at 2 s and 8 more times, the last at 10 s,"
        " by up to 100 %"
    ]
    run.log["xi.base_y.upper"][:] = 0.0
    assert saturation(run) == []
    run.log["scale"][:] = 0.5
    run.log["u.base_x"][:] = 0.0
    assert saturation(run)[0].startswith("The tasks were slowed by the bound of")
    assert "all the time, to 50 %" in saturation(run)[0]


@pytest.mark.parametrize("seed", range(20))
def test_stretches_hold_what_was_raised_and_no_long_gap(seed):
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 500)
    raised = rng.uniform(size=500) < rng.uniform(0.001, 0.5)
    raised[0] = True
    starts, ends = stretches(t, raised, 0.02)
    inside = np.zeros(500, dtype=bool)
    for start, end in zip(starts, ends, strict=True):
        inside |= (t >= start) & (t <= end)
    assert np.all(inside[raised]), f"seed {seed}"
    assert np.all(starts[1:] - ends[:-1] > 0.02)
    for start, end in zip(starts, ends, strict=True):
        inner = t[raised & (t >= start) & (t <= end)]
        assert inner[0] == start
        assert np.all(np.diff(inner) <= 0.02 + 2 * (t[1] - t[0])), f"seed {seed}: a long gap was told as one"


def test_distances_are_ordered_and_measured_by_the_buffer():
    summary = make_run(rows=11).summary
    summary["max_limit_violation"] |= {"base_x": -0.02, "arm_joint_1": 0.005}
    found = distances(summary)
    assert found[0] == ("arm_joint_1", "-5 mrad", pytest.approx(-0.05))
    assert found[1] == ("base_x", "0.02 m", pytest.approx(0.2))
