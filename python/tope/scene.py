"""What a run looks like in space: the robot, how it moves, its goals, and what is in its way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tope.panels import Array, float32
from tope.runs import Run
from tope.urdf import Colour, Joint, RobotTree, Visual, quaternions, robot_tree, rotations

RATE = 100.0  # frames of the replay in a second, at most
MOST_FRAMES = 3001  # of one run, so that the page of a long run stays small
KERB = (0.05, 1.1, 0.045)  # depth, width and height of an obstacle on the floor [m]
OBSTACLE: Colour = (0.75, 0.25, 0.2)
STILL = 1e-6  # a goal that moves less is sent once [m, 1]


@dataclass(frozen=True)
class Goal:
    """Where tasks want a frame over time: positions (rows, 3) [m], rotations (rows, 3, 3) or None."""

    frame: str
    position: Array
    rotation: Array | None


def read_tree(run: Run) -> RobotTree:
    """The robot of a run; raises Error if its URDF is gone."""
    return robot_tree(run.scenario["robot"])


def sampled(run: Run, columns: Sequence[str], times: Array) -> Array:
    """Columns of the log at other times (rows, columns), linear in between."""
    return np.stack([np.interp(times, run.time, run.log[column]) for column in columns], axis=1)


def joint_positions(run: Run, times: Array) -> dict[str, Array]:
    """Positions (rows,) of all joints that are not at 0: those of the log, and those held fixed."""
    names = [joint["name"] for joint in run.scenario["joints"]]
    moving = sampled(run, [f"q.{name}" for name in names], times)
    held = run.scenario["robot"]["locked_joints"]
    return {
        **{name: moving[:, i] for i, name in enumerate(names)},
        **{name: np.full(len(times), position) for name, position in held.items()},
    }


def goals(tree: RobotTree, run: Run, placements: Mapping[str, Array], times: Array) -> list[Goal]:
    """The goal of every frame that tasks are about.

    It follows from where the frame is and the task's error: p_goal = p - e, R_goal = R exp(-e). So a goal
    that moves does so here. What no task asks for is as the frame itself.
    """
    found: dict[str, Goal] = {}
    for task in run.scenario["tasks"]:
        frame = task["frame"]
        if frame is None:
            continue
        error = sampled(run, [f"e.{task['name']}.{i}" for i in range(task["size"])], times)
        here = placements[tree.link_of(frame)]
        goal = found.get(frame, Goal(frame, here[:, :3, 3], None))
        position, rotation = goal.position, goal.rotation
        if task["type"] in ("frame_position", "frame_pose"):
            position = here[:, :3, 3] - error[:, :3]
        if task["type"] in ("frame_orientation", "frame_pose"):
            rotation = here[:, :3, :3] @ rotations(-error[:, -3:])
        found[frame] = Goal(frame, position, rotation)
    return list(found.values())


def scene(runs: Mapping[str, Run]) -> dict[str, Any] | None:
    """The scene of runs of one robot as JSON-able data; None if the robots differ or a run has no rows."""
    described = [run.scenario for run in runs.values()]
    first = described[0]
    alike = all(
        each["robot"] == first["robot"] and len(each["joints"]) == len(first["joints"]) for each in described
    )
    if not alike or any(len(run.time) == 0 for run in runs.values()):
        return None
    tree = robot_tree(first["robot"])
    bodies = [shape for obstacle in first.get("obstacles", ()) for shape in obstacle_shapes(obstacle)]
    return {
        "joints": [joint["name"] for joint in first["joints"]],
        "links": [link_data(tree, link, bodies if link == tree.root else ()) for link in tree.links],
        "tree": [joint_data(joint, first["robot"]["locked_joints"]) for joint in tree.joints],
        "meshes": tree.meshes,
        "obstacles": list(obstacles(tree, first["joints"])),
        "runs": [replay(tree, run) for run in runs.values()],
    }


def replay(tree: RobotTree, run: Run) -> dict[str, Any]:
    """How a run moves the robot, in evenly spaced frames."""
    start, end = run.time[0], run.time[-1]
    frames = min(MOST_FRAMES, int(np.ceil((end - start) * RATE)) + 1)
    times = np.linspace(start, end, frames)
    names = [joint["name"] for joint in run.scenario["joints"]]
    placements = tree.placements(joint_positions(run, times), frames)
    aims = goals(tree, run, placements, times)
    upper = sampled(run, [f"xi.{name}.upper" for name in names], times)
    lower = sampled(run, [f"xi.{name}.lower" for name in names], times)
    return {
        "frames": frames,
        "step": float(times[1] - times[0]) if frames > 1 else 0.0,
        "positions": float32(sampled(run, [f"q.{name}" for name in names], times)),
        "activations": float32(np.where(upper >= lower, upper, -lower)),
        "goals": [goal_data(goal) for goal in aims],
        "trace": float32(placements[tree.link_of(aims[0].frame)][:, :3, 3]) if aims else "",
    }


def goal_data(goal: Goal) -> dict[str, Any]:
    """A goal as JSON-able data."""
    rotation = None if goal.rotation is None else quaternions(goal.rotation)
    return {
        "frame": goal.frame,
        "position": float32(once_if_still(goal.position)),
        "quaternion": None if rotation is None else float32(once_if_still(rotation)),
    }


def once_if_still(rows: Array) -> Array:
    """The first row alone if all are the same."""
    return rows[:1] if np.all(np.abs(rows - rows[0]) < STILL) else rows


def obstacle_shapes(obstacle: Mapping[str, Any]) -> Iterator[Visual]:
    """What shows an obstacle; nothing for a half-space or a convex hull."""
    w, x, y, z = obstacle["quaternion"]
    angle = 2 * np.arctan2(np.linalg.norm((x, y, z)), w)
    axis = np.array((x, y, z)) / max(float(np.linalg.norm((x, y, z))), 1e-12)
    placement = np.eye(4)
    placement[:3, :3] = rotations((angle * axis)[None])[0]
    placement[:3, 3] = obstacle["position"]
    if obstacle["type"] == "box":
        yield Visual("box", tuple(obstacle["size"]), placement, OBSTACLE)
    if obstacle["type"] == "sphere":
        yield Visual("sphere", (obstacle["radius"],), placement, OBSTACLE)
    if obstacle["type"] in ("cylinder", "capsule"):
        yield Visual("cylinder", (obstacle["radius"], obstacle["length"]), placement, OBSTACLE)
    if obstacle["type"] == "capsule":
        for end in (-0.5, 0.5):
            tip = placement.copy()
            tip[:3, 3] += end * obstacle["length"] * placement[:3, 2]
            yield Visual("sphere", (obstacle["radius"],), tip, OBSTACLE)


def link_data(tree: RobotTree, link: str, more: Sequence[Visual] = ()) -> dict[str, Any]:
    """A link, its shapes, and more that it carries."""
    visuals = [
        {
            "shape": visual.shape,
            "size": visual.size,
            **placement_data(visual.link_T_shape),
            "colour": visual.colour,
        }
        for visual in (*tree.visuals.get(link, ()), *more)
    ]
    return {"name": link, "visuals": visuals}


def joint_data(joint: Joint, locked: Mapping[str, float]) -> dict[str, Any]:
    """A joint and where it hangs."""
    return {
        "name": joint.name,
        "type": joint.type,
        "parent": joint.parent,
        "child": joint.child,
        **placement_data(joint.parent_T_joint),
        "axis": joint.axis.tolist(),
        "locked": locked.get(joint.name, 0.0),
    }


def placement_data(placement: Array) -> dict[str, Any]:
    """A placement (4, 4) as position and quaternion x, y, z, w."""
    return {
        "xyz": placement[:3, 3].tolist(),
        "quaternion": quaternions(placement[None, :3, :3])[0].tolist(),
    }


def obstacles(tree: RobotTree, described: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """What stands in the robot's way: limits of a sliding base that are tighter than the robot's own.

    Such a limit is drawn as a kerb where the first shape that the joint moves would touch it.
    """
    for joint in sliding_base(tree):
        limits = next((each for each in described if each["name"] == joint.name), None)
        if limits is None or abs(joint.axis[2]) > 0.5:
            continue
        for side, sign in (("lower", -1.0), ("upper", 1.0)):
            own, limit = getattr(joint, side), limits[side]
            if limit is None or (own is not None and sign * limit >= sign * own):
                continue
            yield {
                "joint": joint.name,
                "side": side,
                "limit": limit,
                "direction": (sign * joint.axis).tolist(),
                "label": f"stops {joint.name} at {limit:g} m",
                **kerb(sign * joint.axis, sign * limit + reach(tree, joint, sign * joint.axis)),
            }


def sliding_base(tree: RobotTree) -> list[Joint]:
    """The prismatic joints that no turning joint carries."""
    sliding: list[Joint] = []
    standing = {tree.root}
    for joint in tree.joints:
        if joint.parent in standing and joint.type in ("fixed", "prismatic"):
            standing.add(joint.child)
            if joint.type == "prismatic":
                sliding.append(joint)
    return sliding


def kerb(direction: Array, distance: float) -> dict[str, Any]:
    """A low box on the floor whose near face is `distance` [m] along a horizontal direction."""
    depth, width, height = KERB
    along_x = abs(direction[0]) > 0.5
    centre = (distance + depth / 2) * direction
    return {
        "size": [depth, width, height] if along_x else [width, depth, height],
        "xyz": [float(centre[0]), float(centre[1]), height / 2],
    }


def reach(tree: RobotTree, joint: Joint, direction: Array) -> float:
    """How far the first shapes that a joint moves stand out from it in a direction [m]."""
    placements = tree.placements({}, 1)
    start = placements[joint.child][0, :3, 3]
    extents = [
        float(direction @ (placement[:3, 3] - start)) + half_extent(visual.shape, visual.size, local)
        for link in tree.first_shapes(joint.child)
        for visual in tree.visuals[link]
        for placement in [placements[link][0] @ visual.link_T_shape]
        for local in [placement[:3, :3].T @ direction]
    ]
    return max(extents, default=0.0)


def half_extent(shape: str, size: Sequence[float], direction: Array) -> float:
    """How far a shape reaches from its centre in a direction of its own frame [m]."""
    if shape == "box":
        return float(np.abs(direction) @ np.array(size)) / 2
    if shape == "sphere":
        return size[0]
    return float(size[0] * np.hypot(direction[0], direction[1]) + size[1] / 2 * abs(direction[2]))
