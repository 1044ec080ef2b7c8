"""`tope sweep`: what a campaign draws, how its mistakes are told, and that kills and workers change no byte.

Not covered here: clusters over several machines, and how the page looks.
"""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import psutil
import pytest
from kinematics import frames
from pyarrow import parquet

from tope import _core
from tope.campaign_file import check_worker, load_campaign
from tope.cli import main
from tope.sweep import replay, sweep
from tope.sweep_rows import metrics, run_chunk

SCENARIOS = Path(__file__).parents[2] / "scenarios"
CAMPAIGNS = Path(__file__).parents[2] / "campaigns"
TOPE = [sys.executable, "-m", "tope.cli"]
DASK = [sys.executable, "-m", "dask"]

QUICK = f"""\
name: quick
seed: 5
runs: 20
chunk: 4
scenario: {SCENARIOS}/youbot_velocity.yaml
set: {{duration: 0.1}}
let:
  wall: {{uniform: [0.2, 0.4]}}
sample:
  dt: {{log_uniform: [1e-3, 4e-3]}}
  limits.joints.*.buffer: {{uniform: [bound * dt * 2, bound * dt * 3]}}
  limits.joints.base_x.upper: {{value: wall}}
  initial.*: {{uniform: ["max(lower, -1) + buffer", "min(upper, wall) - buffer"]}}
  tasks.orientation.target.quaternion: {{rotation: uniform}}
  tasks.position.target.position: [{{uniform: [0, 1]}}, 0.5, {{choice: [0.1, 0.2]}}]
  tasks.position.reference:
    choice:
      - {{type: exponential, gain: {{uniform: [1, 3]}}}}
      - {{type: predefined_time, duration: 0.08, gain: 2}}
variants:
  unilateral: {{limits.method: unilateral}}
  chain: {{limits.method: chain}}
must_keep_limits: [unilateral, chain]
"""

SLOW = f"""\
name: slow
seed: 5
runs: 40
chunk: 1
scenario: {SCENARIOS}/youbot_torque.yaml
set: {{duration: 2.0}}
sample:
  tasks.position.target.position: [{{uniform: [0, 1]}}, {{uniform: [-0.5, 0.5]}}, 0.3]
"""


@pytest.fixture
def tope(capsys, monkeypatch, tmp_path):
    """Run the command line in an empty folder; gives (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        with pytest.raises(SystemExit) as stopped:
            main([str(each) for each in arguments])
        said = capsys.readouterr()
        code = stopped.value.code
        return (1, said.out, f"{code}\n") if isinstance(code, str) else (code or 0, said.out, said.err)

    return run


def campaign_file(folder, text=QUICK, **keys):
    """A campaign file, with top keys replaced."""
    for key, value in keys.items():
        text = re.sub(rf"^{key}:.*$", f"{key}: {value}", text, flags=re.MULTILINE)
    file = folder / "campaign.yaml"
    file.write_text(text)
    return file


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """A sweep in this process alone."""
    folder = tmp_path_factory.mktemp("quick")
    return sweep(campaign_file(folder), out=folder / "out", workers=0)


@pytest.fixture(scope="module")
def slow(tmp_path_factory):
    """The campaign that is long enough to be killed, and the bytes of its uninterrupted result."""
    folder = tmp_path_factory.mktemp("slow")
    file = campaign_file(folder, SLOW)
    sweep(file, out=folder / "out", workers=0)
    return file, (folder / "out/runs.parquet").read_bytes()


def one(folder, distribution, count=200):
    """Values of one distribution."""
    text = f"name: n\nseed: 1\nruns: {count}\nscenario: {SCENARIOS}/youbot_velocity.yaml\n"
    campaign = load_campaign(campaign_file(folder, f"{text}let:\n  x: {distribution}\n"))
    return [campaign.draw(run).let["x"] for run in range(count)]


# What is drawn


def test_a_draw_depends_on_seed_and_number_alone(tmp_path):
    campaign = load_campaign(campaign_file(tmp_path))
    forwards = [campaign.draw(run) for run in range(40)]
    assert [campaign.draw(run) for run in reversed(range(40))] == forwards[::-1]
    assert load_campaign(campaign_file(tmp_path, runs=7)).draw(3) == forwards[3]
    assert load_campaign(campaign_file(tmp_path, seed=6)).draw(3).keys != forwards[3].keys
    assert len({json.dumps(draw.keys) for draw in forwards}) == 40


def test_every_variant_gets_the_same_draws(tmp_path):
    campaign = load_campaign(campaign_file(tmp_path))
    first, second = campaign.draw(6), campaign.draw(7)
    assert (first.sample, second.sample) == (3, 3)
    assert first.keys.pop("limits.method") == "unilateral"
    assert second.keys.pop("limits.method") == "chain"
    assert first.keys == second.keys


def test_patterns_and_formulas_know_the_joint_and_what_was_drawn(tmp_path):
    campaign = load_campaign(campaign_file(tmp_path))
    for run in range(0, 40, 2):
        draw = campaign.draw(run)
        buffers = {key: value for key, value in draw.keys.items() if key.endswith(".buffer")}
        assert len(buffers) == 8
        assert 2 * 0.8 <= buffers["limits.joints.base_x.buffer"] / draw.keys["dt"] <= 3 * 0.8
        assert draw.keys["limits.joints.base_x.upper"] == draw.let["wall"]
        assert draw.keys["initial.base_x"] <= draw.let["wall"] - buffers["limits.joints.base_x.buffer"]
        assert draw.keys["initial.arm_joint_2"] >= -1 + buffers["limits.joints.arm_joint_2.buffer"]


def test_distributions_fill_their_ranges(tmp_path):
    values = np.array(one(tmp_path, "{uniform: [2, 4]}"))
    assert 2 <= values.min() < 2.1
    assert 3.9 < values.max() <= 4
    values = np.log10(one(tmp_path, "{log_uniform: [1e-3, 1e3]}"))
    assert -3 <= values.min() < -2.5
    assert 2.5 < values.max() <= 3
    assert abs(values.mean()) < 0.5
    assert set(one(tmp_path, "{integer: [1, 3]}")) == {1, 2, 3}
    assert set(one(tmp_path, "{choice: [left, {value: 2 * pi}]}")) == {"left", 2 * math.pi}


def test_rotations_are_unit_quaternions_as_far_away_as_asked(tmp_path):
    uniform = np.array(one(tmp_path, "{rotation: uniform}"))
    near = np.array(one(tmp_path, "{rotation: {within: 0.5, of: [0, 0, 1, 0]}}"))
    for values in (uniform, near):
        np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(uniform.mean(axis=0), 0.0, atol=0.15)
    angles = 2 * np.arccos(np.abs(near[:, 2]))
    assert 0.4 < angles.max() <= 0.5


def test_a_pose_is_where_pinocchio_sees_the_frame(tmp_path):
    joints = (
        "{base_y: 0.2, base_yaw: 0.4, arm_joint_2: 0.5, arm_joint_4: {uniform: [-1, 1]}, arm_joint_5: 2.5}"
    )
    text = f"let:\n  bend: {{uniform: [-1, 1]}}\n  goal: {{pose: {{frame: ee, joints: {joints}}}}}\n"
    text = text.replace("arm_joint_4: {uniform: [-1, 1]}", "arm_joint_4: {value: bend}")
    head = f"name: n\nseed: 1\nruns: 3\nscenario: {SCENARIOS}/youbot_velocity.yaml\n"
    let = load_campaign(campaign_file(tmp_path, head + text)).draw(1).let
    arm = {"arm_joint_2": 0.5, "arm_joint_4": let["bend"], "arm_joint_5": 2.5}
    placement = frames({"base_y": 0.2, "base_yaw": 0.4, **arm})["ee"]
    np.testing.assert_allclose(let["goal"]["position"], placement.translation, atol=1e-12)
    w, x, y, z = let["goal"]["quaternion"]
    np.testing.assert_allclose(
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        placement.rotation[:, 0],
        atol=1e-12,
    )


def test_a_pose_may_name_joints_by_a_pattern(tmp_path):
    head = f"name: n\nseed: 1\nruns: 3\nscenario: {SCENARIOS}/youbot_velocity.yaml\nlet:\n"

    def goal(joints):
        text = f"{head}  goal: {{pose: {{frame: ee, joints: {{{joints}}}}}}}\n"
        return load_campaign(campaign_file(tmp_path, text)).draw(0).let["goal"]

    assert goal('"arm_joint_*": 0.4') == goal(", ".join(f"arm_joint_{j}: 0.4" for j in range(1, 6)))
    with pytest.raises(_core.ConfigError, match=r"'leg_\*' is no joint; there are base_x, base_y"):
        goal('"leg_*": 0.4')


@pytest.mark.parametrize("file", sorted(CAMPAIGNS.glob("*.yaml")), ids=lambda file: file.stem)
def test_the_campaigns_kept_here_draw_scenarios_that_are_accepted(file):
    campaign = load_campaign(file)
    for run in range(2 * len(campaign.variants)):
        keys = campaign.overrides(campaign.draw(run))
        text = {key: value if isinstance(value, str) else json.dumps(value) for key, value in keys.items()}
        _core.load_scenario(campaign.scenario, text).controller()


# Mistakes


MISTAKES = {
    "unknown key": ("runs: 20", "rums: 20", ":3: rums: unknown key; did you mean 'runs'?"),
    "missing key": ("seed: 5\n", "", ":1: seed: is missing"),
    "no number": ("runs: 20", "runs: many", ":3: runs: expected a whole number from 1 on, got 'many'"),
    "no scenario": ("youbot_velocity.yaml", "nowhere.yaml", ":5: scenario: no such file: "),
    "twice": ("seed: 5", "name: again", ":2: name: stands there twice"),
    "not YAML": ("{duration: 0.1}", "{duration: 0.1", ":7: not YAML"),
    "unknown distribution": ("{uniform: [0.2, 0.4]}", "{unifrom: [0.2, 0.4]}", "did you mean 'uniform'?"),
    "ends": (
        "[0.2, 0.4]",
        "[0.2]",
        ":8: let.wall.uniform: expected the two ends of an interval, [a, b], got 1",
    ),
    "order": ("[0.2, 0.4]", "[0.4, 0.2]", ":8: let.wall.uniform.1: 0.2 is below the other end, 0.4"),
    "logarithm": (
        "[1e-3, 4e-3]",
        "[0, 4e-3]",
        ":10: sample.dt.log_uniform.0: a logarithm needs a positive number",
    ),
    "formula": (
        "{value: wall}",
        "{value: 2 *}",
        ":12: sample.limits.joints.base_x.upper.value: '2 *' is not a",
    ),
    "name": ("{value: wall}", "{value: well}", "nothing drawn before is called 'well'; did you mean 'wall'?"),
    "code": ("{value: wall}", "{value: open('x')}", "'open('x')' is not understood"),
    "joint": (
        "initial.*",
        "initial.leg_*",
        ":13: sample.initial.leg_*: 'leg_*' is no joint; there are base_x",
    ),
    "rotation": (
        "rotation: uniform",
        "rotation: any",
        "expected uniform or {within: angle, of: [w, x, y, z]}",
    ),
    "scenario's key": ("dt:", "dd:", ":10: sample.dd: "),
    "scenario's value": ("0.5, {choice", "{choice", "expected 3 numbers, got 2"),
    "its line": ("0.5, {choice", "{choice", ":15: sample.tasks.position.target.position: "),
    "variant's value": ("method: chain", "method: chian", ":22: variants.chain.limits.method: chian: --set"),
    "value of set": ("duration: 0.1", "duration: long", ":6: set.duration: long: --set duration=long"),
    "no variant": (
        "[unilateral, chain]",
        "[unilateral, chair]",
        "nothing is called 'chair'; did you mean 'chain'?",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_file_line_key_and_what_would_be_right(tope, tmp_path, mistake):
    right, wrong, told = MISTAKES[mistake]
    text = QUICK.replace(right, wrong, 1)
    assert text != QUICK
    code, _, err = tope("sweep", campaign_file(tmp_path, text), "--workers", 0)
    assert code == 1
    assert err.startswith(f"tope: {tmp_path / 'campaign.yaml'}:")
    assert err.count("\n") == 1
    assert told in err


def test_a_folder_of_another_campaign_is_refused_with_what_differs(tope, tmp_path):
    tope("sweep", campaign_file(tmp_path), "--runs", 2, "--workers", 0, "--out", "out")
    changed = campaign_file(tmp_path, QUICK.replace("[0.2, 0.4]", "[0.2, 0.5]"))
    code, _, err = tope("sweep", changed, "--runs", 2, "--workers", 0, "--out", "out")
    assert code == 1
    assert 'let.wall was {"uniform": [0.2, 0.4]}, is {"uniform": [0.2, 0.5]}' in err


def test_a_scheduler_that_does_not_answer_is_one_line(tope, tmp_path, monkeypatch):
    monkeypatch.setattr("tope.sweep.CONNECT", "1 s")
    code, _, err = tope("sweep", campaign_file(tmp_path), "--scheduler", "tcp://127.0.0.1:9")
    assert code == 1
    assert "tcp://127.0.0.1:9: no Dask scheduler answers there" in err


def test_a_cluster_has_its_own_workers(tope, tmp_path):
    code, _, err = tope("sweep", campaign_file(tmp_path), "--scheduler", "tcp://127.0.0.1:9", "--workers", 2)
    assert code == 2
    assert "a cluster has its own workers" in err


def test_a_missing_package_is_named_with_what_installs_it(tope, tmp_path, monkeypatch):
    monkeypatch.delitem(sys.modules, "tope.sweep")
    monkeypatch.setitem(sys.modules, "distributed", None)
    code, _, err = tope("sweep", campaign_file(tmp_path))
    assert code == 1
    assert "sweeping needs the package distributed: install tope[sweep]" in err


# Rows


def test_a_sweep_leaves_a_row_for_every_run(quick):
    rows = parquet.read_table(quick.out / "runs.parquet").to_pylist()
    assert [row["run"] for row in rows] == list(range(40))
    assert {row["outcome"] for row in rows} == {"finished"}
    assert all(row["max_limit_violation"] < 0 for row in rows)
    assert all(row["let.wall"] == row["set.limits.joints.base_x.upper"] for row in rows)
    assert {row["set.tasks.position.reference.type"] for row in rows} == {"exponential", "predefined_time"}
    assert not any("time_us" in name or "seconds" in name for name in rows[0])


def test_a_replay_is_the_run_of_its_row(quick, tmp_path):
    row = quick.table.slice(11, 1).to_pylist()[0]
    run = replay(quick.campaign.file, 11, out=tmp_path / "replay")
    assert {name: row[name] for name in metrics(run.summary)} == metrics(run.summary)
    assert (tmp_path / "replay/report.html").exists()
    assert run.scenario["method"] == row["variant"] == "chain"


def test_the_command_of_a_worst_case_replays_it(tope, quick):
    page = (quick.out / "summary.html").read_text()
    _, sweep_, file, flag, number = re.search(r"<code>(tope sweep .* --replay \d+)</code>", page)[1].split()
    code, out, err = tope(sweep_, file, flag, number, "--out", "replayed")
    assert (code, err) == (0, "")
    assert "replayed/report.html" in out


def test_a_refused_scenario_is_a_row_with_its_message(tmp_path):
    text = QUICK.replace("{log_uniform: [1e-3, 4e-3]}", "{choice: [1e-3, 0.09]}").replace(
        "bound * dt", "0.01 * bound"
    )
    done = sweep(campaign_file(tmp_path, text), out=tmp_path / "out", workers=0)
    rows = done.table.to_pylist()
    refused = [row for row in rows if row["outcome"] == "refused"]
    assert 0 < len(refused) < 40
    assert all(row["set.dt"] == 0.09 and "limits are not safe" in row["message"] for row in refused)
    page = (tmp_path / "out/summary.html").read_text()
    assert "Runs without result" in page
    assert "limits are not safe" in page


def test_robots_modes_and_plants_can_be_drawn_too(tmp_path):
    text = f"""\
name: robots
seed: 1
runs: 10
chunk: 3
scenario: {SCENARIOS}/youbot_velocity.yaml
set: {{duration: 0.02, initial: {{}}, limits.joints: {{}}, limits.potential_field: {{}}}}
sample:
  robot:
    choice:
      - {{urdf: ../robots/youbot/youbot.urdf, config: ../robots/youbot/youbot.yaml}}
      - {{urdf: ../bench/robots/youbot_blocked.urdf}}
  initial.*: {{uniform: ["max(lower, -0.3) + buffer", "min(upper, 1) - buffer"]}}
variants:
  velocity: {{mode: velocity, plant: {{type: kinematic}}}}
  torque: {{mode: torque, plant: {{type: rigid_body}}}}
  mujoco: {{mode: torque, plant: {{type: mujoco, model: ../robots/youbot/youbot_rollers.xml}}}}
"""
    campaign = load_campaign(campaign_file(tmp_path, text))
    assert "file ../bench/robots/youbot_blocked.urdf" in campaign.content
    rows = sweep(campaign.file, out=tmp_path / "out", workers=0).table.to_pylist()
    for row in rows:
        blocked = row["set.robot.config"] is None
        assert row["outcome"] == ("refused" if blocked and row["variant"] == "mujoco" else "finished")
        assert (row["set.initial.arm1"] is None) != blocked
        assert (row["set.initial.arm_joint_1"] is None) == blocked


def test_a_finer_cycle_tells_jumps_from_slopes(tmp_path):
    file = campaign_file(tmp_path, QUICK.replace("chunk: 4", "chunk: 4\nrefine: 10"), runs=3)
    done = sweep(file, out=tmp_path / "out", workers=0)
    for row in done.table.to_pylist():
        assert row["jump_ratio"] == row["max_command_jump"] / row["fine.max_command_jump"]


def test_more_runs_go_on_with_those_that_are_done(tmp_path, quick):
    file = campaign_file(tmp_path)
    sweep(file, out=tmp_path / "out", runs=7, workers=0)
    first = tmp_path / "out/parts/part-00000000-00000003.parquet"
    before = first.stat().st_mtime_ns
    sweep(file, out=tmp_path / "out", workers=0)
    assert first.stat().st_mtime_ns == before
    assert (tmp_path / "out/runs.parquet").read_bytes() == (quick.out / "runs.parquet").read_bytes()


def test_a_crossed_limit_fails_the_sweep_if_it_must_not_be(tope, tmp_path):
    text = QUICK.replace("duration: 0.1", "duration: 3").replace(
        "{limits.method: chain}", "{limits.method: none}"
    )
    file = campaign_file(tmp_path, text, runs=5)
    code, out, _ = tope("sweep", file, "--workers", 0)
    assert code == 1
    assert re.search(r"[1-5] of 10 runs of unilateral, chain crossed a limit", out)


def test_tables_go_between_the_marks_of_a_file(tope, tmp_path):
    file = campaign_file(tmp_path, runs=3)
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- tope sweep campaign.yaml -->\nold\n<!-- end of tope sweep -->\nafter\n")
    code, _, _ = tope("sweep", file, "--workers", 0, "--markdown", page)
    assert code == 0
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("\nafter\n")
    assert "old" not in text
    assert "0 of 6 runs of `unilateral`, `chain` crossed a limit" in text
    page.write_text("no place")
    code, _, err = tope("sweep", file, "--workers", 0, "--markdown", page)
    assert code == 1
    assert "<!-- tope sweep campaign.yaml -->" in err


# Workers and kills


def test_a_worker_with_other_files_or_another_build_ends_the_sweep(tmp_path, monkeypatch):
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(
        (SCENARIOS / "youbot_velocity.yaml").read_text().replace("../robots", f"{SCENARIOS}/../robots")
    )
    campaign = load_campaign(campaign_file(tmp_path, scenario=scenario))
    check_worker(campaign)
    with monkeypatch.context() as patched:
        patched.setattr("tope.campaign_file.build", lambda: "another")
        with pytest.raises(_core.Error, match="has another build of tope"):
            run_chunk(campaign, 0, 1)
    scenario.write_text(scenario.read_text() + "# changed")
    with pytest.raises(_core.Error, match=r"scenario\.yaml: missing or different on the worker"):
        run_chunk(campaign, 0, 1)


def test_local_processes_give_the_bytes_of_one_process(tmp_path, quick):
    done = sweep(campaign_file(tmp_path), out=tmp_path / "out", workers=2)
    assert (done.out / "runs.parquet").read_bytes() == (quick.out / "runs.parquet").read_bytes()


@contextmanager
def started(command, **options):
    """A program in a group of its own, which is killed in the end."""
    process = subprocess.Popen(command, start_new_session=True, **options)
    try:
        yield process
    finally:
        kill_group(process)


def kill_group(process):
    """SIGKILL to the program and all that it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        return
    process.wait()


def wait_until(condition, what, seconds=40.0):
    """Poll until it holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"not in {seconds} s: {what}"
        time.sleep(0.005)


def parts(out):
    """The chunks that are done."""
    return sorted((out / "parts").glob("*.parquet"))


def workers_of(process):
    """The processes in which runs are computed."""
    children = psutil.Process(process.pid).children()
    return [each for each in children if "spawn_main" in " ".join(each.cmdline())]


def test_a_killed_worker_changes_no_byte(slow, tmp_path):
    file, whole = slow
    out = tmp_path / "out"
    with started(
        [*TOPE, "sweep", file, "--workers", "2", "--out", out], stdout=subprocess.DEVNULL
    ) as process:
        wait_until(lambda: len(parts(out)) >= 2, "two chunks")
        workers_of(process)[0].kill()
        done = len(parts(out))
        assert process.wait(timeout=60) == 0
    assert done < 40
    assert (out / "runs.parquet").read_bytes() == whole


def test_a_sweep_killed_half_way_and_resumed_gives_the_same_bytes(slow, tmp_path):
    file, whole = slow
    out = tmp_path / "out"
    with started(
        [*TOPE, "sweep", file, "--workers", "2", "--out", out], stdout=subprocess.DEVNULL
    ) as process:
        wait_until(lambda: len(parts(out)) >= 2, "two chunks")
        workers_of(process)[0].kill()
        done = len(parts(out))
        wait_until(lambda: len(parts(out)) >= done + 2, "two more chunks")
        kill_group(process)
    kept = {part: part.stat().st_mtime_ns for part in parts(out)}
    assert 4 <= len(kept) < 40
    assert not (out / "runs.parquet").exists()
    sweep(file, out=out, workers=0)
    assert {part: part.stat().st_mtime_ns for part in kept} == kept
    assert (out / "runs.parquet").read_bytes() == whole


def scheduler_of(file):
    """The address that a scheduler wrote to a file."""
    address = json.loads(file.read_text())["address"]
    assert address.startswith("tcp://127.0.0.1:")
    return address


def test_a_cluster_over_tcp_gives_the_bytes_of_one_process(tmp_path, quick, monkeypatch):
    address = tmp_path / "scheduler.json"
    shared = ["--scheduler-file", str(address), "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    scheduler = [*DASK, "scheduler", "--host", "127.0.0.1", "--port", "0", *shared]
    worker = [*DASK, "worker", "--host", "127.0.0.1", "--nthreads", "1", *shared]
    with started(scheduler, **quiet):
        wait_until(address.exists, "a scheduler")
        monkeypatch.setattr("tope.sweep.JOIN", 0.5)
        with pytest.raises(_core.Error, match="it has no worker, and none came"):
            sweep(campaign_file(tmp_path), out=tmp_path / "out", scheduler=scheduler_of(address))
        monkeypatch.undo()
        with started(worker, **quiet), started(worker, **quiet):
            done = sweep(campaign_file(tmp_path), out=tmp_path / "out", scheduler=scheduler_of(address))
    assert (done.out / "runs.parquet").read_bytes() == (quick.out / "runs.parquet").read_bytes()
