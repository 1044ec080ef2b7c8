"""One run of a campaign as one row, and a chunk of runs as the bytes of a Parquet file."""

from __future__ import annotations

import io
import socket
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
from pyarrow import parquet

from tope import _core
from tope.campaign import Campaign
from tope.campaign_file import check_worker
from tope.runs import Summary, finite
from tope.simulation import as_text
from tope.words import nearest_pair, worst

Row = dict[str, Any]

FLAGS = (
    *("ok", "limit", "scaled", "clipped", "singular"),
    *("beyond", "avoiding", "too_near", "held", "near_flip", "cut_off", "bad_input"),
)
FIRST = {"run": pa.int64(), "sample": pa.int64(), "variant": pa.string()}
OUTCOME = {"outcome": pa.string(), "message": pa.string()}
TEXTS = {name: pa.string() for name in ("nearest_joint", "jump_joint", "nearest_pair")}
COUNTS = {name: pa.int64() for name in ("cycles", *(f"cycles.{flag}" for flag in FLAGS))}
KINDS = {"number": pa.float64(), "text": pa.string()}
ROW_GROUP = 65_536


class Chunk(NamedTuple):
    """Done runs, as a worker sends them."""

    first: int
    last: int
    parquet: bytes
    seconds: float
    worker: str


def run_chunk(campaign: Campaign, first: int, last: int) -> Chunk:
    """Run from `first` up to and including `last`, wherever the same files are at the same place."""
    check_worker(campaign)
    begin = time.perf_counter()
    rows = [run_row(campaign, run) for run in range(first, last + 1)]
    written = as_parquet(table_of(campaign, rows))
    return Chunk(first, last, written, time.perf_counter() - begin, socket.gethostname())


def run_row(campaign: Campaign, run: int) -> Row:
    """The row of a run; that its scenario is refused is an outcome too."""
    count = len(campaign.variants)
    row: Row = {"run": run, "sample": run // count, "variant": list(campaign.variants)[run % count]}
    try:
        draw = campaign.draw(run)
        row |= dict(flat(draw.let, "let")) | dict(flat(draw.keys, "set"))
        keys = campaign.overrides(draw)
        return row | {"outcome": "finished"} | measured(campaign, keys)
    except _core.ConfigError as error:
        return row | {"outcome": "refused", "message": portable(campaign, error)}
    except _core.Error as error:
        return row | {"outcome": "failed", "message": portable(campaign, error)}


def measured(campaign: Campaign, keys: Mapping[str, Any]) -> Row:
    """Run the scenario, and once more at a finer cycle if the campaign says so."""
    summary = simulated(campaign.scenario, keys)
    if campaign.refine is None:
        return metrics(summary)
    finer = {**keys, "dt": summary["scenario"]["dt"] / campaign.refine}
    return metrics(summary) | refined(summary, simulated(campaign.scenario, finer))


def simulated(scenario: str, keys: Mapping[str, Any]) -> Summary:
    """The summary of a run."""
    loaded = _core.load_scenario(scenario, as_text(keys))
    summary: Summary = finite(_core.simulate(loaded, None, None, False)["summary"])
    return summary


def metrics(summary: Summary) -> Row:
    """What a row keeps of a summary; nothing that depends on the machine's speed."""
    violation, jump = summary["max_limit_violation"], summary["max_command_jump"]
    counts = summary["status_counts"]
    return {
        "nearest_joint": worst(violation)[0],
        "max_limit_violation": violation["overall"],
        "jump_joint": worst(jump)[0],
        "max_command_jump": jump["overall"],
        "command_variation": summary["command_variation"]["overall"],
        "buffer_time": summary["buffer_time"]["overall"],
        "time_to_goal": summary["time_to_goal"],
        "cycles": summary["cycles"],
        **{f"cycles.{flag}": counts.get(flag, 0) for flag in FLAGS},
        **{
            f"error.{task}.{when}": error[when]
            for task, error in summary["task_error"].items()
            for when in ("final", "at_goal_time")
        },
        **{f"max_limit_violation.{name}": each for name, each in violation.items() if name != "overall"},
        **{f"max_command_jump.{name}": each for name, each in jump.items() if name != "overall"},
        **clearance(summary),
    }


def clearance(summary: Summary) -> Row:
    """The least distance, and of which pair, where distances are kept."""
    if "least_distance" not in summary:
        return {}
    pair, least = nearest_pair(summary)
    return {"nearest_pair": pair, "least_distance": least}


def refined(summary: Summary, fine: Summary) -> Row:
    """How the largest jump of the command fell with the cycle."""
    coarse_jump, fine_jump = (each["max_command_jump"]["overall"] for each in (summary, fine))
    return {
        "fine.max_limit_violation": fine["max_limit_violation"]["overall"],
        "fine.max_command_jump": fine_jump,
        **({"fine.least_distance": fine["least_distance"]["overall"]} if "least_distance" in fine else {}),
        "jump_ratio": coarse_jump / fine_jump if coarse_jump is not None and fine_jump else None,
    }


def portable(campaign: Campaign, error: Exception) -> str:
    """The message without the folders of this machine."""
    text = str(error).replace(campaign.scenario, Path(campaign.scenario).name)
    return text.replace(campaign.file, Path(campaign.file).name)


def flat(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """(dotted path, single value) of all that is inside a value."""
    if isinstance(value, dict | list):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from flat(each, f"{path}.{key}")
    else:
        yield path, value


def table_of(campaign: Campaign, rows: Sequence[Row]) -> pa.Table:
    """The rows under columns whose types the campaign alone decides."""
    drawn = {name: KINDS[kind] for name, kind in campaign.leaves().items()}
    found = dict.fromkeys(name for row in rows for name in row)
    known = FIRST | OUTCOME | TEXTS | COUNTS | drawn
    types = FIRST | OUTCOME | drawn | {name: known.get(name, pa.float64()) for name in found}
    return pa.table({name: column([row.get(name) for row in rows], kind) for name, kind in types.items()})


def column(values: list[Any], kind: pa.DataType) -> pa.Array:
    """Values of one type; a campaign may draw numbers and texts for the same key."""
    if kind == pa.string():
        values = [value if value is None or isinstance(value, str) else str(value) for value in values]
    return pa.array(values, kind)


def as_parquet(table: pa.Table) -> bytes:
    """The same bytes for the same table."""
    buffer = io.BytesIO()
    parquet.write_table(
        table.combine_chunks(), buffer, compression="zstd", row_group_size=ROW_GROUP, version="2.6"
    )
    return buffer.getvalue()
