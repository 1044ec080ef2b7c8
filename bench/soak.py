"""Run: make soak.

Ten million cycles of a controller, in both modes: resident memory and cycle time from first to last.
"""

import argparse
import time
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

import tope
from tope.bench import pinned

FOLDER = Path(__file__).parent
BLOCKS = 50
STATES = 10_000  # a round


def resident_kib() -> int:
    """Memory of this process that is in RAM."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1])


def states(scenario: tope.Scenario) -> list[np.ndarray]:
    """A closed loop's positions, to go through again and again."""
    controller = scenario.controller()
    q = np.array([0, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])  # the initial posture of cycle_*.yaml
    visited = []
    for cycle in range(STATES):
        visited.append(q)
        q = q + 1e-3 * controller.update(q, np.zeros_like(q), 1e-3 * cycle)
    return visited


def soak(mode: str, cycles: int, console: Console) -> tuple[list[int], list[float]]:
    """Memory [KiB] and median cycle [us] of each block."""
    path = states(tope.load_scenario(FOLDER / "cycle_velocity.yaml"))
    controller = tope.load_scenario(FOLDER / f"cycle_{mode}.yaml").controller()
    rest = np.zeros_like(path[0])
    memory, times = [], []
    cycle = 0
    taken = np.zeros(cycles // BLOCKS)  # one array for all blocks: its copies would count as memory
    for _ in track(range(BLOCKS), mode, console=console):
        for i in range(len(taken)):
            q = path[cycle % STATES]
            begin = time.perf_counter_ns()
            controller.update(q, rest, 1e-3 * cycle)
            taken[i] = time.perf_counter_ns() - begin
            cycle += 1
        memory.append(resident_kib())
        taken.sort()
        times.append(1e-3 * float(taken[len(taken) // 2]))
    return memory, times


def main() -> None:
    """Both modes; fails when memory grows or cycles slow down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=10_000_000, help="of each mode")
    cycles = parser.parse_args().cycles
    console = Console()
    table = Table(
        "mode", "cycles", "memory, first to last block", "median cycle, first and last fifth (from Python)"
    )
    grown = []
    with pinned():
        for mode in ("velocity", "torque"):
            memory, times = soak(mode, cycles, console)
            fifth = BLOCKS // 5
            first, last = float(np.median(times[:fifth])), float(np.median(times[-fifth:]))
            grown.append(memory[-1] - memory[1])  # the first block still fills caches
            table.add_row(
                mode, f"{cycles:,}", f"{memory[1]:,} to {memory[-1]:,} KiB", f"{first:.2f}, {last:.2f} µs"
            )
    console.print(table)
    if max(grown) > 256:
        raise SystemExit(f"memory grew by {max(grown)} KiB")


if __name__ == "__main__":
    main()
