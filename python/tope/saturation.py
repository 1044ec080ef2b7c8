"""What was saturated in a run, and when: limits that acted, bounds that were met, flags that were raised."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tope.panels import Array
from tope.runs import Run
from tope.words import number, percent

Mask = NDArray[np.bool_]

TOLD_APART = 0.01  # of the run: stretches with a shorter gap are told as one
MOST_STRETCHES = 3  # told of one thing
AT_BOUND = 0.995  # of a bound: met
FLAGS = {  # those that limits and scale do not tell
    "clipped": "The limits alone asked for more than a bound, and were clipped",
    "singular": "A task direction was nearly lost, and damped",
    "beyond": "A joint was beyond its limit, and led back",
    "avoiding": "A distance to an obstacle or the robot itself shaped the command",
    "too_near": "A distance was below its margin, and led back",
    "held": "A task with a promised time was held back, so that the promise was void",
    "near_flip": "An orientation error was near half a turn, where its direction flips",
    "cut_off": "The solver was cut off: limits held, tasks were served less well",
    "bad_input": "The state was not finite: no motion was commanded",
}


def saturation(run: Run) -> list[str]:
    """A sentence for each limit that acted, for the bounds that slowed the tasks, and for each other flag."""
    if len(run.time) == 0:
        return []
    return [*limits_at_work(run), *slowed(run), *flagged(run)]


def limits_at_work(run: Run) -> Iterator[str]:
    """Which limits shaped the command."""
    for joint in run.scenario["joints"]:
        for side in ("upper", "lower"):
            activation = run.log[f"xi.{joint['name']}.{side}"]
            if np.any(activation > 0):
                most = percent(float(activation.max()))
                when = told(run.time, activation > 0)
                yield f"The {side} limit of {joint['name']} acted {when}, by up to {most}"


def slowed(run: Run) -> Iterator[str]:
    """When all tasks were slowed so that no bound was broken."""
    scale = run.log["scale"]
    below = scale < 1
    if np.any(below):
        who = ", ".join(joints_at_bound(run, below)) or "the wheels"
        least = percent(float(scale.min()))
        yield f"The tasks were slowed by the bound of {who} {told(run.time, below)}, to {least}"


def joints_at_bound(run: Run, cycles: Mask) -> Iterator[str]:
    """The joints whose command met its bound in some of these cycles."""
    for joint in run.scenario["joints"]:
        command = np.abs(run.log[f"u.{joint['name']}"][cycles])
        if joint["bound"] is not None and np.any(command >= AT_BOUND * joint["bound"]):
            yield str(joint["name"])


def flagged(run: Run) -> Iterator[str]:
    """The other things that the controller reported."""
    for flag, raised in flags_of(run):
        if flag in FLAGS:
            yield f"{FLAGS[flag]} {told(run.time, raised)}"


def flags_of(run: Run) -> Iterable[tuple[str, Mask]]:
    """Each status flag other than ok, with the cycles that raised it."""
    texts, which = np.unique(run.log["status"], return_inverse=True)
    split = [text.split("|") for text in texts]
    for flag in sorted({flag for flags in split for flag in flags} - {"ok", ""}):
        yield flag, np.array([flag in flags for flags in split])[which]


def told(t: Array, raised: Mask) -> str:
    """When something held, in words."""
    starts, ends = stretches(t, raised, TOLD_APART * (t[-1] - t[0]))
    if len(starts) == 1 and starts[0] == t[0] and ends[0] == t[-1]:
        return "all the time"
    parts = [stretch(t, *each) for each in zip(starts[:MOST_STRETCHES], ends, strict=False)]
    more = len(starts) - MOST_STRETCHES
    return " and ".join(parts) + (
        f" and {more} more times, the last at {number(ends[-1], 's')}" if more > 0 else ""
    )


def stretch(t: Array, start: float, end: float) -> str:
    """One stretch in words."""
    if end == t[-1]:
        return f"from {number(start, 's')} to the end"
    if end - start < TOLD_APART * (t[-1] - t[0]):
        return f"at {number(start, 's')}"
    return f"from {number(start, 's')} to {number(end, 's')}"


def stretches(t: Array, raised: Mask, apart: float) -> tuple[Array, Array]:
    """Starts and ends [s] of the stretches in which something held; a gap up to `apart` [s] is none."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], raised, [False]))))
    starts, ends = t[edges[::2]], t[np.minimum(edges[1::2], len(t) - 1)]
    new = np.concatenate(([True], starts[1:] - ends[:-1] > apart))
    last = np.append(np.flatnonzero(new)[1:] - 1, len(ends) - 1)
    return starts[new], ends[last]


def distances(summary: Mapping[str, Any]) -> list[tuple[str, str, float]]:
    """Each limited joint with the distance kept in words and as a share of its buffer, the nearest first."""
    found = [
        (joint["name"], -summary["max_limit_violation"][joint["name"]], joint)
        for joint in summary["scenario"]["joints"]
        if summary["max_limit_violation"].get(joint["name"]) is not None
    ]
    ordered = sorted(found, key=lambda each: each[1])
    return [(name, number(kept, joint["unit"]), kept / joint["buffer"]) for name, kept, joint in ordered]
