"""Run: make fuzz. Scenario and robot files of any content: a report of what is wrong, or a run.

libFuzzer (by atheris) mutates the files of corpus/. A crash, a hang of ten seconds, an exception that is none
of tope's or a command that is no number ends it, and leaves the input behind.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from random import Random

import atheris
import numpy as np

import tope

ROOT = Path(__file__).parents[2]
FOLDER = Path(tempfile.mkdtemp(prefix="tope_fuzz_"))
CYCLES = 3
LARGEST = 4096  # bytes: the files are short
SEEDS = [file.read_bytes() for file in sorted((Path(__file__).parent / "corpus").glob("*/*.yaml"))]
VALUES = (
    b": -1 #",
    b": .nan #",
    b": .inf #",
    b": 1e308 #",
    b": 0 #",
    b": [] #",
    b": {} #",
    b": ~ #",
    b":\n",
    b": &a ",
)


def lay_out() -> None:
    """A scenario's relative paths lead to the real robot."""
    (FOLDER / "scenarios").mkdir()
    shutil.copytree(ROOT / "robots", FOLDER / "robots")


def try_scenario(path: Path) -> None:
    """Load; what loads must also run."""
    try:
        scenario = tope.load_scenario(path)
        controller = scenario.controller()
    except tope.Error:
        return
    robot = tope.Robot.from_urdf(FOLDER / "robots/youbot/youbot.urdf", FOLDER / "robots/youbot/youbot.yaml")
    for cycle in range(CYCLES):
        u = controller.update(np.zeros(robot.nq), np.zeros(robot.nv), 1e-3 * cycle)
        assert np.all(np.isfinite(u)), u


def try_robot(path: Path) -> None:
    """Load, and ask the bounds."""
    try:
        robot = tope.Robot.from_urdf(FOLDER / "robots/youbot/youbot.urdf", path)
        controller = tope.Controller(robot, mode="velocity", dt=1e-3)
    except tope.Error:
        return
    u = controller.update(np.zeros(robot.nq), np.zeros(robot.nv), 0.0)
    assert np.all(np.isfinite(u)), u


def one_input(data: bytes) -> None:
    """A robot's file begins with its name; the rest are scenarios."""
    if len(data) > LARGEST:
        return
    robot = b"rotor_inertia" in data or b"mecanum_base" in data
    path = FOLDER / ("robots/youbot/fuzzed.yaml" if robot else "scenarios/fuzzed.yaml")
    path.write_bytes(data)
    (try_robot if robot else try_scenario)(path)


def mutated(_: bytes, max_size: int, seed: int) -> bytes:
    """A file of the corpus, its lines shuffled a little, then changed by libFuzzer.

    The extension reports no coverage, so that libFuzzer itself would not come back to these files.
    """
    random = Random(seed)
    lines = random.choice(SEEDS).splitlines(keepends=True)
    for _ in range(random.randint(0, 3)):
        i, j = random.randrange(len(lines)), random.randrange(len(lines))
        if random.random() < 0.5:
            lines[i] = lines[j]
        else:
            lines[i] = lines[i].replace(b": ", random.choice(VALUES), 1)
    data = b"".join(lines)
    for _ in range(random.randint(0, 4)):
        data = atheris.Mutate(data, min(max_size, LARGEST))
    return data


if __name__ == "__main__":
    lay_out()
    atheris.Setup(sys.argv, one_input, custom_mutator=mutated)
    atheris.Fuzz()
