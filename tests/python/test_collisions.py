"""Distances in Python and in scenarios, and the youBot's spheres against its URDF.

The rows and what the law makes of them are tested in C++; here the distances are computed anew with
Pinocchio's kinematics, and one scenario is run to its goal.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml
from kinematics import frames

import tope
from tope import _core
from tope.scene import scene

ROOT = Path(__file__).parents[2]
URDF = ROOT / "robots/youbot/youbot.urdf"
CONFIG = ROOT / "robots/youbot/youbot.yaml"
SCENARIO = ROOT / "scenarios/youbot_obstacle.yaml"
Q0 = np.array([0.0, 0, 0, 0, 0.4, 0.9, 0.6, 0])
SPHERES = {sphere["name"]: sphere for sphere in yaml.safe_load(CONFIG.read_text())["collisions"]["spheres"]}
SPACING = 4e-3  # between the points that a shape is sampled at [m]


@pytest.fixture
def robot() -> tope.Robot:
    return tope.Robot.from_urdf(URDF, CONFIG)


def controller(robot: tope.Robot, *bodies: tope.CollisionBody, **options: object) -> tope.Controller:
    collisions = tope.CollisionOptions(bodies=list(bodies), **options)
    return tope.Controller(robot, mode="velocity", dt=1e-3, limits=tope.LimitOptions(collisions=collisions))


def grid(*lengths: float) -> np.ndarray:
    """Points (rows, n) that fill a box about the origin, its faces included."""
    axes = [np.linspace(-length / 2, length / 2, int(length / SPACING) + 2) for length in lengths]
    return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, len(lengths))


def filling(geometry: ET.Element) -> np.ndarray:
    """Points (rows, 3) that fill a box or a cylinder, its surface included."""
    shape = geometry[0]
    if shape.tag == "box":
        return grid(*(float(number) for number in shape.attrib["size"].split()))
    radius, length = float(shape.attrib["radius"]), float(shape.attrib["length"])
    around = np.linspace(0, 2 * np.pi, 100)
    rim = radius * np.stack([np.cos(around), np.sin(around)], axis=1)
    disc = np.vstack([rim * share for share in np.linspace(0, 1, int(radius / SPACING) + 2)])
    heights = np.linspace(-length / 2, length / 2, int(length / SPACING) + 2)
    return np.vstack([np.column_stack([disc, np.full(len(disc), height)]) for height in heights])


def collision_points() -> Iterator[tuple[str, np.ndarray]]:
    """Each link with the points of its collision shapes, in the link's frame."""
    for link in ET.parse(URDF).getroot().iter("link"):
        for collision in link.iter("collision"):
            origin = collision.find("origin")
            xyz = np.array([float(number) for number in origin.attrib["xyz"].split()])
            rpy = [float(number) for number in origin.attrib["rpy"].split()]
            yield link.attrib["name"], filling(collision.find("geometry")) @ pin.rpy.rpyToMatrix(*rpy).T + xyz


def sphere_centers(placements: Mapping[str, pin.SE3]) -> dict[str, np.ndarray]:
    return {
        name: placements[sphere["frame"]].act(np.array(sphere["center"], dtype=float))
        for name, sphere in SPHERES.items()
    }


def test_spheres_cover_the_collision_shapes_of_the_urdf():
    """With the gripper closed and all joints at zero; each link by spheres that move with it."""
    placements = frames({})
    model = pin.buildModelFromUrdf(str(URDF))
    carriers = {frame.name: frame.parentJoint for frame in model.frames}
    held = {model.getJointId(f"gripper_finger_joint_{side}"): carriers["gripper_base_link"] for side in "lr"}
    centers = sphere_centers(placements)
    links = 0
    for link, points in collision_points():
        carrier = held.get(carriers[link], carriers[link])
        beside = [name for name, sphere in SPHERES.items() if carriers[sphere["frame"]] == carrier]
        world = points @ placements[link].rotation.T + placements[link].translation
        outside = np.min(
            [np.linalg.norm(world - centers[name], axis=1) - SPHERES[name]["radius"] for name in beside],
            axis=0,
        )
        assert outside.max() <= 0, (link, outside.max())
        links += 1
    assert links >= 14


def test_distances_are_those_of_pinocchio_and_closed_forms(robot):
    half = np.array([0.1, 0.2, 0.3])
    turn = np.array([0.9, 0.1, -0.3, 0.3]) / np.linalg.norm([0.9, 0.1, -0.3, 0.3])
    ball = tope.CollisionBody("ball", tope.Sphere(radius=0.1), position=[1.5, 0.2, 0.4])
    crate = tope.CollisionBody("crate", tope.Box(size=2 * half), position=[1.4, -0.9, 0.2], rotation=turn)
    wall = tope.CollisionBody(
        "wall", tope.HalfSpace(), position=[2, 0, 0], rotation=[0.5**0.5, 0, -(0.5**0.5), 0]
    )
    c = controller(robot, ball, crate, wall)
    c.update(Q0, np.zeros(8), 0.0)
    names = dict(zip(robot.joint_names, Q0, strict=True))
    rotation = pin.Quaternion(turn[0], *turn[1:]).toRotationMatrix()
    for name, center in sphere_centers(frames(names)).items():
        radius = SPHERES[name]["radius"]
        assert c.distances[f"{name}.ball"] == pytest.approx(
            np.linalg.norm(center - [1.5, 0.2, 0.4]) - 0.1 - radius, abs=1e-9
        )
        local = np.abs(rotation.T @ (center - [1.4, -0.9, 0.2])) - half
        assert c.distances[f"{name}.crate"] == pytest.approx(
            np.linalg.norm(np.maximum(local, 0)) - radius, abs=1e-9
        )
        assert c.distances[f"{name}.wall"] == pytest.approx(2 - center[0] - radius, abs=1e-9)


def test_a_controller_stops_before_a_hull_and_makes_way_when_it_comes(robot):
    corners = [[x, y, z] for x in (-0.1, 0.1) for y in (-0.5, 0.5) for z in (0, 1)]
    block = tope.CollisionBody("block", tope.ConvexHull(points=corners), position=[1.0, 0, 0])
    c = controller(robot, block)
    c.add(tope.FramePosition(frame="ee", target=[2.0, 0, 0.3]), level=1)
    q, v, least = Q0.copy(), np.zeros(8), 1.0
    for cycle in range(4000):
        t = 1e-3 * cycle
        if cycle >= 3000:
            x = 1.0 - 0.2 * (t - 3.0)
            c.move_obstacle("block", position=[x, 0, 0], velocity=[-0.2, 0, 0])
        v = c.update(q, v, t)
        q = q + 1e-3 * v
        least = min(least, *c.distances.values())
        if cycle == 2999:
            assert "avoiding" in c.status.events
            assert ".block shapes the command" in c.status_text
            before = q[0]
    assert least > 0.01
    assert q[0] < before - 0.1


def test_mistakes_are_told(robot):
    ball = tope.CollisionBody("ball", tope.Sphere(radius=0.1), position=[2, 0, 0])
    with pytest.raises(tope.ConfigError, match="unknown frame 'eee'"):
        controller(
            robot, ball, spheres=[tope.CollisionSphere("tip", frame="eee", center=[0, 0, 0], radius=0.1)]
        )
    with pytest.raises(tope.ConfigError, match="unknown sphere or frame 'tip'"):
        controller(robot, ball, exclude=[("tip", "ball")])
    with pytest.raises(tope.ConfigError, match="size: expected three numbers"):
        tope.Box(size=[1, 2])
    with pytest.raises(tope.ConfigError, match="no such mesh file"):
        tope.ConvexHull.of_mesh("nowhere.stl")
    with pytest.raises(tope.ConfigError, match="'chain' keeps no distances; use 'unilateral'"):
        options = tope.LimitOptions(method="chain", collisions=tope.CollisionOptions(bodies=[ball]))
        tope.Controller(robot, mode="velocity", dt=1e-3, limits=options)
    c = controller(robot, ball)
    with pytest.raises(tope.ConfigError, match="unknown body 'bal'"):
        c.move_obstacle("bal", position=[1, 0, 0])
    with pytest.raises(tope.ConfigError, match="only a body that the world carries"):
        c.move_obstacle("chassis", position=[1, 0, 0])
    plain = tope.Controller(robot, mode="velocity", dt=1e-3)
    assert plain.distances == {}
    with pytest.raises(tope.ConfigError, match="keeps no distances"):
        plain.move_obstacle("ball", position=[1, 0, 0])


def test_a_hull_of_a_mesh_file_is_that_of_its_points(robot, tmp_path):
    corners = [[x, y, z] for x in (0, 0.2) for y in (0, 0.2) for z in (0, 0.2)]
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    (tmp_path / "box.obj").write_text(vertices + "f 1 2 4\nf 5 6 8\nf 3 7 8\nf 1 5 7\n")
    shapes = {
        "mesh": tope.ConvexHull.of_mesh(tmp_path / "box.obj"),
        "points": tope.ConvexHull(points=corners),
    }
    c = controller(
        robot, *(tope.CollisionBody(name, each, position=[1, 0.1, 0]) for name, each in shapes.items())
    )
    c.update(Q0, np.zeros(8), 0.0)
    for name in SPHERES:
        assert c.distances[f"{name}.mesh"] == pytest.approx(c.distances[f"{name}.points"], abs=1e-6)


@pytest.mark.parametrize("mode", ["velocity", "torque"])
def test_the_scenario_reaches_its_goal_past_the_post(mode):
    run = tope.simulate(SCENARIO, overrides={"mode": mode})
    assert run.summary["task_error"]["position"]["final"] < 1e-3
    least = run.summary["least_distance"]
    assert least["overall"] == min(each for pair, each in least.items() if pair != "overall") > 0.01
    for pair in run.scenario["distances"]:
        assert run.log[f"d.{pair}"].min() == pytest.approx(least[pair], abs=1e-9)
    avoided = run.summary["status_counts"]["avoiding"]
    assert avoided == sum("avoiding" in text.split("|") for text in run.log["status"][:-1]) > 100


def test_a_run_is_read_back_and_shows_its_obstacles(tmp_path):
    run = tope.simulate(SCENARIO, out=tmp_path, overrides={"duration": 0.2}, report=False)
    again = tope.load_run(tmp_path)
    assert set(again.log) == set(run.log)
    world = next(link for link in scene({"run": again})["links"] if link["name"] == "world")
    shown = {visual["shape"]: visual for visual in world["visuals"]}
    assert shown["cylinder"]["size"] == (0.06, 0.8)
    assert shown["box"]["xyz"] == [1.55, -0.8, 0.125]


def test_mistakes_in_a_scenario_are_told_with_their_place():
    for key, value, message in (
        ("collisions.margn", 0.1, "collisions.margn: unknown key.*margin"),
        ("collisions.margin", 0, "collisions.margin: must be positive"),
        ("collisions.obstacles.post.type", "cone", "collisions.obstacles.0.type.*cone"),
        ("collisions.obstacles.post.frame", "eee", "collisions: .*unknown frame 'eee'"),
        ("collisions.obstacles.post.name", "crate", "a second body is named 'crate'"),
        ("collisions.exclude.0.body", "roof", "unknown body 'roof'"),
        (
            "collisions.obstacles.crate.size",
            [1, 1, 0],
            "collisions.obstacles.1.size: lengths must be positive",
        ),
    ):
        with pytest.raises(tope.ConfigError, match=message):
            tope.load_scenario(SCENARIO, {key: value})
    with pytest.raises(_core.Error, match="'switch' keeps no distances"):
        tope.simulate(SCENARIO, overrides={"limits.method": "switch"})
