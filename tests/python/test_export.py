"""Exported runs, read back with the formats' own libraries; message definitions against those of rosbags.

Not covered here: whether Foxglove, PlotJuggler and Rerun show them well, which takes the programs.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from kinematics import frames, placement
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rerun.chunk import RrdReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tope import _core, export
from tope.cli import main
from tope.ros_messages import MESSAGES, definition
from tope.simulation import load_run, simulate

ROOT = Path(__file__).parents[2]
SCENARIOS = {mode: ROOT / f"scenarios/youbot_{mode}.yaml" for mode in ("velocity", "torque")}
GOAL = [0.640, 0.105, 0.068]
GOAL_WXYZ = np.array([0.0397, 0.9811, 0.1867, -0.0322])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("run")
    simulate(SCENARIOS["velocity"], out=out, overrides={"duration": 1.2}, report=False)
    return out


@pytest.fixture(scope="module")
def run(folder):
    return load_run(folder)


@pytest.fixture(scope="module")
def topics(folder):
    return read_mcap(export(folder, to="mcap"))


@pytest.fixture(scope="module")
def columns(folder):
    return read_rerun(export(folder, to="rerun"))


def read_mcap(file):
    """topic -> [(time [s], message)]."""
    found = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, record, message in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((record.log_time / 1e9, message))
    return found


def read_rerun(file):
    """(entity, component) -> (times [s] or None, values)."""
    found = {}
    for chunk in RrdReader(str(file)).stream():
        batch = chunk.to_record_batch()
        times = None
        if not chunk.is_static:
            times = batch.column("time").cast("int64").to_numpy() / 1e9
        for name in batch.schema.names:
            if ":" in name:
                values = [None if each is None else each[0] for each in batch.column(name).to_pylist()]
                key = (chunk.entity_path, name)
                assert key not in found, f"{key} is split in two"
                found[key] = (times, values)
    return found


def expected_frames(run, row):
    names = [joint["name"] for joint in run.scenario["joints"]]
    return frames({name: run.log[f"q.{name}"][row] for name in names})


def chained(steps, link):
    """world_T_link of {child: (parent, SE3)}."""
    world = pinocchio.SE3.Identity()
    while link in steps:
        link, step = steps[link]
        world = step * world
    return world


def test_mcap_holds_every_row_of_joints_and_commands(topics, run):
    names = [joint["name"] for joint in run.scenario["joints"]]
    states, commands = topics["/joint_states"], topics["/joint_commands"]
    np.testing.assert_allclose([t for t, _ in states], run.time, atol=1e-9)
    for i, name in enumerate(names):
        assert states[0][1].name[i] == name
        np.testing.assert_array_equal([each.position[i] for _, each in states], run.log[f"q.{name}"])
        np.testing.assert_array_equal([each.velocity[i] for _, each in states], run.log[f"v.{name}"])
        np.testing.assert_array_equal([each.velocity[i] for _, each in commands], run.log[f"u.{name}"])
    assert all(list(each.effort) == [] for _, each in states)


def test_mcap_of_torque_mode_holds_efforts(tmp_path):
    simulate(SCENARIOS["torque"], out=tmp_path, overrides={"duration": 0.02}, report=False)
    found, run = read_mcap(export(tmp_path, to="mcap")), load_run(tmp_path)
    efforts = [each.effort[4] for _, each in found["/joint_commands"]]
    np.testing.assert_array_equal(efforts, run.log["u.arm_joint_2"])
    np.testing.assert_array_equal([each.effort[4] for _, each in found["/joint_states"]], efforts)


@pytest.mark.parametrize("row", [0, 333, 800])
def test_transforms_put_every_link_where_pinocchio_says(topics, run, row):
    stamped = [*topics["/tf_static"][0][1].transforms, *topics["/tf"][row][1].transforms]
    steps = {
        each.child_frame_id: (each.header.frame_id, placement(*vectors(each.transform))) for each in stamped
    }
    expected = expected_frames(run, row)
    assert {"base_link", "arm_link_5", "ee", "gripper_finger_l_link"} <= set(steps)
    for link in steps:
        np.testing.assert_allclose(chained(steps, link).homogeneous, expected[link].homogeneous, atol=1e-9)


def vectors(transform):
    t, r = transform.translation, transform.rotation
    return [t.x, t.y, t.z], [r.x, r.y, r.z, r.w]


def test_goals_are_poses_where_the_scenario_puts_them(topics, run):
    assert len(topics["/goal/ee"]) == len(run.time)
    for _, message in topics["/goal/ee"][:: len(run.time) // 4]:
        p, q = message.pose.position, message.pose.orientation
        np.testing.assert_allclose([p.x, p.y, p.z], GOAL, atol=1e-8)
        alike = abs(np.dot([q.w, q.x, q.y, q.z], GOAL_WXYZ / np.linalg.norm(GOAL_WXYZ)))
        assert alike == pytest.approx(1.0, abs=1e-9)
        assert message.header.frame_id == "world"


def test_diagnostics_hold_status_scale_activations_errors_and_wheels(topics, run):
    statuses = [message.status[0] for _, message in topics["/diagnostics"]]
    assert [each.message for each in statuses] == list(run.log["status"])
    assert set(run.log["status"]) > {"ok"}
    assert [each.level for each in statuses] == [int(flags != "ok") for flags in run.log["status"]]
    values = [{pair.key: float(pair.value) for pair in each.values} for each in statuses]
    expected = {name for name in run.log if name.startswith(("xi.", "e.", "wheel."))} | {"scale"}
    assert len(expected) > 20
    assert set(values[0]) == expected
    for name in expected:
        np.testing.assert_array_equal([each[name] for each in values], run.log[name])


@pytest.mark.parametrize(
    ("scenario", "overrides", "prefix"),
    [("youbot_obstacle", {}, "d."), ("youbot_experiment_velocity", {}, "measured.")],
)
def test_diagnostics_hold_what_a_run_logs_besides(tmp_path, scenario, overrides, prefix):
    overrides = {"duration": 0.05, **overrides}
    simulate(ROOT / f"scenarios/{scenario}.yaml", out=tmp_path, overrides=overrides, report=False)
    [*_, (_, last)] = read_mcap(export(tmp_path, to="mcap"))["/diagnostics"]
    values = {pair.key: float(pair.value) for pair in last.status[0].values}
    expected = {
        name: column[-1] for name, column in load_run(tmp_path).log.items() if name.startswith(prefix)
    }
    assert expected
    assert {name: values[name] for name in expected} == expected


def test_mcap_holds_summary_and_urdf(topics, folder, run):
    assert topics["/robot_description"][0][1].data == (ROOT / "robots/youbot/youbot.urdf").read_text()
    with (folder / "run.mcap").open("rb") as stream:
        metadata = {each.name: each.metadata for each in make_reader(stream).iter_metadata()}
    assert json.loads(metadata["tope"]["summary"]) == run.summary


@pytest.mark.parametrize("name", MESSAGES)
def test_definitions_are_those_of_ros(name):
    store = get_typestore(Stores.ROS2_HUMBLE)
    for part, fields in get_types_from_msg(definition(name), name).items():
        constants, members = fields
        known_constants, known = store.fielddefs[part]
        assert members == known, part
        assert set(constants) <= set(known_constants)


def test_messages_decode_with_another_library_too(folder, run):
    store = get_typestore(Stores.ROS2_HUMBLE)
    with (folder / "run.mcap").open("rb") as stream:
        for schema, channel, record in make_reader(stream).iter_messages(starting_at=500_000_000):
            message = store.deserialize_cdr(record.data, schema.name)
            if channel.topic == "/joint_states" and record.sequence == 700:
                assert message.position[0] == run.log["q.base_x"][700]
                assert message.header.stamp.nanosec == 700_000_000


def test_rerun_holds_every_column_of_the_log(columns, run):
    for name in set(run.log) - {"t", "status"}:
        times, values = columns[(f"/log/{name.replace('.', '/')}", "Scalars:scalars")]
        np.testing.assert_allclose(times, run.time, atol=1e-9)
        np.testing.assert_array_equal(values, run.log[name])
    times, texts = columns[("/log/status", "TextLog:text")]
    rows = np.searchsorted(times, run.time + 1e-9) - 1
    assert [texts[row] for row in rows] == list(run.log["status"])


@pytest.mark.parametrize("row", [0, 333, 800])
def test_rerun_puts_links_where_pinocchio_says(columns, run, row):
    expected = expected_frames(run, row)
    paths = sorted({path for path, _ in columns if path.startswith("/world/world/") and "shape" not in path})
    assert {path.rsplit("/", 1)[1] for path in paths} >= {"base_link", "arm_link_5", "ee"}
    for path in paths:
        parts = path.split("/")
        above = ["/".join(parts[:i]) for i in range(4, len(parts) + 1)]
        world = pinocchio.SE3.Identity()
        for each in above:
            times, xyz = columns[(each, "Transform3D:translation")]
            _, xyzw = columns[(each, "Transform3D:quaternion")]
            at = 0 if times is None else row
            world = world * placement(xyz[at], xyzw[at])
        np.testing.assert_allclose(
            world.homogeneous, expected[parts[-1]].homogeneous, atol=1e-6, err_msg=path
        )


def test_rerun_has_goal_obstacle_and_shapes(columns):
    _, positions = columns[("/world/goal/ee", "Transform3D:translation")]
    np.testing.assert_allclose(positions, np.tile(GOAL, (len(positions), 1)), atol=1e-6)
    assert ("/world/obstacle/base_x", "Boxes3D:half_sizes") in columns
    assert any("Cylinders3D" in component for _, component in columns)


def test_the_command_line_exports(folder, tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["export", str(folder), "--to", "mcap", "--out", str(tmp_path / "a.mcap")])
    assert not stopped.value.code
    assert "a.mcap" in capsys.readouterr().out
    assert read_mcap(tmp_path / "a.mcap")


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (lambda out: (out / "summary.json").unlink(), r"summary\.json: missing: the run did not finish"),
        (lambda out: (out / "log.csv").unlink(), r"log\.csv: missing"),
        (lambda out: cut(out / "log.csv", 20), r"log\.csv:\d+: \d+ values where the header has"),
        (lambda out: cut(out / "summary.json", 20), r"summary\.json:\d+: not JSON"),
        (lambda out: drop_column(out / "log.csv"), r"log\.csv:1: no column 'u\.base_x'"),
        (lambda out: only_header(out / "log.csv"), r"the log has no rows"),
        (lambda out: move_urdf(out / "summary.json"), r"gone\.urdf: missing"),
        (lambda out: forget_robot(out / "summary.json"), r"summary\.json: .*no key 'robot'"),
    ],
)
@pytest.mark.parametrize("to", ["mcap", "rerun"])
def test_a_broken_run_is_a_clear_error_and_no_file(folder, tmp_path, broken, said, to):
    for name in ("summary.json", "log.csv"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    broken(tmp_path)
    with pytest.raises(_core.Error, match=said):
        export(tmp_path, to=to)
    assert not list(tmp_path.glob("run.*"))


def cut(file, characters):
    file.write_text(file.read_text()[:-characters])


def only_header(file):
    file.write_text(file.read_text().splitlines()[0] + "\n")


def drop_column(file):
    file.write_text(file.read_text().replace("u.base_x", "w.base_x", 1))


def move_urdf(file):
    file.write_text(file.read_text().replace("youbot.urdf", "gone.urdf"))


def forget_robot(file):
    summary = json.loads(file.read_text())
    del summary["scenario"]["robot"]
    file.write_text(json.dumps(summary))


def test_an_unknown_format_names_the_known_ones(folder):
    with pytest.raises(_core.ConfigError, match="no format is called 'bag': there are mcap, rerun"):
        export(folder, to="bag")


def test_a_file_that_cannot_be_written_is_named(folder):
    with pytest.raises(_core.Error, match=r"nowhere/run\.mcap: cannot be written"):
        export(folder, to="mcap", out="/nowhere/run.mcap")


def test_a_missing_package_is_named(folder, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rerun", None)
    monkeypatch.delitem(__import__("sys").modules, "tope.export_rerun", raising=False)
    with pytest.raises(_core.Error, match=r"needs the package rerun: install tope\[export\]"):
        export(folder, to="rerun")
