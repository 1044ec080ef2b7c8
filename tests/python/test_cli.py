"""The command line and the Python calls behind it, on the paper's scenarios: files, exit codes, errors.

Not covered here: what the controller does, and how the progress bar looks on a terminal.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from tope import _core
from tope.cli import main
from tope.compare import compare
from tope.simulation import load_run, simulate

SCENARIOS = Path(__file__).parents[2] / "scenarios"
VELOCITY = str(SCENARIOS / "youbot_velocity.yaml")
POTENTIAL_FIELD = str(SCENARIOS / "youbot_potential_field.yaml")
SHORT = ("--set", "duration=0.2")


@pytest.fixture
def tope(capsys, monkeypatch, tmp_path):
    """Run the command line in an empty folder; gives (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        with pytest.raises(SystemExit) as stopped:
            main(list(arguments))
        said = capsys.readouterr()
        code = stopped.value.code
        return (1, said.out, f"{code}\n") if isinstance(code, str) else (code or 0, said.out, said.err)

    return run


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder that a run wrote."""
    out = tmp_path_factory.mktemp("run")
    simulate(VELOCITY, out=out, overrides={"duration": 0.2}, report=False)
    return out


def copy(folder, to):
    """The same files elsewhere, to break them."""
    for name in ("summary.json", "log.csv"):
        (to / name).write_bytes((folder / name).read_bytes())
    return to


def is_one_line(text):
    return text.startswith("tope: ") and text.count("\n") == 1


def test_run_writes_log_summary_and_report(tope):
    code, out, err = tope("run", VELOCITY, *SHORT)
    assert (code, err) == (0, "")
    written = Path("runs/youbot_velocity")
    assert {file.name for file in written.iterdir()} == {"log.csv", "summary.json", "report.html"}
    for word in ("Goal", "Joint limits", "Largest jump", "runs/youbot_velocity/report.html"):
        assert word in out


def test_run_without_report_to_a_folder_of_choice(tope):
    code, out, _ = tope("run", VELOCITY, *SHORT, "--no-report", "--out", "deep/inside")
    assert code == 0
    assert "summary.json" in out
    assert {file.name for file in Path("deep/inside").iterdir()} == {"log.csv", "summary.json"}


def test_set_replaces_keys(tope):
    tope("run", VELOCITY, *SHORT, "--set", "limits.method = chain", "--no-report", "--out", "a")
    described = json.loads(Path("a/summary.json").read_text())["scenario"]
    assert (described["method"], described["duration"]) == ("chain", 0.2)


def test_a_set_without_value_is_a_usage_error(tope):
    code, _, err = tope("run", VELOCITY, "--set", "duration")
    assert code == 2
    assert "KEY=VALUE" in err


@pytest.mark.parametrize("command", ["run", "compare", "check", "play"])
def test_a_wrong_key_is_one_line_that_names_file_and_key(tope, command):
    code, _, err = tope(command, VELOCITY, "--set", "limits.metod=chain")
    assert code == 1
    assert is_one_line(err)
    assert "metod" in err


@pytest.mark.parametrize("command", ["run", "compare", "check", "play"])
def test_a_missing_scenario_is_one_line_that_names_it(tope, command):
    code, _, err = tope(command, "nowhere.yaml")
    assert code == 1
    assert is_one_line(err)
    assert "nowhere.yaml" in err


def test_a_folder_that_cannot_be_made_is_one_line_that_names_it(tope):
    Path("taken").write_text("a file")
    code, _, err = tope("run", VELOCITY, *SHORT, "--out", "taken/inside")
    assert code == 1
    assert is_one_line(err)
    assert "taken/inside" in err


def test_check_prints_inequalities_that_hold(tope):
    code, out, _ = tope("check", VELOCITY)
    assert code == 0
    assert "ok" in out
    assert "FAIL" not in out


def test_check_fails_with_advice(tope):
    code, out, _ = tope("check", VELOCITY, "--set", "dt=0.2")
    assert code == 1
    assert "FAIL" in out


def test_check_as_json(tope):
    code, out, _ = tope("check", VELOCITY, "--json")
    inequalities = json.loads(out)
    assert code == 0
    assert {"name", "joint", "expression", "value", "bound", "margin", "ok", "advice"} <= set(inequalities[0])


def test_compare_writes_a_summary_for_each_method(tope):
    code, out, _ = tope("compare", VELOCITY, *SHORT, "--limits", "chain,switch", "--with", POTENTIAL_FIELD)
    assert code == 0
    written = Path("runs/youbot_velocity-compare")
    assert {file.name for file in written.iterdir()} == {"compare.json", "report.html"}
    summaries = json.loads((written / "compare.json").read_text())
    assert len(summaries) == 3
    assert list(summaries)[:2] == ["chain", "switch"]
    for name, summary in summaries.items():
        assert name in out
        jump = summary["jump"]
        assert jump["fine_dt"] == pytest.approx(jump["dt"] / 10)
        assert jump["at_dt"] == summary["max_command_jump"]["overall"]


def test_compare_suggests_the_nearest_method(tope):
    code, _, err = tope("compare", VELOCITY, "--limits", "chian")
    assert code == 2
    assert "did you mean 'chain'?" in err


def test_compare_refuses_two_runs_of_one_name(tmp_path):
    with pytest.raises(_core.ConfigError, match="taken"):
        compare(VELOCITY, limits=["chain"], others=[VELOCITY, VELOCITY], overrides={"duration": 0.01})


def test_simulate_reports_progress_to_the_end():
    done = []
    simulate(VELOCITY, overrides={"duration": 0.2}, progress=done.append)
    assert done == sorted(done)
    assert all(0 <= fraction <= 1 for fraction in done)


def test_compare_reports_progress_over_all_runs():
    done = []
    compare(VELOCITY, limits=["chain", "switch"], overrides={"duration": 0.1}, progress=done.append)
    assert done == sorted(done)
    assert all(0 <= fraction <= 1 for fraction in done)


def test_overrides_take_numbers():
    run = simulate(VELOCITY, overrides={"duration": 0.2, "dt": 5e-4})
    assert run.scenario["dt"] == 5e-4
    assert run.out is None


def test_a_run_reads_back_as_it_was(folder):
    run = simulate(VELOCITY, overrides={"duration": 0.2})
    again = load_run(folder)
    assert again.out == folder
    assert again.summary["max_limit_violation"] == run.summary["max_limit_violation"]
    assert list(again.log) == list(run.log)
    assert list(again.log["status"]) == list(run.log["status"])
    for name in set(run.log) - {"status"}:
        np.testing.assert_allclose(again.log[name], run.log[name], rtol=1e-6, atol=1e-9)


def test_a_run_that_did_not_finish_says_so(folder, tmp_path):
    (copy(folder, tmp_path) / "summary.json").unlink()
    with pytest.raises(_core.Error, match=r"summary\.json: missing: the run did not finish"):
        load_run(tmp_path)


def test_a_new_run_removes_the_old_summary_first(folder, tmp_path):
    copy(folder, tmp_path)

    def interrupt(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(VELOCITY, out=tmp_path, progress=interrupt)
    assert not (tmp_path / "summary.json").exists()


@pytest.mark.parametrize(
    ("name", "broken", "said"),
    [
        ("summary.json", lambda text: text[: len(text) // 2], r"summary\.json:\d+: not JSON"),
        ("summary.json", lambda _: "[]", r"summary\.json: not the summary of a run"),
        ("log.csv", lambda text: text[:-20], r"log\.csv:\d+: \d+ values where the header has \d+ columns"),
        ("log.csv", lambda text: text.replace("\n0", "\nzero", 1), r"log\.csv: could not convert"),
        ("log.csv", lambda _: "", r"log\.csv:1: not the log of a run"),
    ],
)
def test_a_broken_run_says_where(folder, tmp_path, name, broken, said):
    file = copy(folder, tmp_path) / name
    file.write_text(broken(file.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(_core.Error, match=said):
        load_run(tmp_path)


def test_summary_has_what_is_promised(folder):
    summary = load_run(folder).summary
    assert math.isfinite(summary["max_limit_violation"]["overall"])
    assert math.isfinite(summary["max_command_jump"]["overall"])
    assert {"p50", "p99", "p999", "max"} <= set(summary["cycle_time_us"])
    assert all({"final", "at_goal_time"} <= set(error) for error in summary["task_error"].values())


def test_bench_times_every_case_beside_the_rigid_body_terms(tope, tmp_path):
    file = tmp_path / "bench.json"
    code, out, _ = tope("bench", "--cycles", "200", "--json", str(file))
    assert code == 0
    figures = json.loads(file.read_text())
    assert [(case["mode"], case["transitions"]) for case in figures["cases"]] == [
        (mode, count) for mode in ("velocity", "torque") for count in (0, 3, 0, 2)
    ]
    for case in figures["cases"]:
        assert case["name"] in out
        assert (
            0 < case["rigid_body_us"] < case["p50_us"] <= case["p99_us"] <= case["p999_us"] <= case["max_us"]
        )
        assert 0 < case["p999_undisturbed_us"] <= case["p999_us"]
        assert case["idle_p999_us"] >= 0.5 * case["p50_us"]
        assert case["ratio"] == pytest.approx(case["p50_us"] / case["rigid_body_us"])
        assert case["states"] > 100
        assert (case["n"], case["levels"]) == (8, 3)
        assert case["laws"] <= (1 if case["name"].startswith("unilateral") else case["transitions"] + 1)
