"""A run as an MCAP file of ROS 2 messages, which Foxglove and PlotJuggler open."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap_ros2.writer import Writer

from tope.panels import Array
from tope.ros_messages import MESSAGES, definition
from tope.runs import Run
from tope.scene import Goal, goals, joint_positions, read_tree
from tope.urdf import Joint, RobotTree, quaternions

Message = Mapping[str, Any]

OK, WARN, ERROR = 0, 1, 2  # levels of a DiagnosticStatus
SERIOUS = {"beyond", "bad_input"}  # flags that are errors


def write(run: Run, file: Path) -> None:
    """Write the run: one message a row of the log and topic, at the row's time, counted from zero.

    /robot_description (URDF), /joint_states, /joint_commands, /tf and /tf_static (every link under the
    robot's first), /goal/<frame> where tasks want a frame, and /diagnostics: status, scale, activations of
    limits and tasks, task errors, distances, wheels, sensors.
    """
    tree = read_tree(run)
    positions = joint_positions(run, run.time)
    stamps = [stamp(t) for t in run.time]
    with file.open("wb") as stream, Writer(stream) as writer:
        schemas = {name: writer.register_msgdef(name, definition(name)) for name in MESSAGES}

        def send(topic: str, name: str, row: int, message: Message) -> None:
            time = stamps[row]["sec"] * 1_000_000_000 + stamps[row]["nanosec"]
            writer.write_message(topic, schemas[name], message, log_time=time, sequence=row)

        writer.add_metadata("tope", {"summary": json.dumps(run.summary, ensure_ascii=False)})
        urdf = Path(run.scenario["robot"]["urdf"]).read_text(encoding="utf-8")
        send("/robot_description", "std_msgs/msg/String", 0, {"data": urdf})
        still = [joint for joint in tree.joints if joint.name not in positions]
        send("/tf_static", "tf2_msgs/msg/TFMessage", 0, transforms(stamps[0], fixed(still)))
        aims = goals(tree, run, tree.placements(positions, len(run.time)), run.time)
        streams = [
            *joint_streams(run),
            ("/tf", "tf2_msgs/msg/TFMessage", moving(tree, positions, stamps)),
            *(
                (f"/goal/{goal.frame}", "geometry_msgs/msg/PoseStamped", poses(tree, goal, stamps))
                for goal in aims
            ),
            ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", diagnostics(run, stamps)),
        ]
        for row, messages in enumerate(zip(*(each for _, _, each in streams), strict=True)):
            for (topic, name, _), message in zip(streams, messages, strict=True):
                send(topic, name, row, message)


def stamp(t: float) -> dict[str, int]:
    """A time [s] as a ROS time."""
    nanoseconds = round(float(t) * 1e9)
    return {"sec": nanoseconds // 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000}


def joint_streams(run: Run) -> Iterator[tuple[str, str, Iterator[Message]]]:
    """The joints' states, and their commands."""
    names = [joint["name"] for joint in run.scenario["joints"]]
    q, v, u = (np.stack([run.log[f"{kind}.{name}"] for name in names], axis=1).tolist() for kind in "qvu")
    none: list[list[float]] = [[]] * len(q)
    torque = run.scenario["mode"] == "torque"
    kind = "sensor_msgs/msg/JointState"
    yield "/joint_states", kind, joint_messages(run, names, q, v, u if torque else none)
    yield (
        "/joint_commands",
        kind,
        joint_messages(run, names, none, none if torque else u, u if torque else none),
    )


def joint_messages(
    run: Run, names: Sequence[str], q: list[list[float]], v: list[list[float]], effort: list[list[float]]
) -> Iterator[Message]:
    """A JointState for each row."""
    for t, position, velocity, force in zip(run.time, q, v, effort, strict=True):
        header = {"stamp": stamp(t), "frame_id": ""}
        yield {"header": header, "name": names, "position": position, "velocity": velocity, "effort": force}


def fixed(joints: Sequence[Joint]) -> list[tuple[Joint, list[float], list[float]]]:
    """Joints that never move, with position and quaternion."""
    placements = [joint.placement(np.zeros(1)) for joint in joints]
    return [
        (joint, placement[0, :3, 3].tolist(), quaternions(placement[:, :3, :3])[0].tolist())
        for joint, placement in zip(joints, placements, strict=True)
    ]


def moving(
    tree: RobotTree, positions: Mapping[str, Array], stamps: Sequence[Mapping[str, int]]
) -> Iterator[Message]:
    """A TFMessage of the joints that move, for each row."""
    joints = [joint for joint in tree.joints if joint.name in positions]
    placements = [joint.placement(positions[joint.name]) for joint in joints]
    xyz = [placement[:, :3, 3].tolist() for placement in placements]
    turns = [quaternions(placement[:, :3, :3]).tolist() for placement in placements]
    for row, time in enumerate(stamps):
        yield transforms(time, [(joint, xyz[i][row], turns[i][row]) for i, joint in enumerate(joints)])


def transforms(time: Mapping[str, int], placed: Sequence[tuple[Joint, list[float], list[float]]]) -> Message:
    """A TFMessage."""
    return {
        "transforms": [
            {
                "header": {"stamp": time, "frame_id": joint.parent},
                "child_frame_id": joint.child,
                "transform": {"translation": xyz(position), "rotation": xyzw(quaternion)},
            }
            for joint, position, quaternion in placed
        ]
    }


def poses(tree: RobotTree, goal: Goal, stamps: Sequence[Mapping[str, int]]) -> Iterator[Message]:
    """A PoseStamped for each row; a goal that no task turns has no turn."""
    positions = goal.position.tolist()
    still = [[0.0, 0.0, 0.0, 1.0]] * len(positions)
    turns = still if goal.rotation is None else quaternions(goal.rotation).tolist()
    for time, position, turn in zip(stamps, positions, turns, strict=True):
        pose = {"position": xyz(position), "orientation": xyzw(turn)}
        yield {"header": {"stamp": time, "frame_id": tree.root}, "pose": pose}


def diagnostics(run: Run, stamps: Sequence[Mapping[str, int]]) -> Iterator[Message]:
    """A DiagnosticArray for each row: the controller's status, and columns that no other topic carries."""
    columns = [name for name in run.log if name not in ("t", "status") and name[:2] not in ("q.", "v.", "u.")]
    values = np.stack([run.log[name] for name in columns], axis=1).tolist()
    for time, row, status in zip(stamps, values, run.log["status"].tolist(), strict=True):
        entry = {
            "level": level(status),
            "name": "tope",
            "message": status,
            "hardware_id": run.scenario["robot"]["name"],
            "values": [{"key": name, "value": repr(value)} for name, value in zip(columns, row, strict=True)],
        }
        yield {"header": {"stamp": time, "frame_id": ""}, "status": [entry]}


def level(status: str) -> int:
    """How serious a status is."""
    if status == "ok":
        return OK
    return ERROR if SERIOUS & set(status.split("|")) else WARN


def xyz(values: Sequence[float]) -> dict[str, float]:
    """A point or vector."""
    return dict(zip("xyz", values, strict=True))


def xyzw(values: Sequence[float]) -> dict[str, float]:
    """A quaternion."""
    return dict(zip("xyzw", values, strict=True))
