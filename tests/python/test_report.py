"""The report's page: what it draws and says, its size, its cost, and that it needs no network.

Not covered here: how the page looks and answers to clicks (test_report_page.py).
"""

from __future__ import annotations

import base64
import json
import re
import time
from pathlib import Path

import numpy as np
import pytest

from tope import _core, report, words
from tope.panels import thin
from tope.report import write_comparison_report, write_run_report
from tope.runs import Run, finite

URDF = Path(__file__).parents[2] / "robots/youbot/youbot.urdf"
JOINTS = ("base_x", "base_y", "base_yaw", *(f"arm_joint_{i}" for i in range(1, 6)))


def task(name, kind, level, unit, goal_time):
    return {
        "name": name,
        "type": kind,
        "level": level,
        "size": 3,
        "unit": unit,
        "goal_time": goal_time,
        "frame": "ee",
    }


def scenario(name="demo", mode="velocity", joints=JOINTS, method="unilateral"):
    limits = {"base_x": (None, 0.9), "base_y": (None, None), "base_yaw": (None, None)}
    return {
        "name": name,
        "file": f"{name}.yaml",
        "mode": mode,
        "method": method,
        "dt": 1e-3,
        "duration": 10.0,
        "robot": {"name": "youbot", "urdf": str(URDF), "locked_joints": {}},
        "joints": [
            {
                "name": joint,
                "unit": "m" if joint in ("base_x", "base_y") else "rad",
                "lower": limits.get(joint, (-2.5, 2.5))[0],
                "upper": limits.get(joint, (-2.5, 2.5))[1],
                "buffer": 0.1,
                "bound": 1.5,
            }
            for joint in joints
        ],
        "tasks": [
            task("reach", "frame_position", 2, "m", 5.0),
            task("turn", "frame_orientation", 1, "rad", None),
        ],
        "notices": [],
        "description": "",
    }


def summary(described):
    joints = [joint["name"] for joint in described["joints"]]
    return {
        "scenario": described,
        "max_limit_violation": {**dict.fromkeys(joints, -0.3), joints[0]: -0.02, "overall": -0.02},
        "max_command_jump": {**dict.fromkeys(joints, 0.001), joints[0]: 0.004, "overall": 0.004},
        "task_error": {
            "turn": {"final": 1e-4, "at_goal_time": None},
            "reach": {"final": 2e-4, "at_goal_time": 3e-4},
        },
        "time_to_goal": 4.9,
        "status_counts": {"ok": 9001, "limit": 1000},
        "cycle_time_us": {"p50": 10.0, "p99": 12.0, "p999": 15.0, "max": 40.0},
        "command_variation": {"overall": 0.5},
        "buffer_time": {"base_x": 1.0},
        "cycles": 10001,
        "completed": True,
        "jump": {"dt": 1e-3, "fine_dt": 1e-4, "at_dt": 0.004, "at_fine_dt": 0.0004, "ratio": 10.0},
    }


def make_run(rows=10001, **described):
    """A made-up run whose columns all move, with a limit that acts from 4 s on."""
    asked = scenario(**described)
    t = np.linspace(0.0, 10.0, rows)
    noise = np.random.default_rng(1)
    log = {"t": t}
    for kind in ("q", "v", "u"):
        for joint in asked["joints"]:
            log[f"{kind}.{joint['name']}"] = np.sin(t) + 1e-3 * noise.normal(size=rows)
    for joint in asked["joints"]:
        for side in ("upper", "lower"):
            acts = joint["name"] == "base_x" and side == "upper"
            log[f"xi.{joint['name']}.{side}"] = np.clip(t - 4.0, 0.0, 1.0) if acts else np.zeros(rows)
    for task in asked["tasks"]:
        for i in range(task["size"]):
            log[f"e.{task['name']}.{i}"] = np.exp(-t) * (1 + i) + 1e-4 * noise.normal(size=rows)
    log["scale"] = np.ones(rows)
    for wheel in range(4):
        log[f"wheel.{wheel}"] = 10 * np.cos(t) + 1e-2 * noise.normal(size=rows)
    log["status"] = np.where(t > 4.0, "limit|scaled", "ok")
    return Run(summary(asked), log, cycle_times=1 + noise.exponential(size=max(0, rows - 1)))


def data_of(page):
    """What the page's script is given."""
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page)[1])


def panels_of(page):
    return {panel["title"]: panel for panel in data_of(page)["panels"]}


def values(packed):
    return np.frombuffer(base64.b64decode(packed), dtype="<f4")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "report.html"
    write_run_report(make_run(), path)
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    path = tmp_path_factory.mktemp("compare") / "report.html"
    runs = {
        "chain": make_run(method="chain"),
        "potential_field": make_run(method="potential_field"),
        "switch": make_run(method="switch"),
    }
    write_comparison_report(runs, path)
    return path.read_text(encoding="utf-8")


def test_ten_seconds_at_a_kilohertz_stay_small_and_quick(tmp_path):
    run, path = make_run(), tmp_path / "report.html"
    start = time.perf_counter()
    write_run_report(run, path)
    assert time.perf_counter() - start < 3.0
    assert path.stat().st_size < 2e6


def test_a_comparison_of_all_methods_stays_small_and_quick(tmp_path):
    runs = {method: make_run(method=method) for method in _core.LIMIT_METHODS}
    start = time.perf_counter()
    write_comparison_report(runs, tmp_path / "report.html")
    assert time.perf_counter() - start < 3.0
    assert (tmp_path / "report.html").stat().st_size < 6e6


@pytest.mark.parametrize("name", ["page", "comparison"])
def test_page_asks_for_nothing_from_outside(name, request):
    page = request.getfixturevalue(name)
    assert page.count(report.bundled("report.js")) == 1
    ours = page.replace(report.bundled("report.js"), "")
    assert not re.search(r"https?:|\bsrc=|@import|url\(|fetch\(", ours)


def test_outcome_is_said_in_words(page):
    for sentence in (
        "reached in 4.9 s",
        "reached after 4.9 s",
        "kept, 0.02 m away (base_x)",
        "0.4 % of the bound",
    ):
        assert sentence in page


def test_what_was_saturated_is_said_of_every_run(page, comparison):
    sentence = "The upper limit of base_x acted from 4 s to the end, by up to 100 %."
    assert page.count(sentence) == 1
    assert comparison.count(sentence) == 3


def test_a_run_without_saturation_says_so(tmp_path):
    run = make_run(rows=11)
    run.log["xi.base_x.upper"][:] = 0.0
    run.log["status"][:] = "ok"
    write_run_report(run, tmp_path / "report.html")
    assert "Nothing: no limit acted" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_every_limited_joint_is_drawn_with_limits_and_buffers(page):
    panels = data_of(page)["panels"]
    drawn = {panel["title"]: panel for panel in panels if panel["bands"]}
    assert list(drawn) == ["base_x", *(f"arm_joint_{i}" for i in range(1, 6))]
    assert drawn["base_x"]["lines"] == [0.9]
    assert drawn["base_x"]["bands"] == [[0.9, 0.8]]
    assert drawn["arm_joint_5"]["lines"] == [-2.5, 2.5]
    assert drawn["arm_joint_5"]["bands"] == [[-2.5, -2.4], [2.5, 2.4]]


def test_velocity_mode_draws_command_and_robot_between_bounds(page):
    commands = [panel for panel in data_of(page)["panels"] if panel["lines"] == [1.5, -1.5]]
    assert [panel["title"] for panel in commands] == list(JOINTS)
    assert {series["name"] for series in commands[0]["series"]} == {"command", "robot"}
    assert commands[0]["unit"] == "m/s"


def test_torque_mode_draws_velocities_and_torques(tmp_path):
    write_run_report(make_run(mode="torque", rows=101), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Commanded torques and forces" in page
    units = [panel["unit"] for panel in data_of(page)["panels"] if panel["title"] == "arm_joint_1"]
    assert units == ["rad", "rad/s", "Nm"]


def test_only_limits_that_act_have_an_activation_panel(page):
    assert [title for title in panels_of(page) if ", upper" in title or ", lower" in title] == [
        "base_x, upper"
    ]


def test_task_errors_have_norm_components_and_due_time(page):
    panels = panels_of(page)
    norm = panels["reach: norm of the error"]
    assert norm["log"]
    assert norm["marks"] == [[5.0, "due"]]
    assert panels["turn: norm of the error"]["marks"] == []
    assert values(norm["series"][0]["y"])[0] == pytest.approx(np.sqrt(1 + 4 + 9), rel=1e-2)
    assert len(panels["reach: components"]["series"]) == 3


def test_a_task_that_leaves_is_told_and_drawn(tmp_path):
    run = make_run()
    run.scenario["tasks"][1]["stays"] = False
    run.log["a.turn"] = np.clip(5.0 - run.log["t"], 0.0, 1.0)
    write_run_report(run, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    panels = panels_of(page)
    assert values(panels["turn: activation"]["series"][0]["y"])[-1] == 0
    assert "reach: activation" not in panels
    assert "at the end (the task had left)" in words.task_error(run.summary, run.scenario["tasks"][1])
    assert "turn" not in words.goal_accuracy(run.summary)


def test_status_flags_are_strips(page):
    panel = panels_of(page)["Status"]
    assert panel["rows"] == ["limit", "scaled"]
    strip = values(panel["series"][0]["x"])
    assert strip[:2] == pytest.approx([4.001, 10.0])


def test_a_status_that_flickers_every_cycle_stays_small(tmp_path):
    run = make_run()
    run.log["status"] = np.where(np.arange(10001) % 2, "limit", "ok")
    write_run_report(run, tmp_path / "report.html")
    panel = panels_of((tmp_path / "report.html").read_text(encoding="utf-8"))["Status"]
    assert len(values(panel["series"][0]["x"])) <= 3 * 1001


def test_a_peak_of_one_cycle_survives_thinning(tmp_path):
    run = make_run()
    run.log["u.base_y"][6543] = 42.0
    write_run_report(run, tmp_path / "report.html")
    panels = data_of((tmp_path / "report.html").read_text(encoding="utf-8"))["panels"]
    command = next(s for p in panels if p["title"] == "base_y" for s in p["series"] if s["name"] == "command")
    peak = values(command["y"]).argmax()
    assert values(command["y"])[peak] == 42.0
    assert values(command["x"])[peak] == pytest.approx(6.543)


def test_thinning_keeps_steps_and_drops_flat_stretches():
    x = np.arange(10000.0)
    y = np.where(x < 5000, 0.0, 1.0)
    assert list(thin(x, y, 500)) == [0, 4999, 5000, 9999]


def test_thinning_keeps_gaps():
    x = np.arange(10000.0)
    y = np.sin(x)
    y[3000:3010] = np.nan
    y[5000] = np.inf
    kept = thin(x, y, 500)
    assert len(kept) < 1000
    assert np.isnan(y[kept]).any()


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_very_short_runs_have_a_page(tmp_path, rows):
    write_run_report(make_run(rows=rows), tmp_path / "report.html")
    assert data_of((tmp_path / "report.html").read_text(encoding="utf-8"))["panels"]


def test_names_cannot_break_the_page(tmp_path):
    write_run_report(make_run(rows=11, name="</script><b>&"), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "</script><b>" not in page
    assert "&lt;/script&gt;&lt;b&gt;&amp;" in page


def test_comparison_has_a_curve_a_run_with_one_colour(comparison):
    data = data_of(comparison)
    assert data["runs"] == ["chain", "potential_field", "switch"]
    panel = panels_of(comparison)["reach: component 2"]
    assert [(s["name"], s["colour"]) for s in panel["series"]] == list(
        zip(data["runs"], range(3), strict=True)
    )
    assert "Wheel 3" in panels_of(comparison)
    assert "0.4 %, 0.04 %, 10" in comparison


def test_figure_5_sets_the_potential_field_beside_the_first_method(comparison):
    panels = [panel for title, panel in panels_of(comparison).items() if title.startswith("(")]
    assert [panel["title"] for panel in panels] == [
        "(a) base_x, position",
        "(b) arm_joint_5, position",
        "(c) base_x, velocity",
        "(d) arm_joint_5, velocity",
        "(e) error of reach, chain",
        "(f) error of reach, potential_field",
    ]
    assert [(s["name"], s["colour"]) for s in panels[0]["series"]] == [
        ("potential_field", "grey"),
        ("chain", "ink"),
    ]
    assert panels[0]["bands"] == [[0.9, 0.8]]
    assert [s["name"] for s in panels[4]["series"]] == ["chain"]


def test_no_figure_5_without_its_joints(tmp_path):
    runs = {name: make_run(rows=101, joints=("a", "b")) for name in ("chain", "switch")}
    write_comparison_report(runs, tmp_path / "report.html")
    assert "Figure 5" not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_runs_of_unlike_robots_can_be_overlaid(tmp_path):
    runs = {"one": make_run(rows=101, joints=("a", "b")), "two": make_run(rows=51, joints=("b", "c"))}
    write_comparison_report(runs, tmp_path / "report.html")
    panels = data_of((tmp_path / "report.html").read_text(encoding="utf-8"))["panels"]
    drawn = {
        panel["title"]: [series["name"] for series in panel["series"]] for panel in panels if panel["bands"]
    }
    assert drawn == {"a": ["one"], "b": ["one", "two"], "c": ["two"]}


def test_words_for_a_crossed_limit_and_for_a_goal_that_was_missed():
    told = summary(scenario())
    told["max_limit_violation"] = {"arm_joint_5": 0.01, "base_x": -0.2, "overall": 0.01}
    told["time_to_goal"] = None
    assert words.limits(told) == "crossed by 0.01 rad (arm_joint_5)"
    assert words.goal(told) == "not reached"
    told["completed"] = False
    assert words.goal(told) == "stopped early, after 10001 cycles"
    told["max_limit_violation"] = {"overall": None}
    assert words.limits(told) == "no joint has one"


def test_tiles_say_the_outcome_at_a_glance():
    told = summary(scenario())
    assert [figure for _, figure, _ in words.tiles(told)] == ["reached in 4.9 s", "kept", "0.4 %", "10 µs"]
    told["time_to_goal"] = None
    told["max_limit_violation"] = {"arm_joint_5": 0.01, "overall": 0.01}
    told["max_command_jump"] = {"overall": None}
    assert words.tiles(told)[0][1] == "not reached"
    assert words.tiles(told)[1] == ("Limits", "crossed", "by 0.01 rad, arm_joint_5")
    assert words.tiles(told)[2][1:] == ("–", "no cycle")
    told["max_limit_violation"] = {"overall": None}
    assert words.tiles(told)[1][1:] == ("none", "no joint has one")


def test_json_has_no_numbers_that_json_does_not_know():
    assert finite({"a": [1.0, float("nan")], "b": (float("inf"), 2, "x")}) == {
        "a": [1.0, None],
        "b": [None, 2, "x"],
    }


def test_small_lengths_and_angles_have_a_prefix():
    assert words.number(0.00125, "m") == "1.25 mm"
    assert words.number(-2e-4, "rad") == "-200 µrad"
    assert words.number(4.97e-9, "m") == "4.97 nm"
    assert words.number(7.55e-5, "m") == "75.5 µm"
    assert words.number(0.0125, "m") == "0.0125 m"
    assert words.number(0.0, "m") == "0 m"
    assert words.number(0.001, "m/s") == "0.001 m/s"


def test_the_time_of_each_cycle_is_drawn_if_known(page, tmp_path):
    assert "Computing time" in panels_of(page)
    run = make_run(rows=11)
    write_run_report(Run(run.summary, run.log), tmp_path / "report.html")
    assert "Computing time" not in panels_of((tmp_path / "report.html").read_text(encoding="utf-8"))


def test_a_page_that_was_never_built_says_how_to_build_it(tmp_path, monkeypatch):
    monkeypatch.setattr(report, "BUNDLE", tmp_path)
    with pytest.raises(_core.Error, match=r"report\.css: missing: .* run `make viewer`"):
        write_run_report(make_run(rows=11), tmp_path / "report.html")


def test_a_robot_whose_urdf_is_gone_is_an_error_not_an_empty_page(tmp_path):
    run = make_run(rows=11)
    run.scenario["robot"]["urdf"] = str(tmp_path / "gone.urdf")
    with pytest.raises(_core.Error, match=r"gone\.urdf: missing"):
        write_run_report(run, tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_runs_of_unlike_robots_have_no_replay(tmp_path, comparison):
    assert len(data_of(comparison)["scene"]["runs"]) == 3
    runs = {"one": make_run(rows=11), "two": make_run(rows=11)}
    runs["two"].scenario["robot"]["name"] = "another"
    write_comparison_report(runs, tmp_path / "report.html")
    assert data_of((tmp_path / "report.html").read_text(encoding="utf-8"))["scene"] is None
