"""An obstacle on the live page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import viser

COLOUR = (86, 120, 154)


class LiveObstacle:
    """A kerb that people push along its joint's axis; the joint's limit moves along."""

    def __init__(
        self,
        server: viser.ViserServer,
        obstacle: Mapping[str, Any],
        change: Callable[[Mapping[str, Any], LiveObstacle], None],
    ) -> None:
        """Draw an obstacle of `scene.obstacles`; `change` replaces keys of the scenario for us."""
        self.joint, self.side = obstacle["joint"], obstacle["side"]
        self.axis = int(np.argmax(np.abs(obstacle["direction"])))
        self.offset = obstacle["limit"] - obstacle["xyz"][self.axis]
        self.change = change
        self.handle = server.scene.add_transform_controls(
            f"/obstacle/{self.joint}_{self.side}",
            scale=0.25,
            active_axes=(self.axis == 0, self.axis == 1, False),
            disable_rotations=True,
            disable_sliders=True,
            position=np.array(obstacle["xyz"]),
        )
        kerb = f"{self.handle.name}/kerb"
        server.scene.add_box(kerb, color=COLOUR, dimensions=tuple(obstacle["size"]), opacity=0.7)
        self.handle.on_update(self.pushed)

    def pushed(self, _: viser.TransformControlsEvent) -> None:
        """Move the limit to where the kerb is now."""
        limit = float(self.handle.position[self.axis]) + self.offset
        self.change({f"limits.joints.{self.joint}.{self.side}": limit}, self)

    def show(self, joints: Sequence[Mapping[str, Any]]) -> None:
        """Stand where the limit is, whoever moved it."""
        limit = next(joint[self.side] for joint in joints if joint["name"] == self.joint)
        position = np.array(self.handle.position)
        position[self.axis] = limit - self.offset
        if np.any(np.abs(position - self.handle.position) > 1e-9):
            self.handle.position = position
