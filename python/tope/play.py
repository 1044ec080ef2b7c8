"""A live page in the browser: drag the goal, push the obstacle, pull limits in, change the method."""

from __future__ import annotations

import io
import signal
import socket
import threading
from collections.abc import Callable, Mapping
from contextlib import closing, redirect_stdout
from typing import Any

import numpy as np
import viser

from tope import _core, words
from tope.live_controls import LiveControls
from tope.live_obstacle import LiveObstacle
from tope.live_plots import LivePlots
from tope.live_robot import LiveRobot
from tope.scene import obstacles
from tope.session import Session, State
from tope.urdf import robot_tree

FRAME_RATE = 30.0  # of the scene [1/s]
PLOT_EVERY = 4  # frames between points of the plots
CAMERA, LOOK_AT = (1.45, -1.25, 0.95), (0.3, 0.1, 0.15)  # [m]


class Page:
    """A viser server that shows a session and hands it what people do. All clients see the same."""

    def __init__(self, session: Session, host: str, port: int) -> None:
        """Errors: Error if the address cannot be served."""
        require_free(host, port)
        self.session = session
        self.tree = robot_tree(session.scenario["robot"])
        with redirect_stdout(io.StringIO()):  # viser prints a banner, whatever it is told
            self.server = viser.ViserServer(host=host, port=port, label="tope", verbose=False)
        self.server.initial_camera.position = CAMERA
        self.server.initial_camera.look_at = LOOK_AT
        self.server.gui.configure_theme(show_share_button=False, show_logo=False, control_width="large")
        self.robot = LiveRobot(self.server, self.tree, session.scenario)
        self.add_goals()
        self.kerbs = self.add_obstacles()
        self.refused = ""  # why the last change did not do
        self.told = self.server.gui.add_markdown("")
        self.controls = LiveControls(self.server.gui, session, self.change)
        self.plots = LivePlots(self.server, session.scenario)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._show, name="page", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    def close(self) -> None:
        """End the page; the session goes on."""
        self._stop.set()
        self._thread.join()
        self.server.stop()

    def add_goals(self) -> None:
        """A handle to drag at every goal."""
        for frame, (position, wxyz) in self.session.state().goals.items():
            handle = self.server.scene.add_transform_controls(
                f"/goal/{frame}", scale=0.18, position=np.array(position), wxyz=np.array(wxyz)
            )
            handle.on_update(self.goal_dragged(frame, handle))

    def goal_dragged(
        self, frame: str, handle: viser.TransformControlsHandle
    ) -> Callable[[viser.TransformControlsEvent], None]:
        """What to do when a goal's handle moved."""

        def move(_: viser.TransformControlsEvent) -> None:
            self.session.put_goal(frame, handle.position.tolist(), handle.wxyz.tolist())

        return move

    def add_obstacles(self) -> list[LiveObstacle]:
        """What is in the robot's way, to push."""
        found = obstacles(self.tree, self.session.scenario["joints"])
        return [LiveObstacle(self.server, each, self.change) for each in found]

    def change(self, keys: Mapping[str, Any], moved: LiveObstacle | None = None) -> None:
        """Change the scenario, or say why not; what `moved` shows it already."""
        try:
            self.session.change(keys)
            self.refused = ""
        except _core.Error as error:
            self.refused = str(error)
            self.controls.show(self.session.scenario)
            moved = None  # it stands where it may not
        for kerb in self.kerbs:
            if kerb is not moved:
                kerb.show(self.session.scenario["joints"])

    def _show(self) -> None:
        frame = 0
        while not self._stop.wait(1 / FRAME_RATE):
            state = self.session.state()
            with self.server.atomic():
                self.robot.show(state)
                if frame % PLOT_EVERY == 0:
                    self.plots.show(state)
                    self.told.content = told(self.session.scenario, state, self.refused)
            frame += 1


def require_free(host: str, port: int) -> None:
    """Raise Error unless the address can be served; viser itself would take another port in silence."""
    with closing(socket.socket()) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise _core.Error(
                f"cannot serve {host}:{port}: {error.strerror}; choose another with --port"
            ) from error


def told(scenario: Mapping[str, Any], state: State, refused: str) -> str:
    """The state in words, as Markdown."""
    lines = [f"**{state.time:.1f} s** · {scenario['method']} · {state.status.replace('|', ', ')}"]
    for task in words.by_level(scenario["tasks"]):
        error = state.errors[task["name"]]
        said = "not present" if error is None else words.number(error, words.unit(task))
        lines.append(f"error of {task['name']}: {said}")
    if state.lost > 0:
        lines.append(f"{words.number(state.lost, 's')} lost: this machine is too slow")
    lines += [f"Note: {notice}" for notice in scenario["notices"]]
    if refused:
        lines.append(f"**Not changed:** {refused}")
    return "  \n".join(lines)


def play(
    scenario: str, overrides: Mapping[str, str], *, host: str, port: int, ready: Callable[[str], None]
) -> None:
    """Serve a scenario until SIGINT or SIGTERM; `ready` gets the page's address. For the main thread."""
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):  # a shell lets its background jobs ignore SIGINT otherwise
        signal.signal(number, lambda *_: ended.set())
    with closing(Session(scenario, overrides)) as session, closing(Page(session, host, port)) as page:
        ready(page.address)
        ended.wait()
