"""summary.html: what the runs of a sweep say together, and which of them to look at."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa
from markupsafe import Markup

from tope.campaign import Campaign
from tope.pages import page_template
from tope.sweep_figures import Results, all_figures, count, reasons, verdict, worst_cases
from tope.sweep_plots import histograms


def write_sweep_summary(campaign: Campaign, table: pa.Table, path: Path, command: str) -> None:
    """Fill in the template; `command` made the sweep."""
    results = Results(campaign, table)
    one_run = command.partition(" --runs")[0]  # replays need no number of runs
    page = page_template("sweep.html.j2").render(
        campaign=campaign,
        command=command,
        total=count(len(table)),
        verdict=verdict(results).replace("`", ""),
        figures=all_figures(results),
        plots={title: Markup(svg) for title, svg in histograms(results).items()},
        worst=worst_cases(results, one_run),
        reasons=reasons(results, one_run),
    )
    path.write_text(page, encoding="utf-8")
