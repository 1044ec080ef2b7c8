"""A run in the formats of the field's viewers."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tope import _core
from tope.runs import Run
from tope.simulation import load_run


@dataclass(frozen=True)
class Format:
    """What a format is called, how its files end, and the module whose `write(run, file)` knows it."""

    name: str
    suffix: str
    module: str


FORMATS = {
    each.name: each
    for each in (
        Format("mcap", ".mcap", "tope.export_mcap"),
        Format("rerun", ".rrd", "tope.export_rerun"),
    )
}


def export(folder: str | os.PathLike[str], *, to: str, out: str | os.PathLike[str] | None = None) -> Path:
    """Write the run in `folder` as "mcap" or "rerun", to run.mcap or run.rrd in it, or to `out`.

    Returns the file. Raises Error for a broken run, an unknown format, a missing package or a file that
    cannot be written; then there is no file.
    """
    if to not in FORMATS:
        raise _core.ConfigError(f"no format is called '{to}': there are {', '.join(FORMATS)}")
    run = load_run(folder)
    if len(run.time) == 0:
        raise _core.Error(f"{folder}: the log has no rows: there is nothing to export")
    file = Path(folder) / f"run{FORMATS[to].suffix}" if out is None else Path(out)
    partial = file.with_name(file.name + ".part")
    try:
        writer_of(FORMATS[to])(run, partial)
        partial.replace(file)
    except OSError as error:
        raise _core.Error(f"{file}: cannot be written: {error.strerror}") from error
    finally:
        partial.unlink(missing_ok=True)
    return file


def writer_of(wanted: Format) -> Callable[[Run, Path], None]:
    """The function that writes a format."""
    try:
        write: Callable[[Run, Path], None] = importlib.import_module(wanted.module).write
    except ModuleNotFoundError as error:
        raise _core.Error(
            f"exporting to {wanted.name} needs the package {error.name}: install tope[export]"
        ) from error
    return write
