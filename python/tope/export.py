"""A run in the formats of the field's viewers."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from tope import _core, extras
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
        extras.load(FORMATS[to].module, f"exporting to {to}", "export").write(run, partial)
        partial.replace(file)
    except OSError as error:
        raise _core.Error(f"{file}: cannot be written: {error.strerror}") from error
    finally:
        partial.unlink(missing_ok=True)
    return file
