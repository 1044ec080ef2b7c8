"""A robot's URDF as plain data: the tree of its joints, the shapes of its links, and where they are."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from tope import _core

Array = NDArray[np.float64]
Colour = tuple[float, float, float]

GREY: Colour = (0.6, 0.6, 0.6)
SHAPES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}


@dataclass(frozen=True)
class Visual:
    """One shape of a link.

    `size` [m] is the edges of a box, radius and length of a cylinder (along z), or the radius of a sphere;
    `link_T_shape` (4, 4); `colour` red, green, blue from 0 to 1.
    """

    shape: str
    size: tuple[float, ...]
    link_T_shape: Array  # noqa: N815
    colour: Colour


@dataclass(frozen=True)
class Joint:
    """A joint: `parent_T_joint` (4, 4) at position 0, `axis` (3,), limits [rad or m] or None."""

    name: str
    type: str
    parent: str
    child: str
    parent_T_joint: Array  # noqa: N815
    axis: Array
    lower: float | None
    upper: float | None

    def placement(self, q: Array) -> Array:
        """parent_T_child (rows, 4, 4) at positions q (rows,) [rad or m]."""
        motion = np.tile(np.eye(4), (len(q), 1, 1))
        if self.type == "prismatic":
            motion[:, :3, 3] = np.outer(q, self.axis)
        elif self.type != "fixed":
            motion[:, :3, :3] = rotations(np.outer(q, self.axis))
        return self.parent_T_joint @ motion


@dataclass(frozen=True)
class RobotTree:
    """A robot's links and joints; joints come after the joint that carries them. `root` is the first link.

    `meshes` counts the shapes that are meshes, which `visuals` leaves out.
    """

    name: str
    root: str
    links: Sequence[str]
    joints: Sequence[Joint]
    visuals: Mapping[str, Sequence[Visual]]
    meshes: int

    def link_of(self, frame: str) -> str:
        """The link whose frame is called so: its own name, or that of the joint that carries it."""
        return next((joint.child for joint in self.joints if joint.name == frame), frame)

    def first_shapes(self, link: str) -> list[str]:
        """The nearest links, from this one outwards, that have a shape."""
        level = [link]
        while level and not any(self.visuals.get(each) for each in level):
            level = [joint.child for joint in self.joints if joint.parent in level]
        return [each for each in level if self.visuals.get(each)]

    def placements(self, positions: Mapping[str, Array], rows: int) -> dict[str, Array]:
        """world_T_link (rows, 4, 4) of every link; joints without `positions` (rows,) are at 0."""
        still = np.zeros(rows)
        world = {self.root: np.tile(np.eye(4), (rows, 1, 1))}
        for joint in self.joints:
            world[joint.child] = world[joint.parent] @ joint.placement(positions.get(joint.name, still))
        return world


def robot_tree(robot: Mapping[str, Any]) -> RobotTree:
    """The tree of a scenario's robot as `describe` tells of it; raises Error if its URDF is broken."""
    return read_urdf(robot["urdf"], robot.get("base"))


def read_urdf(path: str | os.PathLike[str], base: str | None = None) -> RobotTree:
    """Read a URDF file; raises Error if it is missing or broken. A `base` (a key of BASES) moves its root."""
    path = Path(path)
    try:
        root = ElementTree.parse(path).getroot()
    except FileNotFoundError as error:
        raise _core.Error(f"{path}: missing: it holds the robot's shape") from error
    except (OSError, ElementTree.ParseError) as error:
        raise _core.Error(f"{path}: cannot be read: {error}") from error
    try:
        tree = tree_of(root)
        return tree if base is None else on_base(tree, base)
    except (KeyError, ValueError, StopIteration) as error:
        raise _core.Error(f"{path}: not a robot's URDF: {error!r}") from error


def tree_of(root: ElementTree.Element) -> RobotTree:
    """The tree that a <robot> element describes."""
    links = [link.attrib["name"] for link in root.findall("link")]
    joints = {joint.child: joint for joint in map(joint_of, root.findall("joint"))}
    top = next(link for link in links if link not in joints)
    colours = {
        each.attrib["name"]: colour_of(each) for each in root.findall("material") if "name" in each.attrib
    }
    shapes = {
        link.attrib["name"]: [visual_of(each, colours) for each in link.findall("visual")]
        for link in root.findall("link")
    }
    return RobotTree(
        name=root.attrib.get("name", "robot"),
        root=top,
        links=links,
        joints=carried_order(top, list(joints.values())),
        visuals={link: [each for each in found if each is not None] for link, found in shapes.items()},
        meshes=sum(each is None for found in shapes.values() for each in found),
    )


# the joints that `base` in a robot's YAML file puts above the root: name, type, axis
BASES = {
    "planar": [("base_x", "prismatic", 0), ("base_y", "prismatic", 1), ("base_yaw", "continuous", 2)],
    "floating": [
        ("base_x", "prismatic", 0),
        ("base_y", "prismatic", 1),
        ("base_z", "prismatic", 2),
        ("base_yaw", "continuous", 2),
        ("base_pitch", "continuous", 1),
        ("base_roll", "continuous", 0),
    ],
}


def on_base(tree: RobotTree, base: str) -> RobotTree:
    """The same robot with its root on a moving base."""
    links = ["base_origin", *(f"{name}_link" for name, _, _ in BASES[base][:-1])]
    joints = [
        Joint(name, kind, parent, child, np.eye(4), np.eye(3)[axis], None, None)
        for (name, kind, axis), parent, child in zip(BASES[base], links, [*links[1:], tree.root], strict=True)
    ]
    return dataclasses.replace(
        tree, root=links[0], links=[*links, *tree.links], joints=[*joints, *tree.joints]
    )


def carried_order(top: str, joints: Sequence[Joint]) -> list[Joint]:
    """The joints from the root outwards."""
    ordered: list[Joint] = []
    reached = [top]
    for link in reached:
        for joint in joints:
            if joint.parent == link:
                ordered.append(joint)
                reached.append(joint.child)
    return ordered


def joint_of(element: ElementTree.Element) -> Joint:
    """One <joint>."""
    axis = numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0))
    limit = element.find("limit")
    bounds = {} if limit is None or element.attrib["type"] == "continuous" else limit.attrib
    return Joint(
        name=element.attrib["name"],
        type=element.attrib["type"],
        parent=child(element, "parent").attrib["link"],
        child=child(element, "child").attrib["link"],
        parent_T_joint=origin_of(element),
        axis=axis / np.linalg.norm(axis),
        lower=float(bounds["lower"]) if "lower" in bounds else None,
        upper=float(bounds["upper"]) if "upper" in bounds else None,
    )


def visual_of(element: ElementTree.Element, colours: Mapping[str, Colour]) -> Visual | None:
    """One <visual>; None for a mesh."""
    geometry = child(element, "geometry")[0]
    if geometry.tag not in SHAPES:
        return None
    size = [float(number) for key in SHAPES[geometry.tag] for number in geometry.attrib[key].split()]
    material = element.find("material")
    colour = GREY
    if material is not None:
        own = material.find("color") is not None
        colour = colour_of(material) if own else colours.get(material.attrib.get("name", ""), GREY)
    return Visual(geometry.tag, tuple(size), origin_of(element), colour)


def colour_of(material: ElementTree.Element) -> Colour:
    """The colour of a <material>."""
    red, green, blue = numbers(material.find("color"), "rgba", (*GREY, 1.0))[:3]
    return (float(red), float(green), float(blue))


def origin_of(element: ElementTree.Element) -> Array:
    """The <origin> of an element (4, 4); roll, pitch, yaw turn about fixed axes."""
    origin = element.find("origin")
    roll, pitch, yaw = numbers(origin, "rpy", (0.0, 0.0, 0.0))
    placement = np.eye(4)
    turns = rotations(np.array([[0, 0, yaw], [0, pitch, 0], [roll, 0, 0]]))
    placement[:3, :3] = turns[0] @ turns[1] @ turns[2]
    placement[:3, 3] = numbers(origin, "xyz", (0.0, 0.0, 0.0))
    return placement


def child(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    """The child with this tag."""
    found = element.find(tag)
    if found is None:
        raise ValueError(f"<{element.tag} name='{element.attrib.get('name', '')}'> has no <{tag}>")
    return found


def numbers(element: ElementTree.Element | None, key: str, fallback: Sequence[float]) -> Array:
    """The numbers of an attribute, or the fallback if it is not given."""
    text = None if element is None else element.attrib.get(key)
    return np.array(fallback if text is None else text.split(), dtype=float)


def rotations(vectors: Array) -> Array:
    """Rotation matrices (rows, 3, 3) of rotation vectors (rows, 3) [rad], by Rodrigues' formula."""
    angles = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.where(angles > 0, angles, 1.0)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))


def quaternions(matrices: Array) -> Array:
    """Unit quaternions x, y, z, w (rows, 4) of rotation matrices (rows, 3, 3); their signs do not jump."""
    m = matrices
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    # four times the squares, and the products, of the components: the row of the largest one is accurate
    k = np.empty((len(m), 4, 4))
    for i in range(3):
        k[:, i, i] = 1 + 2 * m[:, i, i] - trace
        for j in range(i):
            k[:, i, j] = k[:, j, i] = m[:, i, j] + m[:, j, i]
    k[:, 3, 3] = 1 + trace
    k[:, 3, 0] = k[:, 0, 3] = m[:, 2, 1] - m[:, 1, 2]
    k[:, 3, 1] = k[:, 1, 3] = m[:, 0, 2] - m[:, 2, 0]
    k[:, 3, 2] = k[:, 2, 3] = m[:, 1, 0] - m[:, 0, 1]
    best = np.argmax(np.diagonal(k, axis1=1, axis2=2), axis=1)
    q = k[np.arange(len(m)), best]
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    flips = np.cumprod(np.where(np.sum(q[1:] * q[:-1], axis=1) < 0, -1.0, 1.0))
    q[1:] *= flips[:, None]
    return np.asarray(q)
