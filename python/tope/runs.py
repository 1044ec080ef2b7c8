"""What a run leaves behind: its summary, its log, and the folder they were written to."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Summary = dict[str, Any]
Log = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Run:
    """A finished simulation.

    `summary` is what summary.json holds. `log` maps a column name to its values, one a logged cycle:
    floats [s, rad, m, rad/s, m/s, Nm, N, 1], except `status`, which holds text. `cycle_times` is how long
    each update of the controller took [us]; it is not written to a file: None for a run read back from one.
    """

    summary: Summary
    log: Log
    out: Path | None = None
    cycle_times: NDArray[np.float64] | None = None

    @property
    def scenario(self) -> dict[str, Any]:
        """The scenario's description, as in summary.json."""
        described: dict[str, Any] = self.summary["scenario"]
        return described

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the logged cycles [s], shape (rows,)."""
        return self.log["t"]


def finite(value: Any) -> Any:
    """The same JSON-able value with None in place of numbers that JSON does not know."""
    if isinstance(value, dict):
        return {key: finite(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_json(path: Path, value: Any) -> None:
    """Write a JSON file in one step: it is there whole, or not at all."""
    partial = path.with_name(path.name + ".part")
    partial.write_text(json.dumps(value, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    partial.replace(path)
