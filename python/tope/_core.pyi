"""C++ core of tope"""

from collections.abc import Callable, Mapping, Sequence
import os
from typing import Annotated

import numpy
from numpy.typing import NDArray


class Error(RuntimeError):
    pass

class ConfigError(Error):
    pass

class Robot:
    """A robot of revolute, continuous and prismatic joints, and its bounds."""

    @staticmethod
    def from_urdf(urdf: str | os.PathLike, config: str | os.PathLike | None = None) -> Robot:
        """Reads a URDF and, if given, the robot's YAML file."""

    @property
    def name(self) -> str: ...

    @property
    def nq(self) -> int: ...

    @property
    def nv(self) -> int: ...

    @property
    def joint_names(self) -> list[str]: ...

    @property
    def position_lower(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Lower position limits (nv) [rad or m]."""

    @position_lower.setter
    def position_lower(self, arg: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], /) -> None: ...

    @property
    def position_upper(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Upper position limits (nv) [rad or m]."""

    @position_upper.setter
    def position_upper(self, arg: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], /) -> None: ...

    @property
    def velocity_limit(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Speed bounds (nv) [rad/s or m/s]."""

    @velocity_limit.setter
    def velocity_limit(self, arg: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], /) -> None: ...

    @property
    def effort_limit(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Torque or force bounds (nv) [Nm or N]."""

    @effort_limit.setter
    def effort_limit(self, arg: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], /) -> None: ...

    def __repr__(self) -> str: ...

class PointPath:
    """
    A target that passes points at given times, smoothly in velocity and acceleration.
    """

    def __init__(self, times: Sequence[float], points: Sequence) -> None:
        """
        Times [s] that rise, and a point [m] for each; at rest before and after.
        """

    def at(self, t: float) -> tuple:
        """Position [m], velocity [m/s] and acceleration [m/s2] at a time [s]."""

class RotationPath:
    """
    A target that passes rotations at given times, smoothly in velocity and acceleration.
    """

    def __init__(self, times: Sequence[float], rotations: Sequence) -> None:
        """
        Times [s] that rise, and a rotation for each, a matrix or a quaternion (w, x, y, z); at rest before and after.
        """

    def at(self, t: float) -> tuple:
        """
        Rotation, angular velocity [rad/s] and acceleration [rad/s2] at a time [s], along fixed axes.
        """

class PointStream:
    """
    A target that comes in samples from outside the control loop, from another thread for example. It goes on with a sample's velocity for up to `hold` seconds, then stops; a filter with a triple pole at -`rate` [1/s] makes it smooth.
    """

    def __init__(self, start: object, *, rate: float = 20.0, hold: float = 0.1) -> None:
        """Rests at `start` [m] until the first sample."""

    def put(self, time: float, position: object, velocity: object = (0.0, 0.0, 0.0)) -> bool:
        """
        A sample of that time [s, on the clock of Controller.update], position [m] and velocity [m/s]. False, and nothing changes, for what is not finite or no later than the one before.
        """

class RotationStream:
    """
    The same as PointStream for a rotation, a matrix or a quaternion (w, x, y, z).
    """

    def __init__(self, start: object, *, rate: float = 20.0, hold: float = 0.1) -> None:
        """Rests at `start` until the first sample."""

    def put(self, time: float, rotation: object, angular_velocity: object = (0.0, 0.0, 0.0)) -> bool:
        """
        A sample of that time [s, on the clock of Controller.update], rotation and angular velocity along the world's axes [rad/s]. False, and nothing changes, for what is not finite, no rotation, or no later than the one before.
        """

class Exponential:
    """Exponential convergence: rate = -gain error."""

    def __init__(self, *, gain: float = 2.0) -> None: ...

class PredefinedTime:
    """Convergence at a stated time after the first update."""

    def __init__(self, duration: float, *, gain: float = 2.0, replan_over: float = 0.0) -> None:
        """
        `replan_over` [s]: least time of the plan made anew after something held the task back; 0: none is made.
        """

class Task:
    """A goal; a controller makes it its own."""

    def __repr__(self) -> str: ...

def FramePosition(*, frame: str, target: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Brings the origin of a frame to a point [m], or to where a PointPath, a PointStream or a function t -> (point, velocity) moves it.
    """

def FrameOrientation(*, frame: str, target: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Turns a frame as a 3 x 3 matrix or a quaternion (w, x, y, z) says, or as a function t -> (rotation, angular velocity) turns.
    """

def FramePose(*, frame: str, position: object, rotation: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """Position and orientation of a frame as one task of six rows."""

def Pointing(*, frame: str, axis: object, target: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Points an axis of a frame, given along the frame's axes, at a point [m], or at where a function t -> (point, velocity) moves it.
    """

def CenterOfMass(*, target: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Brings the robot's centre of mass to a point [m], or to where a function t -> (point, velocity) moves it.
    """

def RelativePose(*, frame: str, seen_from: str, position: object | None = None, rotation: object | None = None, reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Position, rotation or both of a frame as another frame of the robot sees it, along that one's axes.
    """

def Manipulability(*, frame: str, target: float, rows: Sequence[int] = [0, 1, 2, 3, 4, 5], joints: Sequence[str] = [], reference: Exponential | PredefinedTime = ...) -> Task:
    """
    Brings the manipulability sqrt(det(J J^T)) of a frame to a target; of some rows of its Jacobian (0 to 2: position, 3 to 5: rotation) and of some joints' columns, if named.
    """

def JointGroup(task: Task, *, joints: Sequence[str]) -> Task:
    """
    A task served by some joints alone. What the others do disturbs it; feedback alone answers that.
    """

def SelectedRows(task: Task, *, rows: Sequence[int]) -> Task:
    """
    A task with some of its rows alone, counted from 0: 2 is the height of a position.
    """

def Posture(*, target: object, reference: Exponential | PredefinedTime = ...) -> Task:
    """Draws all joints towards a posture (nq)."""

def JointPosition(*, target: Mapping[str, float], reference: Exponential | PredefinedTime = ...) -> Task:
    """Brings named joints to given positions."""

def Damping() -> Task:
    """Brings every joint to rest, as far as higher levels leave it free."""

class Sphere:
    """A ball [m]."""

    def __init__(self, *, radius: float) -> None: ...

class Box:
    """A box, with its full lengths along x, y, z [m]."""

    def __init__(self, *, size: object) -> None: ...

class Capsule:
    """All within a radius of a segment of a length along z [m]."""

    def __init__(self, *, radius: float, length: float) -> None: ...

class Cylinder:
    """A cylinder along z [m]."""

    def __init__(self, *, radius: float, length: float) -> None: ...

class HalfSpace:
    """All points with z <= 0: a floor or a wall."""

    def __init__(self) -> None: ...

class ConvexHull:
    """The convex hull of points [m]."""

    def __init__(self, *, points: object) -> None: ...

    @staticmethod
    def of_mesh(file: str | os.PathLike) -> ConvexHull:
        """Of the vertices of a mesh file, in metres."""

class CollisionSphere:
    """A ball that covers part of the robot."""

    def __init__(self, name: str, *, frame: str, center: object, radius: float) -> None: ...

class CollisionBody:
    """
    A convex body that spheres keep clear of: an obstacle, or a part of the robot.
    """

    def __init__(self, name: str, shape: Sphere | Box | Capsule | Cylinder | HalfSpace | ConvexHull, *, position: object = (0.0, 0.0, 0.0), rotation: object = (1.0, 0.0, 0.0, 0.0), frame: str = '') -> None:
        """Without a frame the world carries it."""

class CollisionOptions:
    """Distances to keep."""

    def __init__(self, *, bodies: Sequence[CollisionBody] = [], spheres: Sequence[CollisionSphere] = [], exclude: Sequence[tuple[str, str]] = [], margin: float = 0.01, gain: float | None = None, servo_gain: float | None = None) -> None:
        """
        Beside the robot's own spheres and bodies; `exclude` has (sphere or frame, body) pairs.
        """

class Smoothing:
    """
    The mean of `solutions` commands whose headrooms are between the first and `1 + spread` times that: weaker kinks where bounds become active, at so many times the cost.
    """

    def __init__(self, *, solutions: int = 3, spread: float = 3.0) -> None: ...

class UnilateralOptions:
    """Parameters of the method `unilateral`."""

    def __init__(self, *, damping: float | None = None, fine_damping: float | None = None, fine_below: float | None = None, lock: float | None = None, headroom: float | None = None, free_headroom: float | None = None, inequality_headroom: float | None = None, softness: float | None = None, smoothing: Smoothing | None = None) -> None:
        """What is None is chosen for the mode and the robot; no smoothing."""

class PotentialFieldOptions:
    """Parameters of the method `potential_field`."""

    def __init__(self, *, joints: Sequence[str] = [], influence: float = 0.1, strength: float = 0.05) -> None: ...

class LimitOptions:
    """How joint limits are met."""

    def __init__(self, *, method: str = 'unilateral', buffer: float = 0.1, gain: float | None = None, margin: float = 0.001, ramp: str = 'raised_cosine', buffers: Mapping[str, float] = {}, gains: Mapping[str, float] = {}, servo_gain: float | None = None, lambda_p: float | None = None, lambda_v: float | None = None, measure: str = 'predicted', unilateral: UnilateralOptions = ..., potential_field: PotentialFieldOptions = ..., collisions: CollisionOptions | None = None, enforce_conditions: bool = True) -> None: ...

class Status:
    """What acted in one cycle."""

    @property
    def ok(self) -> bool: ...

    @property
    def events(self) -> list[str]: ...

    @property
    def scale(self) -> float: ...

    @property
    def laws(self) -> int: ...

    def __str__(self) -> str: ...

class TaskHandle:
    """Names a task inside the controller that returned it."""

class Controller:
    """Serves tasks in strict order of priority and keeps joint limits."""

    def __init__(self, robot: Robot, *, mode: str, dt: float, limits: LimitOptions = ..., joint_weights: Sequence[float] = [], null_space: str = 'compensated', midpoint: bool = True, wheel_distribution: str = 'minimum_norm') -> None:
        """Takes a copy of the robot with its bounds as they are."""

    def add(self, task: Task, *, level: int, over: float = 0.0) -> TaskHandle:
        """Adds a task; `over` seconds let it fade in."""

    def remove(self, handle: TaskHandle, *, over: float = 0.0) -> None:
        """Removes a task; `over` seconds let it fade out."""

    def move(self, handle: TaskHandle, *, level: int, over: float = 0.0) -> None:
        """
        Moves a task to another level, in `over` seconds; it is complete all the while.
        """

    def replace(self, handle: TaskHandle, task: Task, *, over: float = 0.0) -> None:
        """
        Puts another task in the place of one, in `over` seconds: with another target for example.
        """

    def move_limits(self, joint: str, *, lower: float, upper: float, lower_rate: float = 0.0, upper_rate: float = 0.0) -> None:
        """
        Moves a joint's limits [rad or m] from the next update on; the rates [rad/s or m/s] say how they go on.
        """

    def move_obstacle(self, body: str, *, position: object, rotation: object = (1.0, 0.0, 0.0, 0.0), velocity: object = (0.0, 0.0, 0.0), angular_velocity: object = (0.0, 0.0, 0.0)) -> None:
        """
        Moves an obstacle [m] from the next update on; its velocities [m/s, rad/s] say how it goes on.
        """

    def update(self, q: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], v: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')], t: float) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]:
        """One cycle: the command (nv) at state q (nq), v (nv) and time t [s]."""

    def error(self, handle: TaskHandle) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]:
        """Error of a task as of the last update."""

    @property
    def status(self) -> Status: ...

    @property
    def limit_gains(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]:
        """
        Gain of each joint's limits (nv) [1/s]: as given, or as chosen for the mode and its drive.
        """

    @property
    def status_text(self) -> str: ...

    @property
    def activations(self) -> dict[str, float]:
        """How active each limit is, 0 to 1, by 'joint.side'."""

    @property
    def distances(self) -> dict[str, float]:
        """
        Distance [m] of each pair that is kept apart, by 'sphere.body', as of the last update.
        """

LIMIT_METHODS: tuple = ...

class Scenario:
    """A complete experiment as a YAML file tells it."""

    def describe(self) -> dict: ...

    def controller(self) -> Controller:
        """A controller as the scenario describes it, with its tasks."""

    @property
    def initial(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

def load_scenario(path: str | os.PathLike, overrides: Mapping[str, str] = {}) -> Scenario: ...

def simulate(scenario: Scenario, out: str | os.PathLike | None = None, progress: Callable[[float], None] | None = None, keep_log: bool = True) -> dict: ...

def check(scenario: Scenario) -> list: ...

def benchmark(scenario: Scenario, acting: int = -1, cycles: int = 200000) -> dict: ...

class LiveSimulation:
    """
    A scenario that never ends and that can be changed while it runs. For one thread.
    """

    def __init__(self, scenario: Scenario) -> None: ...

    def advance(self, seconds: float) -> None:
        """
        Runs the cycles that fit into so many seconds and what an earlier call left over.
        """

    def put_goal(self, frame: str, position: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], wxyz: Sequence[float]) -> None:
        """Puts the goal of a frame to a position [m] and a unit quaternion."""

    def adopt(self, scenario: Scenario) -> None:
        """
        Goes on under another reading of the same scenario file; ConfigError leaves all as it was.
        """

    def insert(self, task: str, *, over: float) -> None:
        """Adds a task that was removed, over so many seconds."""

    def remove(self, task: str, *, over: float) -> None:
        """Removes a task, over so many seconds."""

    @property
    def time(self) -> float: ...

    @property
    def position(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

    @property
    def command(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

    @property
    def upper_activation(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

    @property
    def lower_activation(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C')]: ...

    @property
    def status(self) -> str: ...

    @property
    def status_text(self) -> str: ...

    @property
    def limit_gain(self) -> float:
        """
        The least gain of the joints' limits [1/s], chosen by the controller if the scenario does not say.
        """

    @property
    def errors(self) -> dict:
        """
        Norm of each task's error [m or rad]; None for a task that is not present.
        """

    @property
    def goals(self) -> dict[str, tuple[Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], list[float]]]:
        """Position [m] and quaternion (w, x, y, z) of the goal of each frame."""
