"""The robot on the live page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import viser

from tope.panels import Array
from tope.session import State
from tope.urdf import Colour, Joint, RobotTree, Visual, quaternions

ACTING = np.array([213.0, 94.0, 0.0])  # colour of a limit that acts


class LiveRobot:
    """The robot's links in the scene."""

    def __init__(self, server: viser.ViserServer, tree: RobotTree, scenario: Mapping[str, Any]) -> None:
        """Draw the robot of a scenario, with all joints at 0."""
        server.scene.set_up_direction("+z")
        server.scene.add_grid("/floor", width=8, height=8, cell_size=0.25, section_size=1.0)
        self.names = [joint["name"] for joint in scenario["joints"]]
        held = scenario["robot"]["locked_joints"]
        paths = {tree.root: "/robot"}
        self.frames: dict[str, tuple[Joint, viser.FrameHandle]] = {}
        self.shapes: dict[str, list[tuple[Any, Array]]] = {}
        for joint in tree.joints:
            paths[joint.child] = f"{paths[joint.parent]}/{joint.child}"
            frame = server.scene.add_frame(paths[joint.child], show_axes=False)
            place(frame, joint, held.get(joint.name, 0.0))
            self.frames[joint.name] = (joint, frame)
        for link, path in paths.items():
            self.shapes[link] = [
                (add_shape(server, f"{path}/shape_{i}", visual), muted(visual.colour))
                for i, visual in enumerate(tree.visuals.get(link, ()))
            ]
        self.moved = [tree.first_shapes(self.frames[name][0].child) for name in self.names]

    def show(self, state: State) -> None:
        """Move the joints, and colour links as far as the limits of their joints act."""
        acting = {link: 0.0 for links in self.moved for link in links}
        for i, name in enumerate(self.names):
            place(self.frames[name][1], self.frames[name][0], float(state.position[i]))
            share = round(float(max(state.upper[i], state.lower[i])), 2)
            acting.update({link: max(acting[link], share) for link in self.moved[i]})
        for link, share in acting.items():
            for handle, own in self.shapes.get(link, ()):
                colour = tuple(int(c) for c in own + 0.85 * share * (ACTING - own))
                if tuple(handle.color) != colour:
                    handle.color = colour


def place(frame: viser.FrameHandle, joint: Joint, q: float) -> None:
    """Put a link where its joint's position says."""
    placement = joint.placement(np.array([q]))[0]
    frame.position = placement[:3, 3]
    frame.wxyz = np.roll(quaternions(placement[None, :3, :3])[0], 1)


def muted(colour: Colour) -> Array:
    """A colour from 0 to 255, greyer than it is, so that an acting limit stands out."""
    channels = np.array(colour)
    return np.asarray(255 * (0.35 * channels + 0.65 * (0.15 + 0.7 * channels.mean())))


def add_shape(server: viser.ViserServer, path: str, visual: Visual) -> Any:
    """A shape of a link."""
    colour = muted(visual.colour).astype(int)
    where: dict[str, Any] = {
        "position": visual.link_T_shape[:3, 3],
        "wxyz": np.roll(quaternions(visual.link_T_shape[None, :3, :3])[0], 1),
    }
    if visual.shape == "box":
        x, y, z = visual.size
        return server.scene.add_box(path, color=colour, dimensions=(x, y, z), **where)
    if visual.shape == "sphere":
        return server.scene.add_icosphere(path, radius=visual.size[0], color=colour, **where)
    radius, height = visual.size
    return server.scene.add_cylinder(path, radius=radius, height=height, color=colour, **where)
