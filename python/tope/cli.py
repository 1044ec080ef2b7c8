"""The command line: tope run, compare, check, play, sweep, export and bench."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress as ProgressBar
from rich.table import Table
from rich.text import Text

from tope import _core, extras, words
from tope import peers as peer_bench
from tope.bench import HEADER as BENCH_HEADER
from tope.bench import bench as time_cycles
from tope.bench import pinned
from tope.bench import row as bench_row
from tope.compare import compare as run_comparison
from tope.compare import known_methods
from tope.export import export as export_run
from tope.runs import finite, write_json
from tope.simulation import Progress
from tope.simulation import simulate as run_scenario

LOCAL = "127.0.0.1"
PIPED_WIDTH = 200  # columns of a table that does not go to a terminal

app = typer.Typer(
    name="tope",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Strict-priority task-space control of redundant robots that meets joint limits smoothly.",
)

Scenario = Annotated[Path, typer.Argument(metavar="SCENARIO", help="The scenario file (YAML).")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a key of the scenario, as in limits.gain=3."),
]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="The folder to write to.")]


@app.command()
def run(
    scenario: Scenario,
    sets: Set = None,
    out: Out = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Do not write report.html.")] = False,
) -> None:
    """Simulate a scenario.

    Writes log.csv, summary.json and report.html to runs/<scenario>, or to --out.
    """
    folder = out or Path("runs") / scenario.stem
    with progress_bar(f"Simulating {scenario.stem}") as progress:
        done = run_scenario(
            scenario, out=folder, overrides=overrides(sets), progress=progress, report=not no_report
        )
    rows = [
        *words.summary_rows(done.summary),
        written(folder, "summary.json" if no_report else "report.html"),
    ]
    console = output()
    say_notices(console, done.scenario["notices"])
    console.print(pairs(rows))


@app.command()
def compare(
    scenario: Scenario,
    limits: Annotated[
        str | None,
        typer.Option("--limits", metavar="METHOD,METHOD…", help="Ways to keep joint limits; all by default."),
    ] = None,
    others: Annotated[
        list[Path] | None,
        typer.Option(
            "--with", metavar="SCENARIO", help="Overlay the run of another scenario, under its own name."
        ),
    ] = None,
    sets: Set = None,
    out: Out = None,
) -> None:
    """Compare ways to keep joint limits.

    Simulates the scenario once per way; writes compare.json and report.html to runs/<scenario>-compare, or to
    --out. Every run is repeated with a cycle ten times shorter, to tell true jumps of the command from steep
    slopes. What --set changes holds for every run.
    """
    folder = out or Path("runs") / f"{scenario.stem}-compare"
    with progress_bar(f"Comparing {scenario.stem}") as progress:
        runs = run_comparison(
            scenario,
            limits=methods(limits),
            others=others or (),
            out=folder,
            overrides=overrides(sets),
            progress=progress,
        )
    table = Table(*words.COMPARISON_HEADER)
    for name, done in runs.items():
        table.add_row(*map(Text, words.comparison_row(name, done.summary)))
    console = output()
    say_notices(
        console, dict.fromkeys(notice for done in runs.values() for notice in done.scenario["notices"])
    )
    console.print(table)
    console.print(words.COMPARISON_NOTE)
    console.print(pairs([written(folder, "report.html")]))


@app.command()
def check(
    scenario: Scenario,
    sets: Set = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Check a scenario without running it.

    Prints each safety inequality with its margin; fails if one does not hold.
    """
    loaded = _core.load_scenario(str(scenario), overrides(sets))
    inequalities = _core.check(loaded)
    if as_json:
        print(json.dumps(finite(inequalities), indent=2, ensure_ascii=False))
    else:
        console = output()
        say_notices(console, loaded.describe()["notices"])
        print_inequalities(console, inequalities)
    if not all(each["ok"] for each in inequalities):
        raise typer.Exit(1)


@app.command()
def export(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="The folder that a run wrote.")],
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help="mcap (Foxglove, PlotJuggler) or rerun.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The file to write; in RUN by default.")
    ] = None,
) -> None:
    """Write a run in the format of another viewer.

    mcap: ROS 2 messages, for Foxglove and PlotJuggler. rerun: a recording for Rerun.
    """
    file = export_run(folder, to=to, out=out)
    output().print(pairs([("Written to", str(file))]))


@app.command()
def play(
    scenario: Scenario,
    sets: Set = None,
    host: Annotated[
        str, typer.Option("--host", help="The address to serve; others than you may use it.")
    ] = LOCAL,
    port: Annotated[int, typer.Option("--port", help="The port to serve.")] = 8080,
) -> None:
    """Play with a scenario in the browser.

    Drag the goal, push the obstacle, pull limits in, change method, buffer and gains, insert and remove tasks
    while the controller runs at its real rate. Ends with Ctrl-C.
    """
    console = output()
    extras.load("tope.play", "playing", "play").play(
        str(scenario),
        overrides(sets),
        host=host,
        port=port,
        ready=lambda address: console.print(pairs([("Open", address), ("End", "Ctrl-C")])),
    )


@app.command()
def sweep(
    campaign: Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="The campaign file (YAML).")],
    *,
    runs: Annotated[
        int | None, typer.Option("--runs", min=1, help="So many draws instead of the campaign's number.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", min=0, help="Local processes; one a core by default, 0: this process alone."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster, as in tcp://host:8786."),
    ] = None,
    replay: Annotated[
        int | None, typer.Option("--replay", metavar="RUN", help="Only this run, as `tope run` shows it.")
    ] = None,
    markdown: Annotated[
        list[Path] | None,
        typer.Option("--markdown", metavar="FILE", help="Put the tables between the marks of a file."),
    ] = None,
    out: Out = None,
) -> None:
    """Run a campaign: scenarios drawn at random by seed, on Dask.

    Writes runs.parquet and summary.html to runs/<campaign>, or to --out. A sweep that was interrupted goes on
    where it was. The same seed gives the same results on any number of workers. Fails if a variant that must
    keep limits crosses one.
    """
    if scheduler is not None and workers is not None:
        raise typer.BadParameter("a cluster has its own workers", param_hint="--workers")
    tool = extras.load("tope.sweep", "sweeping", "sweep")
    if replay is not None:
        replay_run(tool, campaign, replay, out)
        return
    figures = extras.load("tope.sweep_figures", "sweeping", "sweep")
    mark = figures.Mark(str(campaign))
    for file in markdown or ():  # before hours of running
        mark.check(str(file), file.read_text(encoding="utf-8"))
    with progress_bar(f"Sweeping {campaign.stem}") as progress:
        done = tool.sweep(
            campaign, out=out, runs=runs, workers=workers, scheduler=scheduler, progress=progress
        )
    results = figures.Results(done.campaign, done.table)
    console = output()
    for each in figures.all_figures(results):
        print_figures(console, each)
    if verdict := figures.verdict(results):
        console.print(Text(verdict.replace("`", "")))
    console.print(pairs([written(done.out, "summary.html"), written(done.out, "runs.parquet")]))
    for file in markdown or ():
        tables = figures.markdown(results, tool.shown(campaign, runs))
        file.write_text(mark.put(file.read_text(encoding="utf-8"), tables), encoding="utf-8")
    if any(results.crossed(variant) for variant in done.campaign.must_keep_limits):
        raise typer.Exit(1)


@app.command()
def bench(
    cycles: Annotated[int, typer.Option("--cycles", min=1, help="Cycles a case, at least.")] = 200_000,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write JSON.")] = None,
    peers: Annotated[
        bool, typer.Option("--peers", help="Also measure the libraries that `make peers` installed.")
    ] = False,
    goals: Annotated[
        int, typer.Option("--goals", min=1, max=200, help="Random goals a peer, of two hundred.")
    ] = peer_bench.GOALS,
    markdown: Annotated[
        list[Path] | None,
        typer.Option("--markdown", metavar="FILE", help="Put the peers' tables between the marks of a file."),
    ] = None,
) -> None:
    """Time a cycle of the controller on this machine.

    On the youBot with limits, orientation, position and posture, along recorded closed loops, on one core;
    the bare rigid-body terms, which any controller needs, are timed at the same states in turn. With --peers,
    tope and other libraries go through one closed loop on that core: cost, jumps, limits, errors, failures.
    """
    if markdown and not peers:
        raise typer.BadParameter("only with --peers", param_hint="--markdown")
    for file in markdown or ():  # before minutes of measuring
        peer_bench.check_marks(file)
    if json_file is not None:
        json_file.parent.mkdir(parents=True, exist_ok=True)
    with progress_bar("Timing") as progress:
        figures = time_cycles(cycles, progress)
    if peers:
        with progress_bar("Measuring peers") as progress, pinned():
            figures["peers"] = peer_bench.measure_peers(goals, progress)
    table = Table(*BENCH_HEADER)
    for case in figures["cases"]:
        table.add_row(*map(Text, bench_row(case)))
    console = output()
    console.print(Text(f"{figures['machine']['processor']}, core {figures['machine']['core']}"))
    console.print(table)
    if peers:
        print_peers(console, figures["peers"])
    if json_file is not None:
        write_json(json_file, figures)
    for file in markdown or ():
        texts = peer_bench.markdown(figures["peers"], figures["machine"]["processor"])
        peer_bench.put_markdown(file, texts)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; an expected failure is one line on stderr."""
    try:
        app(arguments)
    except _core.Error as error:
        sys.exit(f"tope: {error}")
    except OSError as error:
        sys.exit(f"tope: {error.filename}: {error.strerror}")


def overrides(sets: Sequence[str] | None) -> dict[str, str]:
    """The scenario keys that --set replaces."""
    pairs = [each.partition("=") for each in sets or ()]
    for key, equals, value in pairs:
        if not key or not equals:
            raise typer.BadParameter(
                f"'{key}{equals}{value}' is not of the form KEY=VALUE", param_hint="--set"
            )
    return {key.strip(): value.strip() for key, _, value in pairs}


def methods(limits: str | None) -> Sequence[str] | None:
    """The methods that --limits names."""
    if limits is None:
        return None
    try:
        return known_methods([name.strip() for name in limits.split(",")])
    except _core.ConfigError as error:
        raise typer.BadParameter(str(error), param_hint="--limits") from error


@contextmanager
def progress_bar(title: str) -> Iterator[Progress | None]:
    """A progress bar on stderr, if that is a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    with ProgressBar(console=console, transient=True) as bar:
        task = bar.add_task(title, total=1.0)
        yield lambda done: bar.update(task, completed=done)


def output() -> Console:
    """Standard output; wide enough for a table if it is not a terminal."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=PIPED_WIDTH)


def say_notices(console: Console, notices: Sequence[str] | dict[str, None]) -> None:
    """What the reader should know about the scenario."""
    for notice in notices:
        console.print(Text(f"Note: {notice}"))


def pairs(rows: Sequence[tuple[str, str]]) -> Table:
    """(What, sentence) rows as a table without frame."""
    table = Table.grid(padding=(0, 2))
    for what, sentence in rows:
        table.add_row(Text(what, style="bold"), Text(sentence))
    return table


def written(folder: Path, name: str) -> tuple[str, str]:
    """Where the result is."""
    return ("Report" if name.endswith(".html") else "Written to", str(folder / name))


def replay_run(tool: ModuleType, campaign: Path, number: int, out: Path | None) -> None:
    """Simulate one run of a campaign, with a report."""
    folder = out or Path("runs") / campaign.stem / f"replay-{number}"
    with progress_bar(f"Simulating run {number}") as progress:
        done = tool.replay(campaign, number, out=folder, progress=progress)
    console = output()
    say_notices(console, done.scenario["notices"])
    console.print(pairs([*words.summary_rows(done.summary), written(folder, "report.html")]))


def print_figures(console: Console, figures: Any) -> None:
    """A table of a sweep."""
    table = Table(*figures.header, title=figures.title)
    for row in figures.rows:
        table.add_row(*map(Text, row))
    console.print(table)


def print_peers(console: Console, peers: Sequence[dict[str, Any]]) -> None:
    """Two tables, how tope compares, and who was absent."""
    for mode in peer_bench.MODES:
        table = Table(*peer_bench.HEADER, title=f"{mode} mode")
        for peer in peer_bench.in_order(peers, mode):
            table.add_row(*map(Text, peer_bench.row(peer)))
        console.print(table)
    for sentence in peer_bench.verdicts(peers):
        console.print(Text(sentence))
    for sentence in peer_bench.absences(peers):
        console.print(Text(f"Not measured: {sentence}"))


def print_inequalities(console: Console, inequalities: Sequence[dict[str, Any]]) -> None:
    """Each inequality as a row, and what to do about those that fail."""
    table = Table("condition", "joint", "inequality", "value", "bound", "margin", "")
    for each in inequalities:
        verdict = Text("ok", style="green") if each["ok"] else Text("FAIL", style="bold red")
        numbers = (words.number(each[key]) for key in ("value", "bound", "margin"))
        table.add_row(*map(Text, (each["name"], each["joint"], each["expression"], *numbers)), verdict)
    console.print(table)
    for each in inequalities:
        if not each["ok"]:
            console.print(Text(f"{each['joint'] or each['name']}: {each['advice']}"))


if __name__ == "__main__":
    main()
