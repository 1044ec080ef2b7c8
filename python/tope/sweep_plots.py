"""Histograms of a sweep as SVG."""

from __future__ import annotations

import io
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tope.sweep_figures import Results, values, violation

Array = NDArray[np.float64]

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999")
BINS = 60
STYLE: Any = {"svg.hashsalt": "tope", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9}


def histograms(results: Results) -> dict[str, str]:
    """Title -> SVG of each distribution that the runs have."""
    drawn = {
        "Distance kept from the nearest limit [m or rad]": {
            variant: -violation(results.of(variant)) for variant in results.campaign.variants
        },
        "Largest jump of a command [share of the bound]": column(results, "max_command_jump"),
        "Largest jumps at dt and at the finer cycle: ratio": column(results, "jump_ratio"),
        **{
            f"Final error of {task} [m or rad]": column(results, f"error.{task}.final")
            for task in results.tasks()
        },
    }
    found = {title: {name: each for name, each in sets.items() if len(each)} for title, sets in drawn.items()}
    return {title: histogram(title, sets) for title, sets in found.items() if sets}


def column(results: Results, name: str) -> dict[str, Array]:
    """A column by variant."""
    return {variant: values(results.of(variant), name) for variant in results.campaign.variants}


def histogram(title: str, sets: dict[str, Array]) -> str:
    """One line a variant; on a logarithmic axis if all values are positive."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 2.8), layout="constrained")
        axes = figure.add_subplot()
        edges = bins(np.concatenate(list(sets.values())), axes)
        for i, (name, found) in enumerate(sets.items()):
            axes.hist(
                found, bins=edges.tolist(), histtype="step", label=name, color=COLOURS[i % len(COLOURS)]
            )
        axes.set(xlabel=title, ylabel="runs")
        axes.spines[["top", "right"]].set_visible(False)
        if len(sets) > 1:
            axes.legend(frameon=False, fontsize=8)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue().partition("<!DOCTYPE")[2].partition(">")[2]


def bins(found: Array, axes: Axes) -> Array:
    """Edges over all that was found, evenly spaced on the axis."""
    low, high = float(found.min()), float(found.max())
    if low <= 0 or high < 10 * low:
        return np.asarray(np.linspace(low, high if high > low else low + 1e-12, BINS + 1))
    axes.set_xscale("log")
    return np.asarray(np.geomspace(max(low, 1e-12 * high), high * (1 + 1e-12), BINS + 1))
