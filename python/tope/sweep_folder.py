"""The folder of a sweep: chunks of done runs, the campaign they belong to, the table they make together."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from tope import _core
from tope.campaign import Campaign
from tope.runs import write_json
from tope.sweep_rows import Chunk, as_parquet

TOLD = 3  # differences that an error lists


class SweepFolder:
    """Where a sweep keeps what it has done."""

    def __init__(self, path: Path, campaign: Campaign) -> None:
        """Make the folder, or go on with one of the same campaign; raises Error if it is of another."""
        self.path = path
        self.parts = path / "parts"
        self.campaign = campaign
        try:
            self.parts.mkdir(parents=True, exist_ok=True)
            self.claim(path / "campaign.json")
        except OSError as error:
            raise _core.Error(f"{path}: cannot write there: {error.strerror}") from error

    def claim(self, file: Path) -> None:
        """Write down what the results depend on, or compare with what is written."""
        content = json.loads(json.dumps(self.campaign.content))
        if not file.exists():
            write_json(file, content)
            return
        there = json.loads(file.read_text(encoding="utf-8"))
        if found := list(differences(there, content)):
            more = f" and {len(found) - TOLD} more" if len(found) > TOLD else ""
            raise _core.Error(
                f"{self.path}: holds runs of another campaign: {'; '.join(found[:TOLD])}{more}. "
                "Give another --out, or remove that folder"
            )

    def file(self, first: int, last: int) -> Path:
        """Of a chunk."""
        return self.parts / f"part-{first:08}-{last:08}.parquet"

    def chunks(self) -> Iterator[tuple[int, int]]:
        """(first, last) run of every chunk of the campaign."""
        size, total = self.campaign.chunk, self.campaign.total
        for first in range(0, total, size):
            yield first, min(first + size, total) - 1

    def missing(self) -> list[tuple[int, int]]:
        """The chunks that are still to be done."""
        return [chunk for chunk in self.chunks() if not self.file(*chunk).exists()]

    def keep(self, chunk: Chunk) -> None:
        """Write a chunk: it is there whole, or not at all."""
        put(self.file(chunk.first, chunk.last), chunk.parquet)
        with (self.path / "timings.csv").open("a", encoding="utf-8") as file:
            if file.tell() == 0:
                file.write("first,last,seconds,worker\n")
            file.write(f"{chunk.first},{chunk.last},{chunk.seconds:.3f},{chunk.worker}\n")

    def table(self) -> pa.Table:
        """All chunks together, written to runs.parquet: the same bytes however they came about."""
        tables = [parquet.read_table(self.file(*chunk)) for chunk in self.chunks()]
        table = pa.concat_tables(tables, promote_options="default")
        put(self.path / "runs.parquet", as_parquet(table))
        return table


def put(file: Path, content: bytes) -> None:
    """Write a file in one step that outlives a kill."""
    partial = file.with_name(file.name + ".part")
    with partial.open("wb") as opened:
        opened.write(content)
        opened.flush()
        os.fsync(opened.fileno())
    partial.replace(file)


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """What has changed, in words."""
    for key in dict.fromkeys((*there, *here)):
        old, new = (json.dumps(each[key]) if key in each else "absent" for each in (there, here))
        if old != new:
            yield f"{key} was {old}, is {new}"
