"""The same scenario under several ways to keep joint limits, side by side."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tope import _core
from tope.report import write_comparison_report
from tope.runs import Run, Summary, finite, write_json
from tope.simulation import Progress, as_text, fresh_folder, log_of

FINER = 10  # how many times shorter the cycle of the second pass is


@dataclass(frozen=True)
class Contestant:
    """One run of a comparison: its name, its scenario file and the keys set in it."""

    name: str
    scenario: str
    overrides: Mapping[str, str]


def compare(
    scenario: str | os.PathLike[str],
    *,
    limits: Sequence[str] | None = None,
    others: Sequence[str | os.PathLike[str]] = (),
    out: str | os.PathLike[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> dict[str, Run]:
    """Run a scenario once per method of `limits` (all by default), then each of `others` with its own method.

    Every run is made at its dt and again at a tenth of it: summary["jump"] says how the largest jump of the
    command [fraction of the joint's bound] changed. `overrides` holds for every run. Returns the runs by
    method, or by scenario name for the others. With `out`, writes compare.json and report.html there.
    """
    entrants = contestants(
        os.fspath(scenario), limits, [os.fspath(each) for each in others], as_text(overrides or {})
    )
    folder = None if out is None else fresh_folder(out)
    runs = {
        entrant.name: run_twice(entrant, share(progress, i, len(entrants)))
        for i, entrant in enumerate(entrants)
    }
    if folder is not None:
        write_comparison_report(runs, folder / "report.html")
        write_json(folder / "compare.json", {name: run.summary for name, run in runs.items()})
    return runs


def known_methods(names: Sequence[str]) -> Sequence[str]:
    """The names without repeats, if all are methods; raises ConfigError with the nearest right one if not."""
    for name in names:
        if name not in _core.LIMIT_METHODS:
            near = difflib.get_close_matches(name, _core.LIMIT_METHODS, n=1, cutoff=0.0)[0]
            known = ", ".join(_core.LIMIT_METHODS)
            raise _core.ConfigError(f"no method is called '{name}': did you mean '{near}'? There are {known}")
    return list(dict.fromkeys(names))


def contestants(
    scenario: str, limits: Sequence[str] | None, others: Sequence[str], overrides: Mapping[str, str]
) -> list[Contestant]:
    """Who takes part: the scenario under each method, then the other scenarios."""
    methods = known_methods(_core.LIMIT_METHODS if limits is None else limits)
    entrants = [Contestant(method, scenario, {**overrides, "limits.method": method}) for method in methods]
    taken = {entrant.name for entrant in entrants}
    for other in others:
        name = _core.load_scenario(other, dict(overrides)).describe()["name"]
        if name in taken:
            raise _core.ConfigError(
                f"{other}: key 'name': '{name}' is taken by another run of this comparison"
            )
        taken.add(name)
        entrants.append(Contestant(name, other, overrides))
    return entrants


def run_twice(entrant: Contestant, progress: Progress | None) -> Run:
    """The run at its dt, its summary completed with the jump at a tenth of it."""
    loaded = _core.load_scenario(entrant.scenario, dict(entrant.overrides))
    dt = loaded.describe()["dt"]
    part = 1 / (1 + FINER)
    result = _core.simulate(loaded, None, portion(progress, 0, part), True)
    finer = _core.load_scenario(entrant.scenario, {**entrant.overrides, "dt": repr(dt / FINER)})
    fine = _core.simulate(finer, None, portion(progress, part, 1 - part), False)
    run = Run(finite(result["summary"]), log_of(result), cycle_times=np.array(result["cycle_time_us"]))
    return replace(run, summary={**run.summary, "jump": jumps(run.summary, finite(fine["summary"]))})


def jumps(coarse: Summary, fine: Summary) -> dict[str, float | None]:
    """The largest jumps at both cycle times, and their ratio."""
    at_dt, at_fine_dt = coarse["max_command_jump"]["overall"], fine["max_command_jump"]["overall"]
    return {
        "dt": coarse["scenario"]["dt"],
        "fine_dt": fine["scenario"]["dt"],
        "at_dt": at_dt,
        "at_fine_dt": at_fine_dt,
        "ratio": at_dt / at_fine_dt if at_dt is not None and at_fine_dt else None,
    }


def share(progress: Progress | None, index: int, count: int) -> Progress | None:
    """Progress of the index-th of `count` equal parts."""
    return portion(progress, index / count, 1 / count)


def portion(progress: Progress | None, start: float, size: float) -> Progress | None:
    """Progress of a part that begins at `start` and is `size` of the whole."""
    if progress is None:
        return None
    return lambda done: progress(start + size * done)
