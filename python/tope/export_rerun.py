"""A run as a recording that Rerun opens."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr

from tope.panels import Array
from tope.runs import Run
from tope.scene import goals, joint_positions, obstacles, read_tree
from tope.urdf import RobotTree, Visual, quaternions

TIMELINE = "time"  # [s] from the start of the run


def write(run: Run, file: Path) -> None:
    """Write the run: the robot and its goals under /world, every column of the log under /log."""
    tree = read_tree(run)
    name = run.scenario["name"]
    with rr.RecordingStream("tope", recording_id=f"{name}, {run.scenario['method']}") as recording:
        recording.save(file)
        recording.send_recording_name(name)
        recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        index = [rr.TimeColumn(TIMELINE, duration=run.time)]
        send_robot(recording, index, tree, run)
        send_obstacles(recording, tree, run)
        send_log(recording, index, run)
    recording.disconnect()  # closes the file


def send_robot(recording: rr.RecordingStream, index: list[rr.TimeColumn], tree: RobotTree, run: Run) -> None:
    """The links' shapes and motion, each under the link that carries it, and the goals."""
    positions = joint_positions(run, run.time)
    paths = {tree.root: f"world/{tree.root}"}
    for joint in tree.joints:
        paths[joint.child] = f"{paths[joint.parent]}/{joint.child}"
        if joint.name in positions:
            send_placement(recording, index, paths[joint.child], joint.placement(positions[joint.name]))
        else:
            recording.log(paths[joint.child], still(joint.placement(np.zeros(1))[0]), static=True)
    for link, path in paths.items():
        for number, visual in enumerate(tree.visuals.get(link, ())):
            recording.log(f"{path}/shape_{number}", still(visual.link_T_shape), shape(visual), static=True)
    for goal in goals(tree, run, tree.placements(positions, len(run.time)), run.time):
        placements = np.tile(np.eye(4), (len(run.time), 1, 1))
        placements[:, :3, 3] = goal.position
        if goal.rotation is not None:
            placements[:, :3, :3] = goal.rotation
        path = f"world/goal/{goal.frame}"
        recording.log(path, rr.TransformAxes3D(0.1), static=True)
        send_placement(recording, index, path, placements)


def send_placement(
    recording: rr.RecordingStream, index: list[rr.TimeColumn], path: str, placements: Array
) -> None:
    """Placements (rows, 4, 4) of an entity in its parent."""
    columns = rr.Transform3D.columns(
        translation=placements[:, :3, 3], quaternion=quaternions(placements[:, :3, :3])
    )
    recording.send_columns(path, index, columns)


def still(placement: Array) -> rr.Transform3D:
    """A placement (4, 4) that never changes."""
    return rr.Transform3D(
        translation=placement[:3, 3], quaternion=rr.Quaternion(xyzw=quaternions(placement[None, :3, :3])[0])
    )


def shape(visual: Visual) -> Any:
    """A shape of a link."""
    colour = [round(255 * channel) for channel in visual.colour]
    solid = rr.components.FillMode.Solid
    if visual.shape == "box":
        return rr.Boxes3D(half_sizes=[[edge / 2 for edge in visual.size]], colors=[colour], fill_mode=solid)
    if visual.shape == "sphere":
        return rr.Ellipsoids3D(half_sizes=[3 * visual.size], colors=[colour], fill_mode=solid)
    radius, length = visual.size
    return rr.Cylinders3D(radii=[radius], lengths=[length], colors=[colour], fill_mode=solid)


def send_obstacles(recording: rr.RecordingStream, tree: RobotTree, run: Run) -> None:
    """What is in the robot's way."""
    for obstacle in obstacles(tree, run.scenario["joints"]):
        box = rr.Boxes3D(
            centers=[obstacle["xyz"]],
            half_sizes=[[edge / 2 for edge in obstacle["size"]]],
            labels=[obstacle["label"]],
        )
        recording.log(f"world/obstacle/{obstacle['joint']}", box, static=True)


def send_log(recording: rr.RecordingStream, index: Sequence[rr.TimeColumn], run: Run) -> None:
    """Every column: q.base_x as /log/q/base_x, and so on; the status as text where it changes."""
    for name, values in run.log.items():
        if name not in ("t", "status"):
            recording.send_columns(f"log/{name.replace('.', '/')}", index, rr.Scalars.columns(scalars=values))
    status = run.log["status"]
    changes = np.flatnonzero(np.concatenate(([True], status[1:] != status[:-1])))
    recording.send_columns(
        "log/status",
        [rr.TimeColumn(TIMELINE, duration=run.time[changes])],
        rr.TextLog.columns(text=status[changes].tolist()),
    )
