"""report.html: a run, or several beside each other, on one page that needs no network."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from tope import _core, words
from tope.pages import page_template
from tope.panels import Array, Panel, Section, Series, packed
from tope.runs import Run
from tope.saturation import distances, flags_of, saturation, stretches
from tope.scene import scene

POINTS = 50_000  # drawn on one page in all, so that a page with many curves stays small
POINTS_PER_CURVE = (300, 1000)  # at least, at most
BUNDLE = Path(__file__).parent / "viewer"  # the page's script and style, built from viewer/
FIGURE_5_JOINTS = ("base_x", "arm_joint_5")

Columns = Sequence[tuple[str, str]]  # (label, column of the log)


@dataclass(frozen=True)
class View:
    """The runs on a page, by name, and whether it compares them."""

    runs: Mapping[str, Run]
    compares: bool

    @property
    def mode(self) -> str:
        """The control mode of the first run."""
        return str(next(iter(self.runs.values())).scenario["mode"])

    def described(self, what: str) -> list[Mapping[str, Any]]:
        """The joints or the tasks of all runs, each name once."""
        found: dict[str, Mapping[str, Any]] = {}
        for run in self.runs.values():
            for each in run.scenario[what]:
                found.setdefault(each["name"], each)
        return list(found.values())

    def columns(self, prefix: str) -> list[str]:
        """The columns of any run that start with the prefix."""
        names = (name for run in self.runs.values() for name in run.log if name.startswith(prefix))
        return list(dict.fromkeys(names))


def write_run_report(run: Run, path: Path) -> None:
    """Write the page of one run."""
    view = View({run.scenario["name"]: run}, compares=False)
    write_page(path, view, rows=words.summary_rows(run.summary))


def write_comparison_report(runs: Mapping[str, Run], path: Path) -> None:
    """Write the page that overlays several runs; each summary has the key "jump"."""
    table = [words.comparison_row(name, run.summary) for name, run in runs.items()]
    write_page(path, View(runs, compares=True), table=table)


def write_page(
    path: Path,
    view: View,
    rows: Sequence[tuple[str, str]] = (),
    table: Sequence[tuple[str, ...]] = (),
) -> None:
    """Fill in the template."""
    first = next(iter(view.runs.values()))
    parts = [section for section in sections(view) if section.panels]
    space = scene(view.runs)
    page = page_template("report.html.j2").render(
        scenario=first.scenario,
        facts=words.scenario_facts(first.scenario, [run.scenario["method"] for run in view.runs.values()]),
        notices=list(
            dict.fromkeys(notice for run in view.runs.values() for notice in run.scenario["notices"])
        ),
        tiles=[] if view.compares else words.tiles(first.summary),
        rows=rows,
        distances=[] if view.compares else distances(first.summary),
        saturated={name: saturation(run) for name, run in view.runs.items()},
        header=words.COMPARISON_HEADER,
        table=table,
        table_note=words.COMPARISON_NOTE,
        sections=parts,
        compares=view.compares,
        scene=space,
        data=page_data(view, parts, space),
        style=bundled("report.css"),
        script=bundled("report.js"),
    )
    path.write_text(page, encoding="utf-8")


def bundled(name: str) -> Markup:
    """A file of the page's bundle; raises Error if it was never built."""
    try:
        text = (BUNDLE / name).read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise _core.Error(
            f"{BUNDLE / name}: missing: the report's page is not built; run `make viewer`"
        ) from error
    return Markup(text.replace("</script", "<\\/script"))


def page_data(view: View, parts: Sequence[Section], space: Mapping[str, Any] | None) -> Markup:
    """What the page's script draws, as JSON that is safe inside a script element."""
    panels = [panel for section in parts for panel in section.panels]
    least, most = POINTS_PER_CURVE
    points = min(most, max(least, POINTS // max(1, sum(len(panel.series) for panel in panels))))
    data = {
        "runs": list(view.runs),
        "compares": view.compares,
        "end": max((run.time[-1] for run in view.runs.values() if len(run.time)), default=0.0),
        "panels": [packed(panel, points) for panel in panels],
        "scene": space,
    }
    return Markup(json.dumps(data).replace("<", "\\u003c"))


def sections(view: View) -> list[Section]:
    """Everything that can be drawn, in the order of the page."""
    return [
        positions(view),
        *rates_and_commands(view),
        activations(view),
        task_errors(view),
        status(view),
        wheels(view),
        cycle_times(view),
        figure_4(view),
        figure_5(view),
    ]


def curves(view: View, columns: Columns) -> list[Series]:
    """The columns that exist: coloured by run if the page compares, by column if not."""
    return [
        Series(
            name if view.compares else label,
            run_number if view.compares else column_number,
            run.time,
            run.log[column],
        )
        for run_number, (name, run) in enumerate(view.runs.items())
        for column_number, (label, column) in enumerate(columns)
        if column in run.log
    ]


def together(view: View, title: str, unit: str, columns: Columns, **style: Any) -> list[Panel]:
    """One panel with all the columns; a page that compares has one for each, so that colours tell runs."""
    if not view.compares:
        return [Panel(title, unit, curves(view, columns), **style)]
    return [
        Panel(f"{title} {label}", unit, curves(view, [(label, name)]), **style) for label, name in columns
    ]


def positions(view: View) -> Section:
    """Each limited joint between its limits."""
    limited = [joint for joint in view.described("joints") if limits_of(joint)]
    text = "Solid lines are limits, shaded zones their buffers."
    return Section(
        "Positions of the limited joints", text, [position_panel(view, joint) for joint in limited]
    )


def position_panel(view: View, joint: Mapping[str, Any], title: str = "") -> Panel:
    """One joint's position, its limits and their buffers."""
    name, buffer, unit = joint["name"], joint["buffer"], joint["unit"]
    inward = {"lower": buffer, "upper": -buffer}
    limits = limits_of(joint)
    allowed = ", ".join(f"{side} {limit:.4g}" for side, limit in limits)
    return Panel(
        title or name,
        unit,
        curves(view, [(name, f"q.{name}")]),
        note=f"limits: {allowed}; buffer {buffer:.4g}",
        lines=[limit for _, limit in limits],
        bands=[(limit, limit + inward[side]) for side, limit in limits],
        near=2 * buffer,
    )


def limits_of(joint: Mapping[str, Any]) -> list[tuple[str, float]]:
    """The joint's limits as (side, value)."""
    return [(side, joint[side]) for side in ("lower", "upper") if joint[side] is not None]


def rates_and_commands(view: View) -> list[Section]:
    """Velocities with the commanded ones in velocity mode; velocities and torques in torque mode."""
    joints = view.described("joints")
    if view.mode == "torque":
        return [
            Section("Velocities", "", [rate_panel(view, joint) for joint in joints]),
            Section("Commanded torques and forces", "", [command_panel(view, joint) for joint in joints]),
        ]
    text = "" if view.compares else "What was commanded, and what the robot did."
    title = "Commanded velocities" if view.compares else "Velocities"
    return [Section(title, text, [command_panel(view, joint) for joint in joints])]


def rate_panel(view: View, joint: Mapping[str, Any], title: str = "") -> Panel:
    """One joint's velocity."""
    name = joint["name"]
    return Panel(title or name, words.unit_of_rate(joint), curves(view, [(name, f"v.{name}")]))


def command_panel(view: View, joint: Mapping[str, Any]) -> Panel:
    """One joint's command between its bounds."""
    name, bound, unit = joint["name"], joint["bound"], words.unit_of_command(joint, view.mode)
    series = curves(view, [("command", f"u.{name}")])
    if view.mode == "velocity" and not view.compares:
        robot = curves(view, [("robot", f"v.{name}")])
        series = [replace(each, colour=1, width=4.5) for each in robot] + series
    return Panel(
        name,
        unit,
        series,
        note=f"bound ±{words.number(bound)}",
        lines=[bound, -bound],
        near=0.5 * bound,
    )


def activations(view: View) -> Section:
    """How far each limit acts, for those that ever do."""
    prefix = "xi."
    acting = [
        column
        for column in view.columns(prefix)
        if any(np.any(run.log[column] > 0) for run in view.runs.values() if column in run.log)
    ]
    panels = [
        Panel(column.removeprefix(prefix).replace(".", ", "), "", curves(view, [(column, column)]))
        for column in acting
    ]
    text = "How far a limit acts: 0 not at all, 1 fully. Limits that never act are left out."
    return Section("Activations of the limits", text, panels)


def task_errors(view: View) -> Section:
    """The norm and the components of each task's error; of one that changes, how far it is there."""
    tasks = words.by_level(view.described("tasks"))
    panels = [
        panel
        for task in tasks
        for panel in (
            norm_panel(view, task),
            *component_panels(view, task),
            *presence_panels(view, task),
        )
    ]
    return Section("Task errors", "A vertical line marks the time at which a task is due.", panels)


def norm_panel(view: View, task: Mapping[str, Any], title: str = "") -> Panel:
    """The length of a task's error."""
    series = [
        Series(name, number if view.compares else 0, run.time, norm(run, task["name"]))
        for number, (name, run) in enumerate(view.runs.items())
        if f"e.{task['name']}.0" in run.log
    ]
    label = title or f"{task['name']}: norm of the error"
    return Panel(label, words.unit(task), series, marks=due(task), log=True)


def component_panels(view: View, task: Mapping[str, Any]) -> list[Panel]:
    """The components of a task's error."""
    columns = [(str(i), f"e.{task['name']}.{i}") for i in range(task["size"])]
    title = f"{task['name']}: components" if not view.compares else f"{task['name']}: component"
    return together(view, title, words.unit(task), columns, marks=due(task))


def presence_panels(view: View, task: Mapping[str, Any]) -> list[Panel]:
    """How far a task is there that enters, leaves, moves or is replaced."""
    column = f"a.{task['name']}"
    if column not in view.columns("a."):
        return []
    return [Panel(f"{task['name']}: activation", "", curves(view, [("activation", column)]))]


def norm(run: Run, task: str) -> Array:
    """The length of a task's error over time."""
    squares = [values**2 for column, values in run.log.items() if column.startswith(f"e.{task}.")]
    return np.asarray(np.sqrt(np.sum(squares, axis=0)))


def due(task: Mapping[str, Any]) -> list[tuple[float, str]]:
    """The time at which the task must be done, if there is one."""
    return [] if task["goal_time"] is None else [(task["goal_time"], "due")]


def status(view: View) -> Section:
    """How far the command was scaled back, and what the controller reported."""
    scale = Panel("Scale of the command", "", curves(view, [("scale", "scale")]), lines=[1.0])
    flags = status_panel(view)
    text = "1: the tasks get all they ask for. Less: slowed so that no bound is broken."
    return Section("Scale and status", text, [scale, *([flags] if flags.series else [])])


def status_panel(view: View) -> Panel:
    """A strip for each flag other than ok, drawn where it was raised."""
    series: list[Series] = []
    rows: list[str] = []
    for number, (name, run) in enumerate(view.runs.items()):
        for flag, raised in flags_of(run):
            x = strip(run.time, raised)
            y = np.where(np.isnan(x), np.nan, float(len(rows)))
            colour = number if view.compares else len(rows)
            series.append(Series(name if view.compares else flag, colour, x, y, width=12))
            rows.append(f"{name}: {flag}" if view.compares else flag)
    return Panel("Status", "", series, rows=rows)


def strip(t: Array, raised: NDArray[np.bool_]) -> Array:
    """Start, end and NaN of each stretch [s]; ones too close to tell apart on a screen are joined."""
    visible = (t[-1] - t[0]) / 1000
    starts, ends = stretches(t, raised, visible)
    triples = np.stack([starts, np.maximum(ends, starts + visible), np.full(len(starts), np.nan)], axis=1)
    return np.asarray(triples.ravel())


def wheels(view: View) -> Section:
    """Speeds of the base's wheels, in torque mode their torques."""
    what, unit = ("torques", "Nm") if view.mode == "torque" else ("speeds", "rad/s")
    columns = [(name.removeprefix("wheel."), name) for name in view.columns("wheel.")]
    panels = together(view, "Wheels" if not view.compares else "Wheel", unit, columns) if columns else []
    return Section(f"Wheel {what}", "", panels)


def cycle_times(view: View) -> Section:
    """How long each update of the controller took, for runs of which that is known."""
    series = [
        Series(name if view.compares else "update", number, times_of(run, measured), measured)
        for number, (name, run) in enumerate(view.runs.items())
        if (measured := run.cycle_times) is not None and len(measured) > 0
    ]
    panels = [Panel("Computing time", "µs", series, log=True)] if series else []
    return Section("Time per cycle", "How long the controller took, on the machine of this run.", panels)


def times_of(run: Run, cycles: Array) -> Array:
    """The time of each cycle [s]."""
    return np.asarray(np.arange(len(cycles)) * float(run.scenario["dt"]), dtype=float)


def figure_4(view: View) -> Section:
    """The paper's Figure 4, in torque mode, if its joints exist."""
    joints = {joint["name"]: joint for joint in view.described("joints")}
    if view.mode != "torque" or any(name not in joints for name in FIGURE_5_JOINTS):
        return Section("", "", [])
    pair = [joints[name] for name in FIGURE_5_JOINTS]
    panels = [
        *(position_panel(view, joint, f"{joint['name']}, position") for joint in pair),
        *(rate_panel(view, joint, f"{joint['name']}, velocity") for joint in pair),
    ]
    reaching = next((task for task in view.described("tasks") if task["unit"] == "m"), None)
    if reaching is not None:
        panels.append(norm_panel(view, reaching, f"error of {reaching['name']}"))
    text = "The joints that meet their limits, and the task that brings the end-effector to its goal."
    return Section("The paper’s Figure 4", text, panels, pairs=True)


def figure_5(view: View) -> Section:
    """The paper's Figure 5, if its joints exist and there are two experiments to set side by side."""
    joints = {joint["name"]: joint for joint in view.described("joints")}
    if not view.compares or len(view.runs) < 2 or any(name not in joints for name in FIGURE_5_JOINTS):
        return Section("", "", [])
    first, second = experiments(view)
    both = View({first: view.runs[first], second: view.runs[second]}, compares=True)
    pair = [joints[name] for name in FIGURE_5_JOINTS]
    panels = [
        *(
            position_panel(both, joint, f"({x}) {joint['name']}, position")
            for x, joint in zip("ab", pair, strict=True)
        ),
        *(
            rate_panel(both, joint, f"({x}) {joint['name']}, velocity")
            for x, joint in zip("cd", pair, strict=True)
        ),
    ]
    reaching = next((task for task in both.described("tasks") if task["unit"] == "m"), None)
    if reaching is not None:
        for letter, name in (("e", second), ("f", first)):
            alone = View({name: view.runs[name]}, compares=True)
            panels.append(norm_panel(alone, reaching, f"({letter}) error of {reaching['name']}, {name}"))
    shades = {first: "grey", second: "ink"}
    text = f"Grey: the first experiment ({first}). Black, or white on dark: the second ({second})."
    return Section("The paper’s Figure 5", text, [recoloured(panel, shades) for panel in panels], pairs=True)


def experiments(view: View) -> tuple[str, str]:
    """The names of the runs that stand for the paper's first and second experiment.

    The first kept limits by a potential field: the last run that does so, or the last run of all. The
    second is the first of the other runs.
    """
    names = list(view.runs)
    fields = [name for name in names if view.runs[name].scenario["method"] == "potential_field"]
    first = (fields or names)[-1]
    return first, next(name for name in names if name != first)


def recoloured(panel: Panel, colours: Mapping[str, str]) -> Panel:
    """The panel with its curves' colours chosen by their names."""
    series = [replace(each, colour=colours[each.name]) for each in panel.series]
    return replace(panel, series=series)
