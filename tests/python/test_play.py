"""The live page: clients that speak its protocol, the session behind it, the command line, a browser.

Not covered here: dragging with a real pointer, which is viser's own.
"""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from kinematics import frames, placement
from live_client import LiveClient, wait_for

from tope import _core
from tope.play import Page
from tope.session import Session

ROOT = Path(__file__).parents[2]
VELOCITY = str(ROOT / "scenarios/youbot_velocity.yaml")
TORQUE = str(ROOT / "scenarios/youbot_torque.yaml")
WXYZ = [0.0397, 0.9811, 0.1867, -0.0322]  # of the scenario's goal
NEAR, FAR = [0.45, 0.05, 0.15], [0.55, -0.05, 0.12]  # goals within reach [m]


@pytest.fixture
def session():
    running = Session(VELOCITY, {})
    yield running
    running.close()


@pytest.fixture
def page(session):
    shown = Page(session, "127.0.0.1", 0)
    yield shown
    shown.close()


def client_of(page):
    return LiveClient(page.server.get_port())


def seen_end_effector(client):
    """Where the end-effector is on a client's screen [m]."""
    path = next(name for name in list(client.placements) if name.endswith("/ee"))
    world = pinocchio.SE3.Identity()
    parts = path.split("/")
    for end in range(3, len(parts) + 1):
        step = client.placements["/".join(parts[:end])]
        w, *xyz = step["wxyz"]
        world = world * placement(step["position"], [*xyz, w])
    return world.translation


def is_at(client, goal):
    return lambda: np.linalg.norm(seen_end_effector(client) - goal) < 0.01


def test_the_simulation_keeps_real_time_at_a_kilohertz(session):
    start, begin = session.state().time, time.perf_counter()
    time.sleep(1.5)
    ran, took = session.state().time - start, time.perf_counter() - begin
    assert ran == pytest.approx(took, abs=0.05)
    assert session.scenario["dt"] == 1e-3
    assert session.state().lost == 0


def test_two_clients_see_one_robot_follow_the_goal_that_either_moves(page):
    one, two = client_of(page), client_of(page)
    one.drag("/goal/ee", NEAR, WXYZ)
    one.wait_for(is_at(one, NEAR))
    two.wait_for(is_at(two, NEAR))
    two.drag("/goal/ee", FAR, WXYZ)
    one.wait_for(is_at(one, FAR))
    two.wait_for(is_at(two, FAR))
    one.wait_for(lambda: one.placements["/goal/ee"]["position"] == pytest.approx(FAR))  # its handle too


def test_what_clients_see_is_where_pinocchio_says_the_robot_is(page, session):
    client = client_of(page)
    client.set("Pause", True)
    wait_for(lambda: session.paused)
    time.sleep(0.3)
    names = [joint["name"] for joint in session.scenario["joints"]]
    expected = frames(dict(zip(names, session.state().position, strict=True)))["ee"].translation
    np.testing.assert_allclose(seen_end_effector(client), expected, atol=1e-6)


def test_the_method_is_switched_for_all_and_the_robot_follows(page, session):
    one, two = client_of(page), client_of(page)
    one.set("limits.method", "none")
    two.wait_for(lambda: two.value("limits.method") == "none")
    two.wait_for(lambda: two.reads("· none ·"))
    two.wait_for(lambda: two.reads("Note: Joint limits are not kept"))
    two.set("Restart", True)
    wait_for(lambda: session.state().position[0] > 0.36)  # through the obstacle at 0.35 m
    two.set("limits.method", "unilateral")
    one.wait_for(lambda: one.reads("· unilateral ·"))
    wait_for(lambda: session.state().position[0] < 0.35)  # led back


def test_an_obstacle_that_is_pushed_moves_the_robot(page, session):
    client = client_of(page)
    wait_for(lambda: session.state().position[0] > 0.3)
    client.drag("/obstacle/base_x_upper", [0.515, 0.0, 0.0225], [1.0, 0.0, 0.0, 0.0])  # 0.15 m closer
    wait_for(lambda: session.state().position[0] < 0.21)
    upper = next(joint["upper"] for joint in session.scenario["joints"] if joint["name"] == "base_x")
    assert upper == pytest.approx(0.2, abs=1e-6)


def test_an_obstacle_stands_where_its_limit_is(page, session):
    client = client_of(page)
    client.set("base_x [m]", [-2.0, 0.2])
    kerb = client.placements["/obstacle/base_x_upper"]
    client.wait_for(lambda: kerb["position"][0] == pytest.approx(0.515))
    client.drag("/obstacle/base_x_upper", [9.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0])
    wait_for(lambda: session.scenario["joints"][0]["upper"] > 8)


def test_a_limit_is_pulled_in(page, session):
    client = client_of(page)
    client.set("arm_joint_2 [rad]", [-1.117, 0.5])
    wait_for(lambda: session.scenario["joints"][4]["upper"] == 0.5)
    assert session.scenario["joints"][4]["lower"] == -1.117011  # as it was
    t = session.state().time
    wait_for(lambda: session.state().time > t + 2)
    assert session.state().position[4] < 0.5  # it would end at 0.99 rad


def test_tasks_leave_and_enter_and_gains_change(page, session):
    client = client_of(page)
    client.set("3. position", False)
    client.wait_for(lambda: client.reads("error of position: not present"))
    assert session.state().errors["position"] is None
    assert session.state().errors["orientation"] is not None
    client.set("3. position", True)
    client.drag("/goal/ee", NEAR, WXYZ)
    client.wait_for(is_at(client, NEAR))
    client.set("gain of position", 5.5)
    wait_for(lambda: session.scenario["tasks"][1]["gain"] == 5.5)


def test_an_unsafe_change_is_refused_in_words_and_changes_nothing(page, session):
    client = client_of(page)
    client.set("limits.gain", 5000.0)  # leaps over the limit in one cycle of a millisecond
    client.wait_for(lambda: client.reads("Not changed:"))
    assert session.scenario["limit_gain"] == 10.0
    client.wait_for(lambda: client.value("limits.gain") == 10.0)  # the slider goes back
    client.set("limits.buffer", 0.05)
    wait_for(lambda: session.scenario["joints"][0]["buffer"] == 0.05)
    client.wait_for(lambda: not client.reads("Not changed:"))


def test_a_client_that_vanishes_disturbs_nobody(page, session):
    gone, stays = client_of(page), client_of(page)
    gone.vanish()
    heard, t = stays.heard, session.state().time
    stays.drag("/goal/ee", NEAR, WXYZ)
    stays.wait_for(is_at(stays, NEAR))
    assert stays.heard > heard
    assert session.state().time > t
    client_of(page).wait_for(lambda: True)  # another can come


def test_restart_keeps_goals_and_absent_tasks(session):
    session.put_goal("ee", NEAR, WXYZ)
    session.show_task("orientation", False)
    wait_for(lambda: session.state().time > 0.3)
    session.restart()
    state = session.state()
    assert state.time < 0.3
    assert state.errors["orientation"] is None
    np.testing.assert_allclose(state.goals["ee"][0], NEAR)


@pytest.mark.parametrize(("key", "value"), [("mode", "torque"), ("dt", 5e-4), ("limits.method", "chian")])
def test_what_cannot_change_is_refused(session, key, value):
    before = dict(session.overrides)
    with pytest.raises(_core.ConfigError):
        session.change({key: value})
    assert session.overrides == before
    t = session.state().time
    wait_for(lambda: session.state().time > t + 0.05)


def test_torque_mode_follows_too():
    session = Session(TORQUE, {})
    try:
        session.put_goal("ee", NEAR, WXYZ)
        wait_for(lambda: session.state().errors["position"] < 0.01, seconds=15)
        assert np.abs(session.state().command).max() > 0.1  # it carries itself
    finally:
        session.close()


def test_a_port_in_use_is_one_line(tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        done = subprocess.run(tope("--port", port), capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 1
    assert done.stderr == (
        f"tope: cannot serve 127.0.0.1:{port}: Address already in use; choose another with --port\n"
    )


def tope(*arguments):
    return [sys.executable, "-m", "tope.cli", "play", VELOCITY, *arguments]


@pytest.fixture
def interrupts_ignored():
    """As for a shell's background jobs; processes started meanwhile inherit it."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interrupts_ignored")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_command_line_serves_this_machine_alone_and_ends_on_a_signal(number):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with subprocess.Popen(tope("--port", str(port)), stdout=subprocess.PIPE, text=True) as process:
        try:
            wait_for(lambda: process.stdout.readline().startswith("Open"), seconds=30)
            with urllib.request.urlopen(f"http://127.0.0.1:{port}") as answer:
                assert b"<html" in answer.read()
            sockets = [line.split()[1] for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
            assert [s for s in sockets if s.endswith(f":{port:04X}") and s[:8] != "0100007F"] == []
            process.send_signal(number)
            assert process.wait(20) == 0
        finally:
            process.kill()


def test_a_browser_draws_the_page_without_any_other_network(browser, page):
    tab = browser.open(page.address)
    tab.wait_for("document.body.innerText.includes('limits.method')", seconds=30)
    own = page.address.removeprefix("http://")
    assert [url for url in tab.requests if own not in url] == []
    tab.close()
