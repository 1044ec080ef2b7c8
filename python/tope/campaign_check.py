"""Mistakes in a campaign that only reading its scenario shows, told at the campaign's line."""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from typing import Any

from tope import _core, yaml_entry
from tope.campaign import Campaign
from tope.simulation import as_text
from tope.yaml_entry import Place

PROBES = 20  # draws that are read at once, to tell a mistake from a draw out of range


def probe(campaign: Campaign) -> None:
    """Raise ConfigError if none of a variant's first runs can be read: that is a mistake, not bad luck."""
    if (wrong := blamed(campaign, campaign.fixed, next(iter(campaign.variants)))) is not None:
        raise wrong
    count = len(campaign.variants)
    for number in range(count):
        errors = []
        for sample in range(PROBES):
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
        if fnmatchcase(key, rule.key):
            return rule.place
    raise AssertionError(key)
