"""A campaign file (YAML). It has

name, seed, runs    how many draws; draw i depends on the seed and i alone
scenario            the file of the scenario, from the campaign's folder
set                 keys of the scenario (dotted, as of --set) that are the same in every run
let                 named draws that formulas may use
sample              keys of the scenario -> what each is drawn from (tope.distributions), in this order;
                    * in a key stands for joints: initial.*, limits.joints.arm_*.buffer. Formulas know the
                    joint's lower, upper, buffer and bound, and elsewhere all keys drawn or set before
variants            name -> keys; every draw is run once in each
must_keep_limits    variants that a sweep fails for if they cross a limit or touch what they avoid
tables              which figures are told: limits, distances, avoidance, errors, jumps; all by default
refine              also run at this many times shorter a cycle, to tell jumps from slopes
chunk               runs that are done and kept as one
"""

from __future__ import annotations

import hashlib
import os
import socket
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from tope import _core, distributions, yaml_entry
from tope.campaign import Campaign, Rule
from tope.campaign_check import probe
from tope.distributions import Context
from tope.yaml_entry import Entry, Place

KNOWN = (
    *("name", "description", "seed", "runs", "scenario", "set", "let", "sample", "variants"),
    *("must_keep_limits", "tables", "refine", "chunk"),
)
TABLES = ("limits", "distances", "avoidance", "errors", "jumps")
ALONE = "all"  # the variant of a campaign that names none
CHUNK = 100
FILE, BUILD = "file ", "the build of tope"  # what content is called
LONGEST_PATH = 256
DECIDING = ("campaign", "distributions", "expression", "pose", "sweep_rows")  # modules that rows depend on


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


def content_of(entries: Mapping[str, Entry], scenario: Path) -> dict[str, Any]:
    """All that results depend on: a folder of results is gone on with only if none of it changed."""
    content = {key: entries[key].plain() for key in ("seed", "refine") if key in entries}
    for section in ("set", "let", "sample", "variants"):
        for key, entry in read_map(entries, section).items():
            content[f"{section}.{key}"] = entry.plain()
        content[f"order of {section}"] = list(read_map(entries, section))
    sections = [entries[key] for key in ("set", "sample", "variants") if key in entries]
    for file in files_named(scenario, [yaml_entry.read(scenario), *sections]):
        content[f"{FILE}{os.path.relpath(file, scenario.parent)}"] = digest(file)
    return content | {BUILD: build()}


def check_worker(campaign: Campaign) -> None:
    """Raise Error if this machine would compute something else than the one that read the campaign."""
    here = f"the worker {socket.gethostname()}"
    for key, expected in campaign.content.items():
        file = Path(campaign.scenario).parent / key.removeprefix(FILE)
        if key.startswith(FILE) and (not file.is_file() or digest(file) != expected):
            raise _core.Error(
                f"{file}: missing or different on {here}: the same files must be at the same place"
            )
    if build() != campaign.content[BUILD]:
        raise _core.Error(f"{here} has another build of tope than this machine")


def files_named(scenario: Path, entries: Collection[Entry]) -> Iterator[Path]:
    """The scenario's file, and those that it and the campaign refer to."""
    yield scenario
    for leaf in (leaf for entry in entries for leaf in yaml_entry.leaves(entry)):
        text = str(leaf.node.value)
        if "." in text and len(text) < LONGEST_PATH and (scenario.parent / text).is_file():
            yield scenario.parent / text


def digest(*files: Path) -> str:
    """Tells one content of files from another."""
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]


@lru_cache(maxsize=1)
def build() -> str:
    """Tells one version of what draws, runs and measures from another."""
    return digest(Path(_core.__file__), *(Path(__file__).with_name(f"{name}.py") for name in DECIDING))
