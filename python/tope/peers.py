"""tope beside other libraries: the same robot, scenario, loop and core, one program after the other.

The programs are those of bench/peers, each in the environment of its library; docs/peers.md says what
they do.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from tope import _core
from tope.simulation import Progress

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "bench" / "peers"
ENVIRONMENTS = ROOT / ".venv-peers"
TOPE_PROGRAM = ROOT / "build" / "Release" / "tope_peer"
TIMEOUT = 600  # s, of one program
GOALS = 20
REACHED = 1e-3  # m and rad
ROUNDING = 1e-9  # m and rad; a limit crossed by less is not crossed
NAMED = ("near", "main")
MODES = ("velocity", "torque")
DEFAULT = "unilateral"
# Between these lines of a file the command writes its tables; {which} is one of TABLES.
TABLES = ("all", "cheapest")
BEGIN, END = "<!-- tope bench --peers: {which} -->", "<!-- end of tope bench --peers -->"
HEADER = (
    "library",
    "priorities",
    "cycle p50, p99",
    "jump at 1 ms",
    "0.1 ms",
    "goals, 1 ms",
    "limit crossed by",
    "near goal missed by",
    "oriented",
    "failed cycles, runs",
)


@dataclass(frozen=True)
class Program:
    """One library in one language, mode and configuration."""

    name: str  # of its environment
    language: str  # "C++" or "Python"
    mode: str
    configuration: str

    @property
    def file(self) -> Path:
        """What is run."""
        if self.language == "Python":
            return FOLDER / f"{self.name}_peer.py"
        return (
            TOPE_PROGRAM if self.name == "tope" else ENVIRONMENTS / self.name / "build" / f"{self.name}_peer"
        )

    @property
    def python(self) -> Path:
        """The interpreter of its environment."""
        return Path(sys.executable) if self.name == "tope" else ENVIRONMENTS / self.name / "bin" / "python"

    def command(self, scenario: Path) -> list[str]:
        """What to run."""
        interpreter = [str(self.python), "-W", "ignore"] if self.language == "Python" else []
        return [*interpreter, str(self.file), str(scenario), self.configuration]

    def missing(self) -> str | None:
        """Why it cannot be run, if so."""
        reason = ENVIRONMENTS / self.name / "absent.txt"
        if reason.is_file():
            return f"not installed: {reason.read_text(encoding='utf-8').strip()}"
        present = self.file.is_file() and (self.language == "C++" or self.python.is_file())
        return None if present else "not installed: make peers"


def programs() -> list[Program]:
    """All that are measured; C++ first, so that what is compared runs close together."""
    tope = ("tope", (DEFAULT, "chain"))
    roboplan = ("roboplan", ("default", "weights", "priorities"))
    tsid = ("tsid", ("weights", "weights+torque-bounds", "orientation-constraint"))
    program = ("default", "weights", "orientation-constraint")
    wanted: Sequence[tuple[str, str, Sequence[tuple[str, Sequence[str]]]]] = (
        ("velocity", "C++", (tope, roboplan)),
        ("torque", "C++", (tope, tsid)),
        ("torque", "Python", (tope, tsid)),
        (
            "velocity",
            "Python",
            (
                tope,
                roboplan,
                ("placo", ("weights", "orientation-constraint")),
                ("mink", program),
                ("pink", program),
                ("drake", ("function", "system")),
                ("embodik", ("scale", "min-error")),
            ),
        ),
    )
    return [
        Program(name, language, mode, configuration)
        for mode, language, libraries in wanted
        for name, configurations in libraries
        for configuration in configurations
    ]


# What no program can be written for.
WITHOUT_CPP: Mapping[str, str] = {
    "placo": "its wheel has no C++ headers",
    "drake": "its wheel has no C++ headers",
    "pink": "a Python library",
    "mink": "a Python library",
}


def measure_peers(goals: int = GOALS, progress: Progress | None = None) -> list[dict[str, Any]]:
    """Run every program in turn on the present core; raises Error outside a source tree."""
    if not FOLDER.is_dir():
        raise _core.Error(f"{FOLDER}: missing: `tope bench --peers` needs tope's source tree")
    wanted = programs()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        writer = [sys.executable, str(FOLDER / "scenario.py"), folder, "--goals", str(goals)]
        subprocess.run(writer, check=True, stdout=subprocess.DEVNULL)
        for done, program in enumerate(wanted):
            results.append(measure(program, Path(folder) / f"{program.mode}.txt"))
            if progress is not None:
                progress((done + 1) / len(wanted))
    for name, reason in WITHOUT_CPP.items():
        results.append({"name": name, "language": "C++", "mode": "velocity", "absent": reason})
    return results


def measure(program: Program, scenario: Path) -> dict[str, Any]:
    """What a program measured in the benchmark's scenario, summed up, or why there is nothing."""
    found = run(program, scenario)
    return found if "absent" in found else collected(found)


def run(program: Program, scenario: Path) -> dict[str, Any]:
    """What a program measured in a scenario, run by run, or why there is nothing."""
    about = {
        "name": program.name,
        "language": program.language,
        "mode": program.mode,
        "configuration": program.configuration,
    }
    missing = program.missing()
    if missing is not None:
        return about | {"absent": missing}
    threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            program.command(scenario),
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
            env=os.environ | threads,
        )
    except subprocess.TimeoutExpired:
        return about | {"absent": f"stopped after {TIMEOUT} s"}
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or ["it said nothing"]
        return about | {"absent": f"ended with code {done.returncode}: {said[-1][:200]}"}
    return about | dict(json.loads(done.stdout.strip().splitlines()[-1]))


def collected(measured: Mapping[str, Any]) -> dict[str, Any]:
    """A program's figures with what sums up its runs."""
    runs: Sequence[Mapping[str, Any]] = measured["runs"]
    dt = max(run["dt"] for run in runs)
    coarse = [run for run in runs if run["dt"] == dt]
    named = [run for run in coarse if run["goal"] in NAMED]
    random = [run for run in coarse if run["goal"] not in NAMED]
    driven = [run["jump"] for run in random if not run["gave_up"]]
    fine = [run for run in runs if run["dt"] < dt]
    jump, fine_jump = (max(run["jump"] for run in each) for each in (named, fine))
    return dict(measured) | {
        "jump": jump,
        "fine_jump": fine_jump,
        "jump_ratio": jump / fine_jump if fine_jump > 0 else None,
        "goal_jump": median(driven) if driven else None,
        "violation": max(run["violation"] for run in runs),
        "speed_excess": max(run["speed_excess"] for run in runs),
        "command_excess": max(run["command_excess"] for run in runs),
        "final": {
            run["goal"]: {"position": run["position_error"], "orientation": run["orientation_error"]}
            for run in named
        },
        "goals": len(random),
        "oriented": sum(run["orientation_error"] < REACHED for run in random),
        "reached": sum(max(run["orientation_error"], run["position_error"]) < REACHED for run in random),
        "cycles": sum(run["cycles"] for run in coarse),
        "failures": sum(run["failures"] for run in coarse),
        "failed_runs": sum(run["failures"] > 0 for run in coarse),
        "gave_up": sum(run["gave_up"] for run in coarse),
    }


def in_order(peers: Sequence[Mapping[str, Any]], mode: str) -> list[Mapping[str, Any]]:
    """The measured ones of a mode: by language, tope first, then by cost."""
    measured = [peer for peer in peers if peer["mode"] == mode and "absent" not in peer]
    return sorted(
        measured, key=lambda peer: (peer["language"] != "C++", peer["name"] != "tope", peer["p50_us"])
    )


def row(peer: Mapping[str, Any]) -> tuple[str, ...]:
    """One measured peer under HEADER."""
    near = peer["final"]["near"]
    runs = f"{peer['failed_runs']} of {peer['goals'] + len(NAMED)}"
    return (
        f"{peer['name']} {peer['version']}, {peer['language']}: {peer['configuration']}",
        peer["priorities"],
        f"{peer['p50_us']:.1f}, {peer['p99_us']:.1f} µs",
        f"{100 * peer['jump']:.3g} %",
        f"{100 * peer['fine_jump']:.3g} %",
        "-" if peer["goal_jump"] is None else f"{100 * peer['goal_jump']:.3g} %",
        f"{peer['violation']:.1e}" if peer["violation"] > ROUNDING else "0",
        f"{1e3 * near['position']:.1f} mm, {1e3 * near['orientation']:.1f} mrad",
        f"{peer['oriented']} of {peer['goals']}",
        f"{peer['failures']}, {runs}" if peer["failures"] else "0",
    )


def absences(peers: Sequence[Mapping[str, Any]]) -> list[str]:
    """A sentence for each that was not measured; a library that is not installed gets one."""
    said: dict[str, None] = {}
    for peer in peers:
        if "absent" in peer:
            said[f"{peer['name']}, {peer['language']}: {peer['absent']}"] = None
    return list(said)


def verdicts(peers: Sequence[Mapping[str, Any]]) -> list[str]:
    """How the default compares per cycle with the fastest peer, by mode and language."""
    sentences = []
    for mode in MODES:
        for language in ("C++", "Python"):
            measured = [each for each in in_order(peers, mode) if each["language"] == language]
            own = [peer for peer in measured if peer["name"] == "tope" and peer["configuration"] == DEFAULT]
            others = [peer for peer in measured if peer["name"] != "tope"]
            if own and others:
                fastest = min(others, key=lambda peer: peer["p50_us"])
                times = f"{own[0]['p50_us']:.1f} µs against {fastest['p50_us']:.1f} µs"
                named = f"{fastest['name']} ({fastest['configuration']})"
                ratio = fastest["p50_us"] / own[0]["p50_us"]
                sentences.append(f"{mode}, {language}: tope {times} of {named}, {ratio:.2f} times as fast")
    return sentences


def cheapest(peers: Sequence[Mapping[str, Any]], mode: str) -> list[Mapping[str, Any]]:
    """One of each library in each language: tope's default, of the others what costs least."""
    chosen: dict[tuple[str, str], Mapping[str, Any]] = {}
    for peer in in_order(peers, mode):
        if peer["name"] != "tope" or peer["configuration"] == DEFAULT:
            chosen.setdefault((peer["name"], peer["language"]), peer)
    return list(chosen.values())


def table(peers: Sequence[Mapping[str, Any]], mode: str) -> str:
    """Peers of a mode as Markdown."""
    lines = [f"| {mode} mode | " + " | ".join(HEADER[1:]) + " |", "|---" * len(HEADER) + "|"]
    for peer in peers:
        first, *others = row(peer)
        own = peer["name"] == "tope" and peer["configuration"] == DEFAULT
        lines.append("| " + " | ".join([f"**{first}**" if own else first, *others]) + " |")
    return "\n".join(lines)


def markdown(peers: Sequence[Mapping[str, Any]], processor: str) -> dict[str, str]:
    """What goes between the marks of a file: all that was measured, or one configuration of each library."""
    parts = {which: [f"One core of {processor}."] for which in TABLES}
    for mode in MODES:
        parts["all"].append(table(in_order(peers, mode), mode))
        parts["cheapest"].append(table(cheapest(peers, mode), mode))
    compared = "\n".join(f"* {sentence}." for sentence in verdicts(peers))
    absent = absences(peers)
    for each in parts.values():
        each.append(compared)
        if absent:
            each.append("Not measured: " + "; ".join(absent) + ".")
    return {which: "\n\n".join(each) for which, each in parts.items()}


def check_marks(file: Path) -> None:
    """Raise Error if a file has no place for tables."""
    text = file.read_text(encoding="utf-8")
    begins = [BEGIN.format(which=which) for which in TABLES]
    if not any(END in text.partition(begin)[2] for begin in begins):
        lines = " or ".join(f"'{begin}'" for begin in begins)
        raise _core.Error(f"{file}: no place for the tables: it needs a line {lines}, later '{END}'")


def put_markdown(file: Path, texts: Mapping[str, str]) -> None:
    """Replace what is between the marks of a file."""
    whole = file.read_text(encoding="utf-8")
    for which, text in texts.items():
        before, begin, rest = whole.partition(BEGIN.format(which=which))
        _, end, after = rest.partition(END)
        if begin and end:
            whole = f"{before}{begin}\n\n{text}\n\n{end}{after}"
    file.write_text(whole, encoding="utf-8")
