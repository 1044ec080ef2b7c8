"""The benchmark beside other libraries: what is collected, what is said, and the loop all go through.

Nothing here needs another library. Not covered: the programs of the peers, and tope's C++ one.
"""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from tope import _core, peers
from tope.cli import main

BENCH = Path(__file__).parents[2] / "bench"
sys.path.insert(0, str(BENCH / "peers"))

import closed_loop  # noqa: E402
import geometry  # noqa: E402
import scenario  # noqa: E402
from rigid_body import RigidBody  # noqa: E402
from tope_peer import Tope  # noqa: E402


@pytest.fixture(scope="module")
def setups(tmp_path_factory):
    """The scenario of each mode, short, with two random goals."""
    folder = tmp_path_factory.mktemp("scenario")
    read = {}
    for mode in peers.MODES:
        read[mode] = closed_loop.read(scenario.write(folder, mode, goals=2, repeats=1))
        read[mode].duration = 0.3
    return read


class Scripted(closed_loop.Peer):
    """A peer that gives the commands it is told to, None for a failure."""

    package = "tope"
    priorities = "none"
    settings = "none"

    def __init__(self, commands):
        self.commands = commands

    def start(self, goal, dt):
        self.left = iter(self.commands)

    def command(self, q, v):
        u = next(self.left)
        if u is None:
            raise closed_loop.NoCommandError("told to")
        return np.array(u, dtype=float)


def along(joint, *speeds):
    """Velocities of one joint, one a cycle."""
    return [None if speed is None else [speed if i == joint else 0.0 for i in range(8)] for speed in speeds]


def scripted(setup, commands):
    setup = dataclasses.replace(setup, duration=len(commands) * setup.dt)
    return closed_loop.run(Scripted(commands), setup, "near", setup.dt)


def some_run(goal, dt=1e-3, **changes):
    run = {
        "goal": goal,
        "dt": dt,
        "cycles": 100,
        "failures": 0,
        "gave_up": False,
        "violation": -0.1,
        "speed_excess": -0.5,
        "command_excess": -0.5,
        "jump": 0.01,
        "position_error": 2e-3,
        "orientation_error": 1e-4,
    }
    return run | changes


def measured(name="tope", language="C++", mode="velocity", configuration="unilateral", p50=4.0, **runs):
    """What a program prints, collected."""
    program = {
        "package": name,
        "version": "1.2",
        "language": language,
        "priorities": "strict levels",
        "settings": "defaults",
        "p50_us": p50,
        "p99_us": 2 * p50,
        "runs": [
            some_run("near"),
            some_run("near", 1e-4, jump=0.001),
            some_run("main", jump=0.02),
            some_run("main", 1e-4, jump=0.004),
            some_run("goal_0", jump=0.5, **runs),
            some_run("goal_10", jump=0.3, orientation_error=0.2),
        ],
    }
    about = {"name": name, "language": language, "mode": mode, "configuration": configuration}
    return about | peers.collected(program)


def test_the_scenario_is_the_robot_with_its_obstacle(setups):
    setup = setups["torque"]
    robot = _core.Robot.from_urdf(setup.urdf, setup.config)
    whole = _core.Robot.from_urdf(scenario.ROBOT / "youbot.urdf", scenario.ROBOT / "youbot.yaml")
    assert robot.joint_names == whole.joint_names == [joint.name for joint in setup.joints]
    upper = whole.position_upper.copy()
    upper[0] = 0.35
    finite = np.isfinite(upper)  # all but the yaw
    np.testing.assert_array_equal(setup.upper[finite], upper[finite])
    np.testing.assert_array_equal(setup.upper, robot.position_upper)
    np.testing.assert_array_equal(setup.velocity, whole.velocity_limit)
    np.testing.assert_array_equal(setup.effort, whole.effort_limit)


def test_the_plant_moves_as_topes_own(setups):
    """Its rotor inertias are those that tope derives from the wheels: torques do what was asked for."""
    setup = setups["torque"]
    whole = _core.Robot.from_urdf(scenario.ROBOT / "youbot.urdf", scenario.ROBOT / "youbot.yaml")
    controllers = [
        _core.Controller(robot, mode="torque", dt=1e-3, limits=_core.LimitOptions(method="none"))
        for robot in (whole, _core.Robot.from_urdf(setup.urdf, setup.config))
    ]
    target = setup.start + 0.01
    for controller in controllers:
        controller.add(_core.Posture(target=target, reference=_core.Exponential(gain=2.0)), level=1)
    torques = [controller.update(setup.start, np.zeros(8), 0.0) for controller in controllers]
    np.testing.assert_allclose(torques[1], torques[0], atol=1e-9)
    acceleration = RigidBody(setup).acceleration(setup.start, np.zeros(8), torques[0])
    np.testing.assert_allclose(acceleration, np.full(8, 2.0**2 * 0.01), rtol=1e-6)


def test_kinematics_agree_with_tope(setups):
    setup = setups["velocity"]
    q = setup.start + np.linspace(-0.2, 0.3, 8)
    here = geometry.forward(setup.joints, setup.tip, q)
    controller = _core.Controller(_core.Robot.from_urdf(setup.urdf, setup.config), mode="velocity", dt=1e-3)
    handles = [
        controller.add(_core.FrameOrientation(frame="ee", target=here.rotation), level=1),
        controller.add(_core.FramePosition(frame="ee", target=here.position), level=2),
    ]
    controller.update(q, np.zeros(8), 0.0)
    assert max(np.abs(controller.error(handle)).max() for handle in handles) < 1e-12


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, 3.0, math.pi - 5e-6, math.pi])
def test_rotation_vectors_come_back(angle):
    axis = np.array([2.0, -3.0, 6.0]) / 7
    back = geometry.log3(geometry.exp3(angle * axis))
    np.testing.assert_allclose(geometry.exp3(back), geometry.exp3(angle * axis), atol=1e-8)
    assert np.linalg.norm(back) == pytest.approx(angle, abs=1e-8)


def test_a_target_is_kept_near():
    here, goal = np.eye(3), geometry.exp3(np.array([0, 0, 2.0]))
    np.testing.assert_allclose(geometry.towards(here, goal, 0.75), geometry.exp3(np.array([0, 0, 0.75])))
    np.testing.assert_array_equal(geometry.towards(here, goal, 2.5), goal)


def test_goals_are_evenly_taken():
    start = geometry.Pose(np.eye(3), np.zeros(3))
    few, all_of_them = scenario.targets(start, 4), scenario.targets(start, 200)
    assert list(few) == ["near", "main", "goal_0", "goal_50", "goal_100", "goal_150"]
    assert len(all_of_them) == 202
    np.testing.assert_array_equal(few["goal_50"].position, all_of_them["goal_50"].position)


def test_what_a_run_reports(setups):
    setup = setups["velocity"]
    result, times = scripted(setup, along(0, 0.0, 0.4, 0.8, -0.8))
    assert result["jump"] == pytest.approx(2.0)  # from one bound to the other
    assert result["speed_excess"] == pytest.approx(0.0)
    assert result["violation"] == pytest.approx((0.0 + 0.4 + 0.8) * setup.dt - 0.35)
    assert (result["failures"], result["gave_up"], len(times)) == (0, False, 4)
    beside = geometry.forward(setup.joints, setup.tip, setup.start)
    wanted = setup.goals["near"].position - beside.position - np.array([0.4 * setup.dt, 0, 0])
    assert result["position_error"] == pytest.approx(np.linalg.norm(wanted))
    assert result["orientation_error"] == pytest.approx(scenario.TURN)


def test_a_crossed_limit_counts_as_positive(setups):
    result, _ = scripted(setups["velocity"], along(0, 300.0, 300.0))
    assert result["violation"] == pytest.approx(0.6 - 0.35)
    assert result["speed_excess"] == pytest.approx(300 / 0.8 - 1)


def test_a_failure_is_counted_and_makes_no_jump(setups):
    result, _ = scripted(setups["velocity"], along(0, 0.4, None, 0.4, math.nan, 0.4))
    assert (result["failures"], result["jump"]) == (2, 0.0)
    assert result["reasons"] == {
        "NoCommandError: told to": 1,
        "NoCommandError: the command is not finite": 1,
    }


def test_a_run_ends_after_failures_in_a_row(setups):
    result, _ = scripted(setups["velocity"], along(0, *[None] * 400))
    assert (result["gave_up"], result["cycles"], result["failures"]) == (True, 200, 200)


@pytest.mark.parametrize("mode", peers.MODES)
@pytest.mark.parametrize("method", ["unilateral", "chain"])
def test_tope_goes_through_the_loop(setups, mode, method):
    setup = setups[mode]
    plant = RigidBody(setup) if setup.torque else None
    figures = closed_loop.measure(Tope(setup, method), setup, plant)
    summed = peers.collected(json.loads(json.dumps(figures)))
    assert (summed["version"], summed["language"]) == (version("tope"), "Python")
    assert (summed["failures"], summed["goals"], set(summed["final"])) == (0, 2, {"near", "main"})
    assert summed["violation"] < 0
    assert summed["jump_ratio"] > 8
    assert summed["speed_excess"] <= 1e-9
    assert 0 < summed["p50_us"] <= summed["p99_us"]
    for final in summed["final"].values():
        assert final["orientation"] < scenario.TURN - 1e-3  # it has come nearer


def test_tope_reaches_the_near_goal_alone(setups):
    setup = dataclasses.replace(setups["velocity"], duration=5.0)
    near, _ = closed_loop.run(Tope(setup, "unilateral"), setup, "near", 5e-3)
    main_goal, _ = closed_loop.run(Tope(setup, "unilateral"), setup, "main", 5e-3)
    assert max(near["position_error"], near["orientation_error"], main_goal["orientation_error"]) < 1e-3
    assert main_goal["position_error"] > 0.1


def test_runs_are_summed_up():
    peer = measured(violation=0.01, failures=3, gave_up=True)
    assert (peer["jump"], peer["fine_jump"], peer["jump_ratio"]) == (0.02, 0.004, 5.0)
    assert (peer["violation"], peer["failures"], peer["failed_runs"], peer["gave_up"]) == (0.01, 3, 1, 1)
    assert (peer["goals"], peer["oriented"], peer["reached"]) == (2, 1, 0)
    assert peer["final"]["near"] == {"position": 2e-3, "orientation": 1e-4}


def test_a_row_tells_what_was_measured():
    row = dict(zip(peers.HEADER, peers.row(measured(violation=0.01, failures=3)), strict=True))
    assert row["library"] == "tope 1.2, C++: unilateral"
    assert row["cycle p50, p99"] == "4.0, 8.0 µs"
    assert (row["jump at 1 ms"], row["0.1 ms"], row["goals, 1 ms"]) == ("2 %", "0.4 %", "40 %")
    assert row["limit crossed by"] == "1.0e-02"
    assert row["near goal missed by"] == "2.0 mm, 0.1 mrad"
    assert (row["oriented"], row["failed cycles, runs"]) == ("1 of 2", "3, 1 of 4")


def test_order_and_verdicts_go_by_cost():
    found = [
        measured("slow", p50=9.0),
        measured("quick", p50=2.0),
        measured("python", "Python", p50=1.0),
        measured(p50=4.0),
        measured(configuration="chain", p50=1.5),
        {"name": "gone", "language": "C++", "mode": "velocity", "absent": "not installed: make peers"},
    ]
    names = [(peer["name"], peer["configuration"]) for peer in peers.in_order(found, "velocity")]
    assert names[:4] == [
        ("tope", "chain"),
        ("tope", "unilateral"),
        ("quick", "unilateral"),
        ("slow", "unilateral"),
    ]
    assert peers.verdicts(found) == [
        "velocity, C++: tope 4.0 µs against 2.0 µs of quick (unilateral), 0.50 times as fast"
    ]


def test_tables_of_all_and_of_the_cheapest(tmp_path):
    found = [measured(p50=4.0), measured(configuration="chain", p50=3.0)]
    found += [measured("other", configuration=name, p50=cost) for name, cost in (("a", 6.0), ("b", 5.0))]
    file = tmp_path / "README.md"
    marks = [peers.BEGIN.format(which=which) for which in ("cheapest", "all")]
    file.write_text(f"{marks[0]}\n{peers.END}\nbetween\n{marks[1]}\n{peers.END}\n")
    peers.put_markdown(file, peers.markdown(found, "abacus"))
    few, everything = file.read_text().split("between")
    assert ["chain" in few, "other 1.2, C++: a" in few, "other 1.2, C++: b" in few] == [False, False, True]
    assert ["chain" in everything, "other 1.2, C++: a" in everything] == [True, True]
    assert everything.index("unilateral") < everything.index("other")


def test_what_is_not_installed_is_said_to_be_absent(tmp_path, monkeypatch):
    monkeypatch.setattr(peers, "ENVIRONMENTS", tmp_path)
    program = peers.Program("placo", "Python", "velocity", "weights")
    assert peers.measure(program, tmp_path)["absent"] == "not installed: make peers"
    (tmp_path / "placo").mkdir()
    (tmp_path / "placo" / "absent.txt").write_text("no wheel for this machine\n")
    found = [peers.measure(program, tmp_path)]
    assert peers.absences(found) == ["placo, Python: not installed: no wheel for this machine"]
    assert peers.in_order(found, "velocity") == []


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import sys; sys.exit('the solver is gone')", "ended with code 1: the solver is gone"),
        ("import os; os.kill(os.getpid(), 11)", "ended with code -11: it said nothing"),
        ("import time; time.sleep(60)", "stopped after 1 s"),
    ],
)
def test_a_program_that_ends_badly_ends_nothing_else(tmp_path, monkeypatch, source, reason):
    (tmp_path / "tope_peer.py").write_text(source)
    monkeypatch.setattr(peers, "FOLDER", tmp_path)
    monkeypatch.setattr(peers, "TIMEOUT", 1)
    result = peers.measure(peers.Program("tope", "Python", "velocity", "chain"), tmp_path)
    assert result["absent"] == reason


def test_every_program_has_its_source_and_pins():
    for program in peers.programs():
        if program.language == "Python":
            assert program.file.is_file()
        else:
            assert (BENCH / "peers" / "cpp" / f"{program.name}.cpp").is_file()
        if program.name != "tope":
            pins = (BENCH / "peers" / "requirements" / f"{program.name}.txt").read_text()
            assert "==" in pins


@pytest.fixture
def quick_bench(monkeypatch):
    """The command without its measurements."""
    machine = {"processor": "abacus", "core": 1}
    monkeypatch.setattr("tope.cli.time_cycles", lambda *_: {"machine": machine, "cases": [], "peers": []})
    asked = []

    def measure(goals, progress):
        asked.append(goals)
        absent = {"name": "gone", "language": "Python", "mode": "torque", "absent": "no wheel"}
        return [measured(), measured("other", p50=5.0), absent]

    monkeypatch.setattr("tope.peers.measure_peers", measure)
    return asked


def run(*arguments):
    with pytest.raises(SystemExit) as stopped:
        main(["bench", *arguments])
    return stopped.value.code


def test_the_command_prints_and_writes(quick_bench, tmp_path, capsys):
    readme = tmp_path / "README.md"
    begin = peers.BEGIN.format(which="all")
    readme.write_text(f"before\n{begin}\nold\n{peers.END}\nafter\n")
    figures = tmp_path / "new" / "bench.json"
    assert not run("--peers", "--goals", "7", "--json", str(figures), "--markdown", str(readme))
    assert quick_bench == [7]
    said = capsys.readouterr().out
    assert "tope 4.0 µs against 5.0 µs of other (unilateral), 1.25 times as fast" in said
    assert "Not measured: gone, Python: no wheel" in said
    assert len(json.loads(figures.read_text())["peers"]) == 3
    written = readme.read_text()
    assert written.startswith(f"before\n{begin}\n")
    assert written.endswith(f"\n{peers.END}\nafter\n")
    assert "old" not in written
    assert "| **tope 1.2, C++: unilateral** | strict levels | 4.0, 8.0 µs |" in written
    assert "abacus" in written


def test_peers_are_measured_only_when_asked(quick_bench, tmp_path):
    assert not run()
    assert quick_bench == []
    assert run("--markdown", str(tmp_path / "README.md")) == 2


def test_tables_need_their_place(quick_bench, tmp_path):
    file = tmp_path / "README.md"
    file.write_text("nothing\n")
    with pytest.raises(_core.Error, match=r"no place for the tables.*'<!-- tope bench --peers: all -->'"):
        peers.check_marks(file)
    assert run("--peers", "--markdown", str(file)) not in (0, None)
    assert quick_bench == []  # before anything is measured
    assert file.read_text() == "nothing\n"


def test_the_installer_leaves_the_reason(tmp_path, monkeypatch, capsys):
    import install  # noqa: PLC0415

    (tmp_path / "requirements").mkdir()
    (tmp_path / "requirements" / "none.txt").write_text(f"{tmp_path / 'no-such-wheel.whl'}\n")
    monkeypatch.setattr(install, "HERE", tmp_path)
    monkeypatch.setattr(install, "ENVIRONMENTS", tmp_path / "environments")
    monkeypatch.setattr(sys, "argv", ["install.py"])
    install.main()
    assert capsys.readouterr().out.startswith("none: absent: ERROR")
    assert "no-such-wheel" in (tmp_path / "environments" / "none" / "absent.txt").read_text()


def test_the_scenario_program_writes_both_modes(tmp_path):
    subprocess.run([sys.executable, BENCH / "peers" / "scenario.py", tmp_path, "--goals", "1"], check=True)
    assert {file.name for file in tmp_path.iterdir()} == {
        "velocity.txt",
        "torque.txt",
        "youbot.urdf",
        "youbot.yaml",
    }
