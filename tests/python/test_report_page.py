"""The report's page in a real browser: replay against Pinocchio's kinematics, linked plots, controls.

Not covered here: whether it is pleasant to look at (docs/report-*.png are looked at), other browsers, touch.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from kinematics import frames, placement
from PIL import Image
from test_report import make_run

from tope.compare import compare
from tope.report import write_comparison_report, write_run_report
from tope.simulation import load_run, simulate

ROOT = Path(__file__).parents[2]
VELOCITY = ROOT / "scenarios/youbot_velocity.yaml"
TORQUE = ROOT / "scenarios/youbot_torque.yaml"
LINKS = ("base_link", "arm_link_1", "arm_link_3", "arm_link_5", "gripper_finger_l_link", "ee")
PHONE = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("run")
    simulate(VELOCITY, out=out, overrides={"duration": 3.0})
    return out


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    """The folder and the runs of a comparison of three ways to keep limits."""
    out = tmp_path_factory.mktemp("compare")
    runs = compare(VELOCITY, limits=["unilateral", "chain", "switch"], out=out, overrides={"duration": 1.5})
    return out, runs


@pytest.fixture
def page(browser, folder):
    """The page of a run on a laptop; it must never complain or ask any network for anything."""
    yield from checked(browser.open(report(folder)))


@pytest.fixture
def overlay(browser, comparison):
    """The page of a comparison."""
    yield from checked(browser.open(report(comparison[0])))


def checked(page):
    yield page
    page.settle()
    assert page.complaints == []
    assert page.requests == []
    page.close()


def report(folder):
    return (folder / "report.html").as_uri()


def check_links(page, run, t, number=0):
    page.run(f"tope.setTime({t})")
    row = int(np.argmin(np.abs(run.time - t)))
    names = [joint["name"] for joint in run.scenario["joints"]]
    expected = frames({name: run.log[f"q.{name}"][row] for name in names})
    for link in LINKS:
        pose = page.run(f"tope.linkPose('{link}', {number})")
        found = placement(pose["position"], pose["quaternion"])
        np.testing.assert_allclose(found.translation, expected[link].translation, atol=1e-3, err_msg=link)
        np.testing.assert_allclose(found.rotation, expected[link].rotation, atol=2e-3, err_msg=link)


@pytest.mark.parametrize("t", [0.0, 0.412, 0.9, 1.705, 3.0])
def test_the_replay_moves_the_links_where_forward_kinematics_says(page, folder, t):
    check_links(page, load_run(folder), t)


def test_every_run_of_a_comparison_is_replayed_as_it_was(overlay, comparison):
    for number, run in enumerate(comparison[1].values()):
        check_links(overlay, run, 1.2, number)


def test_torque_mode_has_a_replay_too(browser, tmp_path):
    run = simulate(TORQUE, out=tmp_path, overrides={"duration": 1.0})
    for page in checked(browser.open(report(tmp_path))):
        check_links(page, run, 0.777)


def test_goals_stand_where_the_scenario_puts_them(page):
    assert page.run("tope.goalPosition('ee')") == pytest.approx([0.640, 0.105, 0.068], abs=1e-4)


def test_a_moving_goal_moves(browser, tmp_path):
    scenario = tmp_path / "moving.yaml"
    text = VELOCITY.read_text().replace("../robots", f"{ROOT}/robots")
    scenario.write_text(
        text.replace("[0.640, 0.105, 0.068]}", "[0.5, 0.1, 0.1], velocity: [0.02, -0.01, 0.03]}")
    )
    simulate(scenario, out=tmp_path / "out", overrides={"duration": 1.0})
    for page in checked(browser.open(report(tmp_path / "out"))):
        page.run("tope.setTime(0.8)")
        assert page.run("tope.goalPosition('ee')") == pytest.approx([0.516, 0.092, 0.124], abs=1e-4)


def test_the_slider_moves_robot_and_cursors(page):
    page.run(
        "(() => { const s = document.getElementById('time'); s.value = 1.25;"
        " s.dispatchEvent(new Event('input', {bubbles: true})); })()"
    )
    page.settle(2)
    assert page.run("tope.time()") == pytest.approx(1.25)
    cursors = page.run("tope.cursorTimes()")
    assert len(cursors) >= 2
    assert cursors == pytest.approx([1.25] * len(cursors), abs=0.02)  # a pixel is 0.01 s
    assert page.run("document.getElementById('now').textContent") == "1.25 s"


def test_pointing_at_a_plot_moves_slider_and_the_other_cursors(page):
    x, y = page.middle_of("#panel-0 .u-over")
    page.mouse("Moved", x, y)
    page.settle(2)
    shown = page.run("Number(document.getElementById('time').value)")
    assert shown == pytest.approx(1.5, abs=0.02)  # the middle of 3 s
    assert page.run("tope.time()") == pytest.approx(shown)
    cursors = page.run("tope.cursorTimes()")
    assert len(cursors) >= 2
    assert cursors == pytest.approx([shown] * len(cursors), abs=0.02)


def test_readouts_tell_the_values_at_the_moment(page, folder):
    run = load_run(folder)
    page.middle_of("#panel-0 .u-over")
    page.run("tope.setTime(0.9)")
    said = float(page.run("document.querySelector('#panel-0 output').textContent"))
    assert said == pytest.approx(np.interp(0.9, run.time, run.log["q.base_x"]), abs=2e-3)


def test_dragging_over_a_plot_zooms_all_and_a_button_shows_all(page):
    x, y = page.middle_of("#panel-0 .u-over")
    width = page.run("document.querySelector('#panel-0 .u-over').clientWidth")
    page.mouse("Moved", x - width / 4, y)
    page.mouse("Pressed", x - width / 4, y)
    page.mouse("Moved", x, y, held=True)
    page.mouse("Moved", x + width / 4, y, held=True)
    page.mouse("Released", x + width / 4, y)
    page.settle(2)
    assert page.run("tope.plotRange()") == pytest.approx([0.75, 2.25], abs=0.05)
    page.click("#whole")
    assert page.run("tope.plotRange()") == [0, 3]


def test_keys_play_and_step(page):
    page.press("ArrowRight")
    assert page.run("tope.time()") == pytest.approx(0.05)
    page.press("ArrowRight", shift=True)
    assert page.run("tope.time()") == pytest.approx(0.55)
    page.press("ArrowLeft")
    assert page.run("tope.time()") == pytest.approx(0.5)
    page.press("End")
    assert page.run("tope.time()") == pytest.approx(3.0)
    page.press("Home")
    page.press(" ")
    assert page.run("tope.playing()")
    page.wait_for("tope.time() > 0.2")
    page.press(" ")
    assert not page.run("tope.playing()")


def test_playback_runs_at_the_chosen_speed_and_stops_at_the_end(page):
    page.run(
        "(s => { s.value = '2'; s.dispatchEvent(new Event('change')); })(document.getElementById('speed'))"
    )
    page.run("tope.setTime(1)")
    page.run("document.getElementById('play').click()")
    rate = page.run(  # by the browser's own frame times, so that a slow machine does not matter
        "new Promise(done => { const seen = []; requestAnimationFrame(function look(now) {"
        " if (tope.playing()) { seen.push([now, tope.time()]); requestAnimationFrame(look); return; }"
        " const [[t0, from], [t1, to]] = [seen[0], seen.at(-1)];"
        " done((to - from) / (t1 - t0) * 1000); }); })"
    )
    assert rate == pytest.approx(2.0, rel=0.01)
    assert page.run("tope.time()") == 3


def test_focus_is_visible_and_every_control_has_a_name(page):
    page.press("Tab")
    assert page.run("getComputedStyle(document.activeElement).outlineStyle") != "none"
    unnamed = page.run(
        "[...document.querySelectorAll('button, input, select, [role=img]')].filter(e => e.checkVisibility()"
        " && !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.[0]?.textContent.trim()))"
        ".map(e => e.outerHTML)"
    )
    assert unnamed == []


def test_the_robot_is_drawn_and_coloured_where_a_limit_acts(page, folder):
    run = load_run(folder)
    assert run.log["xi.base_x.upper"][0] == 0
    assert run.log["xi.base_x.upper"][-1] > 0.5
    assert orange_share(page, 0.0) < 0.01
    assert orange_share(page, 3.0) > 0.05
    assert "base_x upper" in page.run("document.getElementById('acting').textContent")


def orange_share(page, t):
    """The share of the replay's picture in the colour of acting limits."""
    page.run(f"tope.setTime({t})")
    page.run("scrollTo(0, 0)")
    x, y, width, height = page.run(
        "(b => [b.x, b.y, b.width, b.height])(document.getElementById('stage').getBoundingClientRect())"
    )
    picture = (
        Image.open(io.BytesIO(page.picture())).convert("RGB").crop((x, y, x + width, min(800, y + height)))
    )
    red, green, blue = (channel.astype(int) for channel in np.moveaxis(np.array(picture), 2, 0))
    assert len(np.unique(np.array(picture).reshape(-1, 3), axis=0)) > 100  # something is drawn
    return float(np.mean((red > 150) & (red - blue > 90) & (red - green > 50)))


def test_runs_are_toggled_one_by_one(overlay):
    assert overlay.run("tope.shownRuns()") == ["unilateral", "chain", "switch"]
    overlay.click("#runs button:nth-child(2)")
    assert overlay.run("tope.shownRuns()") == ["unilateral", "switch"]
    assert overlay.run("document.querySelector('#runs button:nth-child(2)').ariaPressed") == "false"
    overlay.click("#runs button:nth-child(1)")
    assert overlay.run("tope.frontRun()") == "switch"  # a hidden run is not in front
    overlay.click("#runs button:nth-child(2)")
    assert overlay.run("tope.shownRuns()") == ["chain", "switch"]
    overlay.run(
        "(s => { s.value = '0'; s.dispatchEvent(new Event('change')); })(document.getElementById('front'))"
    )
    assert overlay.run("tope.frontRun()") == "unilateral"
    assert overlay.run("tope.shownRuns()") == ["unilateral", "chain", "switch"]


@pytest.mark.parametrize("name", ["folder", "comparison"])
@pytest.mark.parametrize("dark", [False, True])
def test_a_phone_needs_no_sideways_scrolling(browser, request, name, dark):
    found = request.getfixturevalue(name)
    for page in checked(
        browser.open(report(found[0] if name == "comparison" else found), dark=dark, **PHONE)
    ):
        assert page.run("document.documentElement.scrollWidth") <= 390
        assert page.run("document.querySelector('#panel-0 .plot').clientWidth") >= 300
        page.click("#play")
        page.wait_for("tope.time() > 0.1")


def test_dark_is_as_the_system_is_until_chosen(browser, folder):
    background = "getComputedStyle(document.body).backgroundColor"
    for page in checked(browser.open(report(folder), dark=True)):
        assert page.run(background) == "rgb(20, 23, 27)"
        page.click("#theme")
        assert page.run(background) == "rgb(255, 255, 255)"
        page.click("#theme")
        assert page.run(background) == "rgb(20, 23, 27)"
        page.view(dark=False)
        page.wait_for(f"{background} === 'rgb(255, 255, 255)'")


def test_without_webgl_the_rest_works_and_says_so(browser, folder):
    page = browser.open("about:blank")
    page.call(
        "Page.addScriptToEvaluateOnNewDocument",
        source="HTMLCanvasElement.prototype.getContext = (get => function(kind, ...rest) {"
        " return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); })"
        "(HTMLCanvasElement.prototype.getContext)",
    )
    page.go(report(folder))
    assert "needs WebGL" in page.run("document.getElementById('stage').textContent")
    assert page.run("tope.linkPose('ee')") is None
    page.press("ArrowRight")
    assert page.run("tope.cursorTimes()")[0] == pytest.approx(0.05, abs=0.02)
    page.close()


def test_the_logarithmic_scale_and_print_draw_without_complaint(page):
    page.click("#log")
    assert page.run("document.getElementById('log').ariaPressed") == "true"
    page.run("dispatchEvent(new Event('beforeprint'))")
    panels = page.run("document.querySelectorAll('figure').length")
    assert page.run("document.querySelectorAll('figure .uplot canvas').length") == panels


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_a_very_short_run_has_a_page_that_works(browser, tmp_path, rows):
    write_run_report(make_run(rows=rows), tmp_path / "report.html")
    for page in checked(browser.open(report(tmp_path))):
        page.press("ArrowRight")
        page.run("dispatchEvent(new Event('beforeprint'))")


def test_runs_of_unlike_robots_have_plots_and_no_replay(browser, tmp_path):
    runs = {"one": make_run(rows=101), "two": make_run(rows=101)}
    runs["two"].scenario["robot"]["name"] = "another"
    write_comparison_report(runs, tmp_path / "report.html")
    for page in checked(browser.open(report(tmp_path))):
        assert page.run("document.getElementById('stage')") is None
        assert "No replay" in page.run("document.querySelector('.replay').innerText")
        page.press("ArrowRight")
        assert page.run("tope.cursorTimes()")[0] == pytest.approx(0.05, abs=0.05)
        page.click("#runs button")
        assert page.run("tope.shownRuns()") == ["two"]


def test_every_plot_and_scale_of_a_torque_comparison_draws(browser, tmp_path):
    runs = {name: make_run(rows=1001, mode="torque", method=name) for name in ("unilateral", "chain")}
    write_comparison_report(runs, tmp_path / "report.html")
    for page in checked(browser.open(report(tmp_path))):
        page.click("#log")
        page.run("dispatchEvent(new Event('beforeprint'))")
        panels = page.run("document.querySelectorAll('figure').length")
        assert page.run("document.querySelectorAll('figure .uplot canvas').length") == panels
