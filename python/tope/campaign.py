"""A campaign: a scenario, what its runs draw at random, and the variants that each draw is run in.

A campaign file (YAML) has
    name, seed, runs    how many draws; draw i depends on the seed and i alone
    scenario            the file of the scenario, from the campaign's folder
    set                 keys of the scenario (dotted, as of --set) that are the same in every run
    let                 named draws that formulas may use
    sample              keys of the scenario -> what each is drawn from (tope.distributions), in this order;
                        * in a key stands for joints: initial.*, limits.joints.arm_*.buffer. Formulas know the
                        joint's lower, upper, buffer and bound, and elsewhere all keys drawn or set before
    variants            name -> keys; every draw is run once in each
    must_keep_limits    variants that a sweep fails for if they cross a limit
    tables              which figures are told: limits, distances, errors, jumps; all by default
    refine              also run at this many times shorter a cycle, to tell jumps from slopes
    chunk               runs that are done and kept as one
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tope import _core, distributions, yaml_entry
from tope.distributions import Context, Distribution, Leaves
from tope.simulation import as_text
from tope.yaml_entry import Entry, Place

KNOWN = (
    *("name", "description", "seed", "runs", "scenario", "set", "let", "sample", "variants"),
    *("must_keep_limits", "tables", "refine", "chunk"),
)
TABLES = ("limits", "distances", "errors", "jumps")
ALONE = "all"  # the variant of a campaign that names none
CHUNK = 100
PROBES = 20  # draws that are read at once, to tell a mistake from a draw out of range


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
                local = {} if joint is None else joint_figures(joint, drawn)
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


def joint_figures(name: str, names: Mapping[str, Any]) -> dict[str, float]:
    """What formulas know of the joint that a pattern stands for: its limits as drawn, if they were."""
    return {what: names[f"limits.joints.{name}.{what}"] for what in ("lower", "upper", "buffer", "bound")}


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


def load_campaign(file: str | os.PathLike[str], runs: int | None = None) -> Campaign:
    """Read a campaign file; `runs` replaces its number of runs. Raises ConfigError with the place."""
    campaign = read_campaign(yaml_entry.read(file))
    if runs is not None:
        campaign = replace(campaign, runs=runs)
    probe(campaign)
    return campaign


def read_campaign(top: Entry) -> Campaign:
    """From the map at the top of the file."""
    entries = top.entries()
    for key, entry in entries.items():
        if key not in KNOWN:
            entry.fail(f"unknown key{yaml_entry.hint(key, KNOWN)}")
    for key in ("name", "seed", "runs", "scenario"):
        if key not in entries:
            raise Place(top.place.file, top.place.line, key).error("is missing")
    scenario = Path(top.place.file).parent / entries["scenario"].text()
    if not scenario.is_file():
        entries["scenario"].fail(f"no such file: {scenario}")
    fixed = entries["set"].plain() if read_map(entries, "set") else {}
    context = Context(os.path.abspath(scenario), fixed, {})
    let = read_rules(read_map(entries, "let"), context)
    refuse_patterns(let)
    context = replace(context, known={rule.key: rule.distribution for rule in let})
    variants = {
        name: read_rules(each.entries(), context) for name, each in read_map(entries, "variants").items()
    } or {ALONE: ()}
    chunk = entries["chunk"].whole(1) if "chunk" in entries else CHUNK
    return Campaign(
        file=top.place.file,
        name=entries["name"].text(),
        description=entries["description"].text().strip() if "description" in entries else "",
        seed=entries["seed"].whole(0),
        runs=entries["runs"].whole(1),
        scenario=context.scenario,
        fixed=fixed,
        let=let,
        sample=read_rules(read_map(entries, "sample"), context),
        variants=variants,
        must_keep_limits=read_names(entries, "must_keep_limits", variants),
        tables=read_names(entries, "tables", TABLES) or TABLES,
        refine=entries["refine"].whole(2) if "refine" in entries else None,
        chunk=chunk,
        content=content_of(entries, scenario) | {"chunk": chunk},
    )


def read_map(entries: Mapping[str, Entry], key: str) -> dict[str, Entry]:
    """The entries of a section; none if it is absent."""
    return entries[key].entries() if key in entries else {}


def read_rules(section: Mapping[str, Entry], context: Context) -> tuple[Rule, ...]:
    """What a section draws; a formula may name what stands before it there."""
    rules: list[Rule] = []
    for key, entry in section.items():
        known = {**context.known, **{rule.key: rule.distribution for rule in rules}}
        distribution = distributions.read(entry, replace(context, known=known))
        rules.append(Rule(key, distribution, entry.place))
    return tuple(rules)


def refuse_patterns(let: tuple[Rule, ...]) -> None:
    """A named draw is one value."""
    for rule in let:
        if not rule.key.isidentifier():
            raise rule.place.error("expected a name of letters, digits and _")


def read_names(entries: Mapping[str, Entry], key: str, known: Collection[str]) -> tuple[str, ...]:
    """A list of names; none if it is absent."""
    if key not in entries:
        return ()
    for each in entries[key].items():
        if each.text() not in known:
            each.fail(f"nothing is called '{each.text()}'{yaml_entry.hint(each.text(), known)}")
    return tuple(each.text() for each in entries[key].items())


def probe(campaign: Campaign) -> None:
    """Raise ConfigError if none of a variant's first runs can be read: that is a mistake, not bad luck."""
    if (wrong := blamed(campaign, campaign.fixed, next(iter(campaign.variants)))) is not None:
        raise wrong
    count = len(campaign.variants)
    for number in range(count):
        errors = []
        for sample in range(min(PROBES, campaign.runs)):
            error = mistake(campaign, sample * count + number)
            if error is None:
                break
            errors.append(error)
        else:
            raise errors[0]
    campaign.leaves()


def mistake(campaign: Campaign, run: int) -> _core.ConfigError | None:
    """What is wrong with the keys of a run, told at the line of the key that is to blame."""
    try:
        draw = campaign.draw(run)
    except _core.ConfigError as error:
        return error
    return blamed(campaign, campaign.overrides(draw), draw.variant)


def blamed(campaign: Campaign, keys: Mapping[str, Any], variant: str) -> _core.ConfigError | None:
    """The error of reading the scenario with these keys, at the key without which it can be read."""
    refused = refusal(campaign, keys)
    if refused is None:
        return None
    for key in keys:
        if refusal(campaign, {other: value for other, value in keys.items() if other != key}) is None:
            return place_of(campaign, key, variant).error(f"{told(keys[key])}{refused}")
    return Place(campaign.file, 1, "scenario").error(str(refused))


def told(value: Any) -> str:
    """The value that a scenario's error does not quote itself."""
    return "" if isinstance(value, dict | list) else f"{value}: "


def refusal(campaign: Campaign, keys: Mapping[str, Any]) -> _core.ConfigError | None:
    """The error of reading the scenario with these keys."""
    try:
        _core.load_scenario(campaign.scenario, as_text(keys))
    except _core.ConfigError as error:
        return error
    return None


def place_of(campaign: Campaign, key: str, variant: str) -> Place:
    """Where a key was given."""
    if key in campaign.fixed:
        return yaml_entry.read(campaign.file).entries()["set"].entries()[key].place
    for rule in (*campaign.variants[variant], *campaign.sample):
        if any(key == each for each, _ in rule.keys(campaign.joints({}))):
            return rule.place
    raise AssertionError(key)


def content_of(entries: Mapping[str, Entry], scenario: Path) -> dict[str, Any]:
    """All that results depend on: a folder of results is gone on with only if none of it changed."""
    content = {key: entries[key].plain() for key in ("seed", "refine") if key in entries}
    for section in ("set", "let", "sample", "variants"):
        for key, entry in read_map(entries, section).items():
            content[f"{section}.{key}"] = entry.plain()
        content[f"order of {section}"] = list(read_map(entries, section))
    for file in (scenario, *files_named(scenario)):
        content[f"file {file.name}"] = digest(file)
    return content | {"the tope library": library()}


def files_named(scenario: Path) -> Iterator[Path]:
    """The files that a scenario refers to."""
    for leaf in yaml_entry.leaves(yaml_entry.read(scenario)):
        text = str(leaf.node.value)
        if "." in text and len(text) < 256 and (scenario.parent / text).is_file():
            yield scenario.parent / text


def digest(file: Path) -> str:
    """Tells one content of a file from another."""
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16]


@lru_cache(maxsize=1)
def library() -> str:
    """Tells one build of the library from another."""
    return digest(Path(_core.__file__))
