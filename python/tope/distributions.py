"""What a campaign file may draw a value from.

0.1                                         the same in every run; so are lists and maps of such
{uniform: [a, b]}, {log_uniform: [a, b]}    a number between a and b, which may be formulas
{integer: [a, b]}                           a whole number, both ends included
{choice: [x, y, ...]}                       one of several values, each as likely
{rotation: uniform}                         a unit quaternion (w, x, y, z)
{rotation: {within: angle, of: [w, x, y, z]}}   one that is up to an angle [rad] away from another
{value: formula}                            what follows from what was drawn before
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any, Literal, Protocol

import numpy as np

from tope import _core
from tope.expression import Expression, Names
from tope.pose import pose
from tope.yaml_entry import Entry, hint

Kind = Literal["number", "text"]
Leaves = dict[str, Kind]  # dotted path below the value -> what stands there


class Distribution(Protocol):
    """Something to draw from."""

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """A value."""

    def leaves(self) -> Leaves:
        """The single values in what is drawn."""


@dataclass(frozen=True)
class Constant:
    """One value."""

    value: Any

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """The value."""
        return self.value

    def leaves(self) -> Leaves:
        """One."""
        is_number = isinstance(self.value, int | float) and not isinstance(self.value, bool)
        return {"": "number" if is_number else "text"}


@dataclass(frozen=True)
class MapOf:
    """A map whose values are drawn."""

    entries: Mapping[str, Distribution]

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """One of each."""
        return {key: each.draw(random, names) for key, each in self.entries.items()}

    def leaves(self) -> Leaves:
        """Of all."""
        return below(self.entries)


@dataclass(frozen=True)
class ListOf:
    """A list whose items are drawn."""

    items: tuple[Distribution, ...]

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """One of each."""
        return [each.draw(random, names) for each in self.items]

    def leaves(self) -> Leaves:
        """Of all."""
        return below({str(i): each for i, each in enumerate(self.items)})


@dataclass(frozen=True)
class Uniform:
    """A number between two, or its logarithm between theirs."""

    low: Expression
    high: Expression
    logarithmic: bool = False

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """A number."""
        low, high = self.low.number(names), self.high.number(names)
        self.check(low, high)
        if self.logarithmic:
            return float(low * (high / low) ** random.random())
        return float(random.uniform(low, high))

    def check(self, low: float, high: float) -> None:
        """Raise ConfigError if nothing is between the ends."""
        if low > high:
            raise self.high.place.error(f"{high:g} is below the other end, {low:g}")
        if self.logarithmic and low <= 0:
            raise self.low.place.error(f"a logarithm needs a positive number, got {low:g}")

    def leaves(self) -> Leaves:
        """One number."""
        return {"": "number"}


@dataclass(frozen=True)
class Integer:
    """A whole number between two, both included."""

    low: Expression
    high: Expression

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """A whole number."""
        low, high = self.low.number(names), self.high.number(names)
        if math.floor(high) < math.ceil(low):
            raise self.high.place.error(f"no whole number lies between {low:g} and {high:g}")
        return int(random.integers(math.ceil(low), math.floor(high), endpoint=True))

    def leaves(self) -> Leaves:
        """One number."""
        return {"": "number"}


@dataclass(frozen=True)
class Choice:
    """One of several."""

    options: tuple[Distribution, ...]

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """From one option."""
        return self.options[int(random.integers(len(self.options)))].draw(random, names)

    def leaves(self) -> Leaves:
        """Of any option."""
        merged: Leaves = {}
        for option in self.options:
            merge(merged, option.leaves())
        return merged


@dataclass(frozen=True)
class Rotation:
    """A unit quaternion (w, x, y, z), up to an angle away from another or uniform among all."""

    within: Expression | None = None
    of: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """A quaternion."""
        direction = random.standard_normal(4 if self.within is None else 3)
        direction /= np.linalg.norm(direction)
        if self.within is None:
            return [float(each) for each in direction]
        half = 0.5 * random.uniform(0.0, self.within.number(names))
        turned = product([math.cos(half), *(math.sin(half) * direction)], self.of)
        return [float(each) for each in turned / np.linalg.norm(turned)]

    def leaves(self) -> Leaves:
        """Four numbers."""
        return {str(i): "number" for i in range(4)}


@dataclass(frozen=True)
class Value:
    """What a formula gives."""

    formula: Expression
    of: Leaves | None  # of what it names, if it is a single name

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """The value."""
        return self.formula.value(names)

    def leaves(self) -> Leaves:
        """As what it names; a number otherwise."""
        return {"": "number"} if self.of is None else self.of


@dataclass(frozen=True)
class PoseOf:
    """Where a frame is at joint positions that are drawn, the others being at 0; a `*` stands for joints."""

    scenario: str
    fixed: Mapping[str, Any]
    frame: str
    joints: Mapping[str, Distribution]

    def draw(self, random: np.random.Generator, names: Names) -> Any:
        """Position and quaternion."""
        drawn: dict[str, float] = {}
        for pattern, each in self.joints.items():
            if "*" in pattern:
                for joint in matching_joints(pattern, names):
                    drawn[joint] = each.draw(random, {**names, **joint_figures(joint, names)})
            else:
                drawn[pattern] = each.draw(random, names)
        return pose(self.scenario, self.fixed, self.frame, drawn)

    def leaves(self) -> Leaves:
        """Three and four numbers."""
        sizes = {"position": 3, "quaternion": 4}
        return {f"{what}.{i}": "number" for what, size in sizes.items() for i in range(size)}


def matching_joints(pattern: str, names: Names) -> list[str]:
    """The joints that a pattern stands for; raises ConfigError if there is none."""
    keys = (name.split(".") for name in names)
    joints = [key[2] for key in keys if key[:2] == ["limits", "joints"] and key[3:] == ["lower"]]
    matching = [joint for joint in joints if fnmatchcase(joint, pattern)]
    if not matching:
        raise _core.ConfigError(f"pose: '{pattern}' is no joint; there are {', '.join(joints)}")
    return matching


def joint_figures(name: str, names: Names) -> dict[str, float]:
    """What formulas know of the joint that a pattern stands for: its limits as drawn, if they were."""
    return {what: names[f"limits.joints.{name}.{what}"] for what in ("lower", "upper", "buffer", "bound")}


@dataclass(frozen=True)
class Context:
    """What a distribution may refer to."""

    scenario: str
    fixed: Mapping[str, Any]
    known: Mapping[str, Distribution]

    def named(self, name: str) -> Leaves | None:
        """The single values in what a formula calls so; None if that is unknown or a number."""
        for key, each in self.known.items():
            if name == key:
                return each.leaves()
            if name.startswith(f"{key}."):
                within = f"{name.removeprefix(f'{key}.')}."
                found = {
                    f"{path}.".removeprefix(within)[:-1]: kind
                    for path, kind in each.leaves().items()
                    if f"{path}.".startswith(within)
                }
                return found or None
        return None


def below(entries: Mapping[str, Distribution]) -> Leaves:
    """The leaves of several, each path behind its key."""
    return {
        f"{key}.{path}".rstrip("."): kind
        for key, each in entries.items()
        for path, kind in each.leaves().items()
    }


def merge(into: Leaves, more: Leaves) -> None:
    """Add leaves; what is a number here and a text there is kept as text."""
    for path, kind in more.items():
        into[path] = kind if into.get(path, kind) == kind else "text"


def product(a: Any, b: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Of two quaternions (w, x, y, z): first b, then a in the fixed frame."""
    scalar = a[0] * b[0] - np.dot(a[1:], b[1:])
    vector = a[0] * np.asarray(b[1:]) + b[0] * np.asarray(a[1:]) + np.cross(a[1:], b[1:])
    return np.array([scalar, *vector])


def read(entry: Entry, context: Context) -> Distribution:
    """A distribution from a file."""
    if entry.is_list:
        return ListOf(tuple(read(each, context) for each in entry.items()))
    if not entry.is_map:
        return Constant(entry.plain())
    entries = entry.entries()
    if len(entries) == 1:
        (name, argument), *_ = entries.items()
        if name in READERS:
            return READERS[name](argument, context)
        if hint(name, READERS).startswith("; did"):
            argument.fail(f"unknown distribution{hint(name, READERS)}")
    return MapOf({key: read(each, context) for key, each in entries.items()})


def read_ends(entry: Entry) -> tuple[Expression, Expression]:
    """The two ends of an interval."""
    items = entry.items()
    if len(items) != 2:
        entry.fail(f"expected the two ends of an interval, [a, b], got {len(items)} values")
    return Expression.read(items[0]), Expression.read(items[1])


def read_uniform(entry: Entry, logarithmic: bool) -> Distribution:
    """Checked at once if both ends are constant."""
    uniform = Uniform(*read_ends(entry), logarithmic=logarithmic)
    low, high = uniform.low.constant, uniform.high.constant
    if low is not None and high is not None:
        uniform.check(low, high)
    return uniform


def read_choice(entry: Entry, context: Context) -> Distribution:
    """At least one option."""
    options = tuple(read(each, context) for each in entry.items())
    if not options:
        entry.fail("expected at least one value to choose from")
    return Choice(options)


def read_rotation(entry: Entry, context: Context) -> Distribution:
    """Uniform, or near another."""
    if not entry.is_map:
        if entry.plain() != "uniform":
            entry.fail(f"expected uniform or {{within: angle, of: [w, x, y, z]}}, got {entry.told()}")
        return Rotation()
    entries = entry.entries()
    for key, each in entries.items():
        if key not in ("within", "of"):
            each.fail(f"unknown key{hint(key, ('within', 'of'))}")
    if "within" not in entries:
        entry.fail("'within', an angle [rad], is missing")
    of = entries["of"].plain() if "of" in entries else [1.0, 0.0, 0.0, 0.0]
    if not is_quaternion(of):
        entries["of"].fail(f"expected a unit quaternion [w, x, y, z], got {of}")
    return Rotation(Expression.read(entries["within"]), tuple(float(each) for each in of))


def is_quaternion(value: Any) -> bool:
    """Whether these are four numbers whose norm is nearly one."""
    if not isinstance(value, list) or len(value) != 4 or any(isinstance(each, str) for each in value):
        return False
    return abs(math.hypot(*value) - 1.0) < 1e-2


def read_value(entry: Entry, context: Context) -> Distribution:
    """A formula."""
    formula = Expression.read(entry)
    return Value(formula, context.named(formula.text.strip()))


def read_pose(entry: Entry, context: Context) -> Distribution:
    """A frame and joints."""
    entries = entry.entries()
    for key, each in entries.items():
        if key not in ("frame", "joints"):
            each.fail(f"unknown key{hint(key, ('frame', 'joints'))}")
    for key in ("frame", "joints"):
        if key not in entries:
            entry.fail(f"'{key}' is missing")
    joints = {name: read(each, context) for name, each in entries["joints"].entries().items()}
    return PoseOf(context.scenario, context.fixed, entries["frame"].text(), joints)


READERS: dict[str, Callable[[Entry, Context], Distribution]] = {
    "uniform": lambda entry, context: read_uniform(entry, logarithmic=False),
    "log_uniform": lambda entry, context: read_uniform(entry, logarithmic=True),
    "integer": lambda entry, context: Integer(*read_ends(entry)),
    "choice": read_choice,
    "rotation": read_rotation,
    "value": read_value,
    "pose": read_pose,
}
