"""What a cycle costs, beside the bare rigid-body terms of the same robot and mode in the same run."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tope import _core
from tope.simulation import Progress, load_scenario

FOLDER = Path(__file__).parents[2] / "bench"
CASES: Sequence[tuple[str, int]] = (("unilateral", 0), ("unilateral", 3), ("chain", 0), ("chain", 2))
HEADER = (
    "case",
    "states",
    "laws",
    "p50",
    "p99",
    "p99.9",
    "p99.9 of idling",
    "p99.9 undisturbed",
    "slowest",
    "rigid-body terms",
    "ratio",
)
TIMES = (
    "p50_us",
    "p99_us",
    "p999_us",
    "idle_p999_us",
    "p999_undisturbed_us",
    "max_us",
    "rigid_body_us",
)


@dataclass(frozen=True)
class Case:
    """One case's figures [us]; `transitions` limits press (unilateral) or are in transition (chain)."""

    name: str
    mode: str
    n: int
    levels: int
    transitions: int
    states: int
    laws: int
    p50_us: float
    p99_us: float
    p999_us: float
    idle_p999_us: float  # of waits as long as the usual cycle: what the machine itself takes from a loop
    p999_undisturbed_us: float  # of the states, each at the fastest of its passes
    max_us: float
    rigid_body_us: float
    ratio: float


def bench(cycles: int, progress: Progress | None = None) -> dict[str, Any]:
    """Time every case over at least so many cycles, on one core; raises Error outside a source tree."""
    wanted = [(mode, *case) for mode in ("velocity", "torque") for case in CASES]
    cases = []
    with pinned() as core:
        for done, (mode, method, transitions) in enumerate(wanted):
            cases.append(time_case(mode, method, transitions, cycles))
            if progress is not None:
                progress((done + 1) / len(wanted))
    machine = {"processor": processor(), "core": core, "system": platform.platform()}
    return {"machine": machine, "cases": [asdict(case) for case in cases], "peers": []}


def time_case(mode: str, method: str, transitions: int, cycles: int) -> Case:
    """Time the states in which so many limits act."""
    path = FOLDER / f"cycle_{mode}.yaml"
    if not path.is_file():
        raise _core.Error(f"{path}: missing: `tope bench` needs tope's source tree")
    scenario = load_scenario(path, {"limits.method": method})
    timed = _core.benchmark(scenario, transitions, cycles)
    cycle, bare = np.asarray(timed["cycle_us"]), np.asarray(timed["rigid_body_us"])
    described = scenario.describe()
    p50, p99, p999 = np.percentile(cycle, [50, 99, 99.9])
    return Case(
        name=f"{method}, {transitions} limits act",
        mode=mode,
        n=len(described["joints"]),
        levels=len({task["level"] for task in described["tasks"]}),
        transitions=transitions,
        states=timed["states"],
        laws=timed["largest_laws"],
        p50_us=float(p50),
        p99_us=float(p99),
        p999_us=float(p999),
        idle_p999_us=float(np.percentile(timed["idle_us"], 99.9)),
        p999_undisturbed_us=float(np.percentile(cycle.reshape(-1, timed["states"]).min(axis=0), 99.9)),
        max_us=float(cycle.max()),
        rigid_body_us=float(np.median(bare)),
        ratio=float(p50 / np.median(bare)),
    )


def row(case: Mapping[str, Any]) -> tuple[str, ...]:
    """One case under HEADER."""
    times = (f"{case[key]:.2f} µs" for key in TIMES)
    return (
        f"{case['mode']}, {case['name']}",
        str(case["states"]),
        str(case["laws"]),
        *times,
        f"{case['ratio']:.2f}",
    )


@contextmanager
def pinned() -> Iterator[int]:
    """Keep to one core, the last of those allowed."""
    allowed = os.sched_getaffinity(0)
    core = max(allowed)
    os.sched_setaffinity(0, {core})
    try:
        yield core
    finally:
        os.sched_setaffinity(0, allowed)


def processor() -> str:
    """The processor's name, as Linux tells it."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor()
