"""A campaign: a scenario, what its runs draw at random, and the variants that each draw is run in."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from tope import _core, distributions
from tope.distributions import Distribution, Leaves
from tope.simulation import as_text
from tope.yaml_entry import Place


@dataclass(frozen=True)
class Rule:
    """A key, or a pattern of keys, and what it is drawn from."""

    key: str
    distribution: Distribution
    place: Place

    def keys(self, joints: Mapping[str, Any]) -> list[tuple[str, str | None]]:
        """The keys that are meant, with the joint of each if the key is a pattern."""
        parts = self.key.split(".")
        patterns = [i for i, part in enumerate(parts) if "*" in part]
        if not patterns:
            return [(self.key, None)]
        i = patterns[0]
        matching = [name for name in joints if fnmatchcase(name, parts[i])]
        if not matching:
            raise self.place.error(f"'{parts[i]}' is no joint; there are {', '.join(joints)}")
        return [(".".join([*parts[:i], name, *parts[i + 1 :]]), name) for name in matching]


class Draw(NamedTuple):
    """What one run is."""

    run: int
    sample: int
    variant: str
    let: dict[str, Any]
    keys: dict[str, Any]  # of the scenario: drawn, or of the variant


@dataclass(frozen=True)
class Campaign:
    """A campaign file."""

    file: str
    name: str
    description: str
    seed: int
    runs: int  # per variant
    scenario: str
    fixed: dict[str, Any]
    let: tuple[Rule, ...]
    sample: tuple[Rule, ...]
    variants: dict[str, tuple[Rule, ...]]
    must_keep_limits: tuple[str, ...]
    tables: tuple[str, ...]
    refine: int | None
    chunk: int
    content: dict[str, Any]  # all that the results depend on, but for the number of runs

    @property
    def total(self) -> int:
        """Runs over all variants."""
        return self.runs * len(self.variants)

    def draw(self, run: int) -> Draw:
        """What run number `run` is, whatever was drawn before; raises ConfigError if it cannot be drawn."""
        sample, number = divmod(run, len(self.variants))
        variant, rules = list(self.variants.items())[number]
        names = dict(self.defaults())
        random = np.random.default_rng([self.seed, sample])
        let: dict[str, Any] = {}
        for rule in self.let:
            let[rule.key] = rule.distribution.draw(random, names)
            names.update(inside(let[rule.key], rule.key))
        keys: dict[str, Any] = {}
        self.follow(self.sample, random, names, keys)
        self.follow(rules, np.random.default_rng([self.seed, sample, 1]), names, keys)
        return Draw(run, sample, variant, let, keys)

    def follow(
        self,
        rules: tuple[Rule, ...],
        random: np.random.Generator,
        names: dict[str, Any],
        keys: dict[str, Any],
    ) -> None:
        """Draw a section of the file, in its order."""
        for rule in rules:
            joints = self.joints(keys) if "*" in rule.key else {}
            drawn = limits_of(joints) | dict(
                each for key, value in keys.items() for each in inside(value, key)
            )
            for key, joint in rule.keys(joints):
                local = {} if joint is None else distributions.joint_figures(joint, drawn)
                keys[key] = rule.distribution.draw(random, {**names, **local})
                names.update(inside(keys[key], key))

    def overrides(self, draw: Draw) -> dict[str, Any]:
        """The scenario's keys of a run."""
        return {**self.fixed, **draw.keys}

    def joints(self, keys: Mapping[str, Any]) -> dict[str, Any]:
        """The joints of the scenario's robot, by name; a campaign may draw the robot."""
        robot = {key: value for key, value in keys.items() if key.split(".")[0] == "robot"}
        return described_joints(self.scenario, as_items(self.fixed | robot))

    def defaults(self) -> dict[str, Any]:
        """Names that formulas know from the start."""
        return base_figures(self.scenario, as_items(self.fixed)) | self.fixed

    def leaves(self) -> Leaves:
        """Every single value that a run may draw: column -> what stands there."""
        found: Leaves = {}
        for prefix, rules in (
            ("let", self.let),
            ("set", self.sample),
            *(("set", v) for v in self.variants.values()),
        ):
            for rule in rules:
                for key, _ in rule.keys(self.joints({})):
                    distributions.merge(found, distributions.below({f"{prefix}.{key}": rule.distribution}))
        return found


def inside(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """A value and those in it, by the names that formulas have for them."""
    yield name, value
    if isinstance(value, dict):
        for key, each in value.items():
            yield from inside(each, f"{name}.{key}")


def limits_of(joints: Mapping[str, Any]) -> dict[str, float]:
    """The limits of joints under the names that formulas have for them."""
    absent = {"lower": -math.inf, "upper": math.inf, "buffer": math.inf, "bound": math.inf}
    return {
        f"limits.joints.{name}.{what}": otherwise if joint[what] is None else joint[what]
        for name, joint in joints.items()
        for what, otherwise in absent.items()
    }


def as_items(keys: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Overrides as text that can be compared."""
    return tuple(sorted(as_text(keys).items()))


@lru_cache(maxsize=256)
def described_joints(scenario: str, overrides: tuple[tuple[str, str], ...]) -> dict[str, Any]:
    """The joints of a scenario by name."""
    described = _core.load_scenario(scenario, dict(overrides)).describe()
    return {joint["name"]: joint for joint in described["joints"]}


@lru_cache(maxsize=16)
def base_figures(scenario: str, overrides: tuple[tuple[str, str], ...]) -> dict[str, float]:
    """What formulas know of a scenario: its cycle, its duration and its joints' limits."""
    described = _core.load_scenario(scenario, dict(overrides)).describe()
    own = {"dt": described["dt"], "duration": described["duration"]}
    return own | limits_of(described_joints(scenario, overrides))
