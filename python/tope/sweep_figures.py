"""What the runs of a sweep say together: tables for the terminal, the page and the documentation."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from tope import _core
from tope.campaign import Campaign
from tope.words import percent

Array = NDArray[np.float64]

OUTCOMES = ("finished", "refused", "failed")
QUANTILES = (0.0, 0.001, 0.01, 0.1, 0.5, 0.9)  # of the distance kept
CONTINUOUS = 8.0  # of the largest jumps at dt and dt / 10: from here on a command counts as continuous
WORST = 5  # listed of each kind and variant
REASONS = 10  # listed


@dataclass(frozen=True)
class Figures:
    """A table, and what is to be known to read it."""

    title: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""


@dataclass(frozen=True)
class WorstCase:
    """A run that stands out."""

    run: int
    variant: str
    figure: str
    command: str


@dataclass(frozen=True)
class Results:
    """The runs of a sweep by variant."""

    campaign: Campaign
    table: pa.Table

    def of(self, variant: str) -> pa.Table:
        """The finished runs of a variant."""
        return self.where(variant, "finished")

    def where(self, variant: str, outcome: str) -> pa.Table:
        """The runs of a variant with one outcome."""
        return self.split[variant, outcome]

    @cached_property
    def split(self) -> dict[tuple[str, str], pa.Table]:
        """The runs by variant and outcome."""
        variants, outcomes = self.column("variant"), self.column("outcome")
        return {
            (variant, outcome): self.table.filter(pa.array((variants == variant) & (outcomes == outcome)))
            for variant in self.campaign.variants
            for outcome in OUTCOMES
        }

    def column(self, name: str) -> NDArray[Any]:
        """A column of all runs."""
        return np.asarray(self.table.column(name).to_numpy())

    def tasks(self) -> list[str]:
        """The tasks that the runs have an error of; damping is no goal."""
        names = [name.split(".")[1] for name in self.table.column_names if name.startswith("error.")]
        return [name for name in dict.fromkeys(names) if name != "damping"]

    def crossed(self, variant: str) -> int:
        """How many runs of a variant crossed a limit, or touched what they keep a distance to."""
        done = self.of(variant)
        return int(np.sum((violation(done) > 0) | (least_distance(done) <= 0)))


def values(table: pa.Table, name: str) -> Array:
    """A column without what is absent; none if there is no such column."""
    if name not in table.column_names:
        return np.array([])
    found = table.column(name).to_numpy().astype(float)
    return np.asarray(found[~np.isnan(found)])


def violation(table: pa.Table) -> Array:
    """How far each run went beyond a limit [rad or m], at dt and, if there is one, at the finer cycle."""
    coarse = table.column("max_limit_violation").to_numpy().astype(float)
    if "fine.max_limit_violation" not in table.column_names:
        return np.asarray(coarse)
    return np.asarray(np.fmax(coarse, table.column("fine.max_limit_violation").to_numpy().astype(float)))


def least_distance(table: pa.Table) -> Array:
    """The least distance of each run [m], as `violation` finds it; infinite where none is kept."""
    names = [name for name in ("least_distance", "fine.least_distance") if name in table.column_names]
    found = [table.column(name).to_numpy().astype(float) for name in names]
    return np.asarray(np.fmin.reduce([*found, np.full(len(table), np.inf)]))


def all_figures(results: Results) -> list[Figures]:
    """Every table."""
    makers = {
        "limits": limits,
        "distances": distances,
        "avoidance": avoidance,
        "errors": errors,
        "jumps": jumps,
    }
    tables = [makers[name](results) for name in results.campaign.tables]
    return [each for each in tables if each.rows]


def limits(results: Results) -> Figures:
    """Were limits kept?"""
    rows = [limits_row(results, variant) for variant in results.campaign.variants]
    header = (
        "variant",
        "runs",
        "refused",
        "failed",
        "entered a buffer",
        "crossed a limit",
        "least distance kept",
    )
    note = (
        "Counts of runs; distances in mm or mrad, of the joint that came nearest to one of its limits. "
        "Clipped: the limits alone asked for more than a bound. Cut off: the solver stopped early."
    )
    return Figures("Limits", (*header, "clipped", "cut off"), rows, note)


def limits_row(results: Results, variant: str) -> list[str]:
    """One variant; counts are of runs."""
    done = results.of(variant)
    off = violation(done)
    return [
        variant,
        count(len(done)),
        count(len(results.where(variant, "refused"))),
        count(len(results.where(variant, "failed"))),
        count(np.sum(values(done, "buffer_time") > 0)),
        count(results.crossed(variant)),
        distance(-np.nanmax(off)) if len(off) else "–",
        *(count(np.sum(values(done, f"cycles.{flag}") > 0)) for flag in ("clipped", "cut_off")),
    ]


def distances(results: Results) -> Figures:
    """How the distance kept is distributed."""
    header = ("variant", "least", "0.1 %", "1 %", "10 %", "median", "90 %")
    rows = [
        [variant, *(distance(each) for each in np.quantile(-violation(results.of(variant)), QUANTILES))]
        for variant in results.campaign.variants
        if len(results.of(variant))
    ]
    note = "In mm or mrad. So many of the runs kept no more than this; negative: crossed by."
    return Figures("Distance kept from the nearest limit", header, rows, note)


def avoidance(results: Results) -> Figures:
    """Were distances kept?"""
    header = ("variant", "avoided something", "touched something", "least", "0.1 %", "1 %", "10 %", "median")
    rows = [
        [
            variant,
            count(np.sum(values(done, "cycles.avoiding") > 0)),
            count(np.sum(kept <= 0)),
            *(millimetres(each) for each in np.quantile(kept, QUANTILES[: len(header) - 3])),
        ]
        for variant in results.campaign.variants
        for done in [results.of(variant)]
        for kept in [least_distance(done)]
        if np.any(np.isfinite(kept))
    ]
    note = (
        "Counts of runs; the least distance [mm] between a sphere of the robot and a body, and so many of "
        "the runs kept no more than this; negative: penetration."
    )
    return Figures("Distance kept from obstacles and itself", header, rows, note)


def millimetres(value: float) -> str:
    """A length [m] in mm."""
    return f"{1e3 * value:.3g}"


def errors(results: Results) -> Figures:
    """Final errors of the tasks, and at the time that a task was promised for."""
    rows = []
    for task in results.tasks():
        for variant in results.campaign.variants:
            done = results.of(variant)
            for when, told in (("at_goal_time", "at the promised time"), ("final", "at the end")):
                found = values(done, f"error.{task}.{when}")
                if len(found):
                    rows.append(
                        [task, variant, told, *quantiles(found), percent(float(np.mean(found < 1e-3)))]
                    )
    header = ("task", "variant", "error", "median", "90 %", "largest", "below 1e-3")
    return Figures("Errors of the tasks", header, rows, "In m or rad. Goals may be out of reach.")


def quantiles(found: Array) -> list[str]:
    """Median, 90 % and most."""
    return [f"{each:.2e}" for each in np.quantile(found, (0.5, 0.9, 1.0))]


def jumps(results: Results) -> Figures:
    """The largest change of a command between two cycles."""
    refine = results.campaign.refine
    header = ["variant", "median", "99 %", "largest"]
    more = (
        []
        if refine is None
        else [f"ratio at dt, dt/{refine} ≥ {CONTINUOUS:g}", "median ratio", "least ratio"]
    )
    rows = [jump_row(results, variant) for variant in results.campaign.variants if len(results.of(variant))]
    note = "In % of the joint's bound. It falls with dt if the command is continuous."
    return Figures("Largest jump of a command", [*header, *more], rows, note)


def jump_row(results: Results, variant: str) -> list[str]:
    """One variant."""
    done = results.of(variant)
    cells = [
        variant,
        *(percent(float(each)) for each in np.quantile(values(done, "max_command_jump"), (0.5, 0.99, 1))),
    ]
    if results.campaign.refine is None:
        return cells
    ratios = values(done, "jump_ratio")
    smooth = f"{count(np.sum(ratios >= CONTINUOUS))} of {count(len(ratios))}"
    return [
        *cells,
        smooth,
        *((f"{np.median(ratios):.3g}", f"{ratios.min():.3g}") if len(ratios) else ("–", "–")),
    ]


def verdict(results: Results) -> str:
    """What the runs say about the promise to keep limits."""
    promised = results.campaign.must_keep_limits
    if not promised:
        return ""
    runs = [len(results.of(variant)) for variant in promised]
    crossed = sum(results.crossed(variant) for variant in promised)
    names = ", ".join(f"`{variant}`" for variant in promised)
    said = f"{count(crossed)} of {count(sum(runs))} runs of {names} crossed a limit."
    if crossed or min(runs) < 3:
        return said
    rare = count(min(runs) // 3)
    return f"{said} At 95 % confidence fewer than one in {rare} of each does (rule of three)."


def worst_cases(results: Results, command: str) -> dict[str, list[WorstCase]]:
    """Runs to look at, of each kind the worst of each variant first."""
    kinds = {
        "Nearest to a limit, or farthest beyond one": ("max_limit_violation", told_distance),
        "Largest jump of a command": ("max_command_jump", told_jump),
        **{
            f"Largest final error of {task}": (
                f"error.{task}.final",
                lambda row, value: f"{value:.3g} m or rad",
            )
            for task in results.tasks()
        },
    }
    found = {
        kind: [
            case
            for variant in results.campaign.variants
            for case in worst(results, variant, name, told, command)
        ]
        for kind, (name, told) in kinds.items()
    }
    return {kind: cases for kind, cases in found.items() if cases}


def worst(results: Results, variant: str, name: str, told: Any, command: str) -> Iterator[WorstCase]:
    """The runs of a variant with the largest figures in a column."""
    done = results.of(variant)
    if name not in done.column_names:
        return
    figures = done.column(name).to_numpy().astype(float)
    order = np.argsort(np.where(np.isnan(figures), np.inf, -figures), kind="stable")[:WORST]
    for i in order:
        if not np.isnan(figures[i]):
            row = done.slice(int(i), 1).to_pylist()[0]
            yield WorstCase(
                row["run"], variant, told(row, float(figures[i])), f"{command} --replay {row['run']}"
            )


def told_distance(row: Mapping[str, Any], value: float) -> str:
    """Which joint came how near."""
    words = "kept" if value <= 0 else "crossed by"
    return f"{words} {distance(abs(value))} mm or mrad, {row['nearest_joint']}"


def told_jump(row: Mapping[str, Any], value: float) -> str:
    """Which joint's command jumped by how much."""
    return f"{percent(value)}, {row['jump_joint']}"


def reasons(results: Results, command: str) -> list[tuple[str, str, str, str]]:
    """Why runs were refused or failed: (outcome, how many, the first one's message, its command)."""
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    lost = results.table.select(["run", "outcome", "message"]).filter(
        pa.array(results.column("outcome") != "finished")
    )
    for row in lost.to_pylist():
        groups.setdefault((row["outcome"], re.sub(r"[-+.\d]+(e-?\d+)?", "#", row["message"])), []).append(row)
    ordered = sorted(groups.items(), key=lambda each: -len(each[1]))[:REASONS]
    return [
        (outcome, count(len(rows)), rows[0]["message"], f"{command} --replay {rows[0]['run']}")
        for (outcome, _), rows in ordered
    ]


def count(value: Any) -> str:
    """A whole number with its thousands set apart."""
    return f"{int(value):,}"


def distance(value: float) -> str:
    """A distance in mm or mrad, to three digits."""
    return f"{1e3 * value:.3g}" if np.isfinite(value) else "–"


def markdown(results: Results, command: str) -> str:
    """The tables for a document."""
    about = f"`{command}`, seed {results.campaign.seed}: {count(len(results.table))} runs."
    parts = [f"{about} {verdict(results)}".rstrip()]
    for each in all_figures(results):
        lines = [each.header, ["---"] * len(each.header), *each.rows]
        table = "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
        parts.append(f"**{each.title}.** {each.note}\n\n{table}")
    return "\n\n".join(parts)


class Mark:
    """Where the tables of a campaign go in a document."""

    END = "<!-- end of tope sweep -->"

    def __init__(self, campaign_file: str) -> None:
        """A campaign is known by its file's name."""
        self.begin = f"<!-- tope sweep {campaign_file.rsplit('/', maxsplit=1)[-1]} -->"

    def check(self, name: str, text: str) -> None:
        """Raise Error if a document has no place for the tables."""
        if self.END not in text.partition(self.begin)[2]:
            raise _core.Error(
                f"{name}: no place for the tables: it needs a line '{self.begin}', later '{self.END}'"
            )

    def put(self, text: str, tables: str) -> str:
        """The document with new tables."""
        before, _, rest = text.partition(self.begin)
        after = rest.partition(self.END)[2]
        return f"{before}{self.begin}\n\n{tables}\n\n{self.END}{after}"
