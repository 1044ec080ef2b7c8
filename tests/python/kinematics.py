"""Pinocchio's forward kinematics of the youBot, to check ours against."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pinocchio

URDF = Path(__file__).parents[2] / "robots/youbot/youbot.urdf"


def frames(positions: Mapping[str, float]) -> dict[str, pinocchio.SE3]:
    """The placement of every frame at joint positions; joints that are not named are at 0."""
    model = pinocchio.buildModelFromUrdf(str(URDF))
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, configuration(model, positions))
    return {frame.name: data.oMf[i] for i, frame in enumerate(model.frames)}


def centre_of_mass(positions: Mapping[str, float]) -> np.ndarray:
    """Of all links, at joint positions [m]."""
    model = pinocchio.buildModelFromUrdf(str(URDF))
    return pinocchio.centerOfMass(model, model.createData(), configuration(model, positions))


def jacobian(positions: Mapping[str, float], frame: str, joints: Sequence[str]) -> np.ndarray:
    """Of a frame, along the world's axes, linear above angular (6 rows): the columns of some joints."""
    model = pinocchio.buildModelFromUrdf(str(URDF))
    columns = pinocchio.computeFrameJacobian(
        model,
        model.createData(),
        configuration(model, positions),
        model.getFrameId(frame),
        pinocchio.LOCAL_WORLD_ALIGNED,
    )
    return columns[:, [model.joints[model.getJointId(name)].idx_v for name in joints]]


def configuration(model: pinocchio.Model, positions: Mapping[str, float]) -> np.ndarray:
    """Pinocchio's q, with cosine and sine for a continuous joint."""
    q = pinocchio.neutral(model)
    for name, value in positions.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(value), np.sin(value)] if joint.nq == 2 else value
    return q


def placement(position: list[float], xyzw: list[float]) -> pinocchio.SE3:
    """A placement of its position [m] and quaternion."""
    turned = pinocchio.Quaternion(np.array(xyzw, dtype=float))
    return pinocchio.SE3(turned, np.array(position, dtype=float))
