"""Forward kinematics and rotations of the benchmark's chain, with NumPy alone: every peer's environment
has it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Joint:
    """A joint of the chain from the world to the end-effector."""

    name: str
    prismatic: bool
    axis: np.ndarray  # in the joint's frame
    rotation: np.ndarray  # of the joint's frame in the frame of the joint before
    position: np.ndarray  # the same [m]


@dataclass(frozen=True)
class Pose:
    """Orientation and position [m] in the world."""

    rotation: np.ndarray
    position: np.ndarray


def forward(joints: list[Joint], tip: Pose, q: np.ndarray) -> Pose:
    """Pose of the end-effector."""
    rotation, position = np.eye(3), np.zeros(3)
    for joint, angle in zip(joints, q, strict=True):
        position = position + rotation @ joint.position
        rotation = rotation @ joint.rotation
        if joint.prismatic:
            position = position + rotation @ joint.axis * angle
        else:
            rotation = rotation @ exp3(joint.axis * angle)
    return Pose(rotation @ tip.rotation, position + rotation @ tip.position)


def exp3(vector: np.ndarray) -> np.ndarray:
    """The rotation by a rotation vector [rad]."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def log3(rotation: np.ndarray) -> np.ndarray:
    """The rotation vector of a rotation [rad]."""
    sine = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    angle = rotation_angle(rotation)
    if angle < 1e-6:
        return sine / 2
    if angle < math.pi - 1e-5:
        return sine * angle / (2 * math.sin(angle))
    outer = (rotation + rotation.T) / 4 + np.eye(
        3
    ) / 2  # axis times its transpose near pi, where the sine vanishes
    column = outer[:, int(np.argmax(np.diag(outer)))]
    axis = column / np.linalg.norm(column)
    return axis * angle * (1 if axis @ sine >= 0 else -1)


def rotation_angle(rotation: np.ndarray) -> float:
    """How far a rotation turns [rad]."""
    sine = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    return math.atan2(float(np.linalg.norm(sine)), float(np.trace(rotation)) - 1)


def towards(here: np.ndarray, goal: np.ndarray, at_most: float) -> np.ndarray:
    """The goal's rotation, or one on the way that is so far from here [rad]."""
    error = log3(here.T @ goal)
    angle = float(np.linalg.norm(error))
    return goal if angle <= at_most else here @ exp3(error * (at_most / angle))


def rotation_of_quaternion(quaternion: np.ndarray) -> np.ndarray:
    """The rotation of a quaternion (w, x, y, z) of any length."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_of_rpy(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """The rotation of a URDF's roll, pitch and yaw [rad]."""
    return exp3(np.array([0, 0, yaw])) @ exp3(np.array([0, pitch, 0])) @ exp3(np.array([roll, 0, 0]))
