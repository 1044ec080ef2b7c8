"""Plots as plain data: what to draw, thinned and packed for the report's page."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tsdownsample import MinMaxLTTBDownsampler, NaNMinMaxLTTBDownsampler

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Series:
    """One curve. `colour` is a place in the page's palette, or "grey" or "ink"."""

    name: str
    colour: int | str
    x: Array
    y: Array
    width: float = 1.6


@dataclass(frozen=True)
class Panel:
    """One plot over time.

    `lines` are horizontal, `marks` vertical (time [s], label), `bands` shaded from one value
    to another. A line stays in view if the curves come within `near` of it. With `rows` the curves are
    strips: their y is the row's number, or NaN for a gap. With `log` the plot can have a logarithmic axis.
    """

    title: str
    unit: str
    series: Sequence[Series]
    note: str = ""
    lines: Sequence[float] = ()
    bands: Sequence[tuple[float, float]] = ()
    marks: Sequence[tuple[float, str]] = ()
    near: float = 0.0
    rows: Sequence[str] = ()
    log: bool = False


@dataclass(frozen=True)
class Section:
    """Panels under one heading; with `pairs` in two columns, where there is room."""

    title: str
    text: str
    panels: Sequence[Panel]
    pairs: bool = False


def packed(panel: Panel, points: int) -> dict[str, Any]:
    """The panel as JSON-able data, each curve thinned to about `points` points."""
    fields = {key: value for key, value in vars(panel).items() if key != "series"}
    return {**fields, "series": [packed_series(each, points, bool(panel.rows)) for each in panel.series]}


def packed_series(series: Series, points: int, whole: bool) -> Mapping[str, Any]:
    """The curve, thinned unless it must stay `whole`."""
    kept = np.arange(len(series.x)) if whole else thin(series.x, series.y, points)
    return {
        "name": series.name,
        "colour": series.colour,
        "width": series.width,
        "x": float32(series.x[kept]),
        "y": float32(series.y[kept]),
    }


def thin(x: Array, y: Array, points: int) -> NDArray[np.intp]:
    """Indices of about `points` values that keep the peaks; the inside of flat stretches goes first."""
    flat = np.zeros(len(y), dtype=bool)
    flat[1:-1] = (y[1:-1] == y[:-2]) & (y[1:-1] == y[2:])
    kept = np.flatnonzero(~flat)
    if len(kept) <= points:
        return kept
    x, y = np.ascontiguousarray(x[kept]), np.where(np.isfinite(y[kept]), y[kept], np.nan)
    sampler = NaNMinMaxLTTBDownsampler if np.isnan(y).any() else MinMaxLTTBDownsampler
    chosen: NDArray[np.uint64] = sampler().downsample(x, y, n_out=points)
    return kept[chosen.astype(np.intp)]


def float32(values: ArrayLike) -> str:
    """The values as base64 of little-endian 32-bit floats."""
    return base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")
