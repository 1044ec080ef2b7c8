"""Properties that must hold for whatever comes in: any finite state, any stack, any activation.

Hypothesis searches for what breaks them, and keeps what it found in .hypothesis. Not here: memory errors
(make sanitize), files (tests/fuzz).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tope

ROOT = Path(__file__).parents[2]
METHODS = ("unilateral", "chain", "multilinear", "intermediate", "paper", "switch", "potential_field")
START = np.array([0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8])
ROBOT = tope.Robot.from_urdf(ROOT / "robots/youbot/youbot.urdf", ROOT / "robots/youbot/youbot.yaml")
GENTLE = settings(deadline=None, max_examples=200, derandomize=True)

anything = st.floats(allow_nan=False, allow_infinity=False)
usual = st.floats(-10.0, 10.0)
number = st.one_of(usual, anything)
states = st.lists(number, min_size=8, max_size=8).map(np.array)
unit = st.floats(-1.0, 1.0)


def rotations() -> st.SearchStrategy[np.ndarray]:
    """Unit quaternions as matrices."""

    def matrix(q: list[float]) -> np.ndarray:
        w, x, y, z = np.array(q) / np.linalg.norm(q)
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )

    return st.lists(unit, min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1).map(matrix)


def tasks() -> st.SearchStrategy[object]:
    """Any kind, anywhere."""
    reference = st.floats(0.01, 50.0).map(lambda gain: tope.Exponential(gain=gain))
    points = st.lists(usual, min_size=3, max_size=3).map(np.array)
    frames = st.sampled_from(["ee", "arm_link_3", "base_link"])
    return st.one_of(
        st.builds(tope.FramePosition, frame=frames, target=points, reference=reference),
        st.builds(tope.FrameOrientation, frame=frames, target=rotations(), reference=reference),
        st.builds(
            tope.Posture, target=st.lists(usual, min_size=8, max_size=8).map(np.array), reference=reference
        ),
        st.builds(tope.Damping),
    )


stacks = st.lists(st.tuples(tasks(), st.integers(1, 4), st.sampled_from([0.0, 0.5])), max_size=6)


def build(mode: str, method: str, stack: list[tuple[object, int, float]]) -> tope.Controller:
    field = tope.PotentialFieldOptions(joints=["base_x"], influence=0.1, strength=0.2)
    limits = tope.LimitOptions(method=method, potential_field=field, enforce_conditions=False)
    controller = tope.Controller(ROBOT, mode=mode, dt=1e-3, limits=limits)
    for task, level, over in stack:
        controller.add(task, level=level, over=over)
    return controller


def check(controller: tope.Controller, mode: str, u: np.ndarray) -> None:
    """Finite, within bounds, and accounted for."""
    bound = ROBOT.velocity_limit if mode == "velocity" else ROBOT.effort_limit
    assert np.all(np.isfinite(u)), u
    assert np.all(np.abs(u) <= bound * (1 + 1e-9)), (u, controller.status_text)
    assert controller.status_text
    assert 0.0 <= controller.status.scale <= 1.0
    assert all(0.0 <= xi <= 1.0 for xi in controller.activations.values())


@pytest.mark.parametrize("mode", ["velocity", "torque"])
@GENTLE
@given(
    method=st.sampled_from(METHODS),
    stack=stacks,
    path=st.lists(st.tuples(states, states, st.floats(0.0, 2.0)), min_size=1, max_size=4),
)
def test_any_state_and_stack_give_a_finite_command_within_bounds(mode, method, stack, path) -> None:
    controller = build(mode, method, stack)
    for q, v, t in path:
        check(controller, mode, controller.update(q, v, t))


@pytest.mark.parametrize("method", ["unilateral", "chain"])
@GENTLE
@given(
    stack=stacks,
    beyond=st.lists(st.floats(-0.2, 0.2), min_size=8, max_size=8).map(np.array),
    jitter=st.lists(st.floats(0.5, 1.5), min_size=7, max_size=7),
)
def test_a_state_beyond_its_limits_returns_and_stays_inside(method, stack, beyond, jitter) -> None:
    """Kinematic, with periods half as long to half as long again as the controller was told."""
    controller = build("velocity", method, stack)
    lower, upper = ROBOT.position_lower, ROBOT.position_upper
    bounded = np.isfinite(upper)
    q = START.copy()
    q[bounded] = np.where(beyond > 0, upper, lower)[bounded] + beyond[bounded]
    t = 0.0
    inside = np.zeros(8, dtype=bool)
    for cycle in range(1500):
        u = controller.update(q, np.zeros(8), t)
        period = 1e-3 * jitter[cycle % len(jitter)]
        q = q + u * period
        t += period
        now = ~bounded | ((q <= upper + 1e-12) & (q >= lower - 1e-12))
        assert np.all(now[inside]), "a joint left again"
        inside |= now
    assert np.all(inside)


@GENTLE
@given(
    stack=stacks,
    speed=st.floats(-0.3, 0.3),
    start=st.floats(0.3, 1.0),
)
def test_limits_may_move_while_it_runs(stack, speed, start) -> None:
    """An obstacle before the base comes and goes at a constant speed: never reached."""
    controller = build("velocity", "unilateral", stack)
    q, dt = START.copy(), 1e-3
    for cycle in range(1500):
        wall = q[0] + start if cycle == 0 else wall + speed * dt  # noqa: F821
        controller.move_limits("base_x", lower=-50.0, upper=wall, upper_rate=speed)
        q = q + controller.update(q, np.zeros(8), cycle * dt) * dt
        assert q[0] <= wall + max(0.0, speed) * dt + 1e-9
