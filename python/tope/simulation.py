"""Running a scenario, and reading back what a run wrote."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tope import _core
from tope.report import write_run_report
from tope.runs import Log, Run, Summary, finite, write_json

__all__ = ["Run", "load_run", "load_scenario", "simulate"]

Progress = Callable[[float], None]


def simulate(
    scenario: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    report: bool = True,
) -> Run:
    """Run a scenario file to its end.

    `overrides` replaces scenario keys, such as {"dt": 5e-4, "limits.method": "chain"}. `progress` is called
    with the fraction done. With `out`, log.csv, report.html (unless `report` is False) and summary.json are
    written to that folder, the summary last: a folder without one holds an unfinished run.
    """
    loaded = load_scenario(scenario, overrides)
    folder = None if out is None else fresh_folder(out)
    result = _core.simulate(loaded, None if folder is None else str(folder), progress, True)
    run = Run(finite(result["summary"]), log_of(result), folder, np.array(result["cycle_time_us"]))
    if folder is not None:
        if report:
            write_run_report(run, folder / "report.html")
        write_json(folder / "summary.json", run.summary)
    return run


def load_scenario(
    scenario: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None
) -> _core.Scenario:
    """Read a scenario file, with keys replaced as `simulate` does."""
    return _core.load_scenario(os.fspath(scenario), as_text(overrides or {}))


def load_run(folder: str | os.PathLike[str]) -> Run:
    """Read a folder that `simulate` wrote; raises Error if it is broken or the run did not finish."""
    folder = Path(folder)
    run = Run(read_summary(folder / "summary.json"), read_log(folder / "log.csv"), folder)
    for column in promised_columns(run.scenario):
        if column not in run.log:
            raise _core.Error(f"{folder / 'log.csv'}:1: no column '{column}', which the summary promises")
    return run


def promised_columns(scenario: Mapping[str, Any]) -> Iterator[str]:
    """The columns of a scenario's log, but for wheels."""
    for joint in scenario["joints"]:
        yield from (f"{kind}.{joint['name']}" for kind in "qvu")
        yield from (f"xi.{joint['name']}.{side}" for side in ("upper", "lower"))
    for task in scenario["tasks"]:
        yield from (f"e.{task['name']}.{i}" for i in range(task["size"]))
    yield from (f"d.{pair}" for pair in scenario.get("distances", ()))
    yield "scale"


def as_text(overrides: Mapping[str, Any]) -> dict[str, str]:
    """Override values as a scenario file would spell them (JSON is YAML)."""
    return {key: value if isinstance(value, str) else json.dumps(value) for key, value in overrides.items()}


def fresh_folder(out: str | os.PathLike[str]) -> Path:
    """The folder, made if need be, without what an earlier run says about itself."""
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in ("summary.json", "compare.json", "report.html", "log.csv"):
            (folder / name).unlink(missing_ok=True)
    except OSError as error:
        raise _core.Error(f"{folder}: cannot write there: {error.strerror}") from error
    return folder


def log_of(result: Mapping[str, Any]) -> Log:
    """The log's columns by name."""
    log: Log = {name: result["data"][:, i] for i, name in enumerate(result["columns"])}
    log["status"] = np.array(result["status"], dtype=str)
    return log


def read_summary(path: Path) -> Summary:
    """Read summary.json."""
    try:
        summary = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise _core.Error(f"{path}:{error.lineno}: not JSON: {error.msg}") from error
    if not isinstance(summary, dict) or "scenario" not in summary:
        raise _core.Error(f"{path}: not the summary of a run: it has no key 'scenario'")
    for key in ("robot", "joints", "tasks"):
        if key not in summary["scenario"]:
            raise _core.Error(
                f"{path}: not the summary of a run of this version: 'scenario' has no key '{key}'"
            )
    return summary


def read_log(path: Path) -> Log:
    """Read log.csv."""
    header, *rows = read_text(path).splitlines() or [""]
    names = header.split(",")
    if names[0] != "t" or names[-1] != "status":
        raise _core.Error(
            f"{path}:1: not the log of a run: its columns must start with t and end with status"
        )
    cells = [row.split(",") for row in rows]
    for line, row in enumerate(cells, start=2):
        if len(row) != len(names):
            raise _core.Error(f"{path}:{line}: {len(row)} values where the header has {len(names)} columns")
    try:
        data = np.array([row[:-1] for row in cells], dtype=float).reshape(-1, len(names) - 1)
    except ValueError as error:
        raise _core.Error(f"{path}: {error}") from error
    return log_of({"columns": names[:-1], "data": data, "status": [row[-1] for row in cells]})


def read_text(path: Path) -> str:
    """The text of a run's file."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise _core.Error(
            f"{path}: missing: the run did not finish, or this is not the folder of a run"
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise _core.Error(f"{path}: cannot be read: {error}") from error
