"""The robot that torques act on, by Pinocchio: tsid's environment and tope's both have it."""

from __future__ import annotations

import numpy as np
import pinocchio
from closed_loop import Setup


class RigidBody:
    """Links and rotors without friction."""

    def __init__(self, setup: Setup) -> None:
        self.model = pinocchio.buildModelFromUrdf(setup.urdf)
        self.model.armature = setup.rotor_inertia
        self.data = self.model.createData()

    def acceleration(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Forward dynamics."""
        return np.array(pinocchio.aba(self.model, self.data, q, v, tau))
