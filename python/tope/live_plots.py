"""The plots on the live page."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import viser
from viser import uplot

from tope.panels import Array
from tope.session import State

PLOT_POINTS = 150  # about 20 s
CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#8a7a00")


class LivePlots:
    """Activations and commands of the last seconds."""

    def __init__(self, server: viser.ViserServer, scenario: Mapping[str, Any]) -> None:
        """Add empty plots."""
        self.bounds = np.array([joint["bound"] or np.nan for joint in scenario["joints"]])
        self.rows: deque[Array] = deque(maxlen=PLOT_POINTS)
        names = [joint["name"] for joint in scenario["joints"]]
        what = "torque" if scenario["mode"] == "torque" else "command"
        self.activations = self.add(server, "How far limits act (lower: negative)", names, legend=False)
        self.commands = self.add(server, f"Each {what} over its bound", names, legend=True)

    def add(
        self, server: viser.ViserServer, title: str, names: Sequence[str], *, legend: bool
    ) -> viser.GuiUplotHandle:
        """A plot with a curve for each joint."""
        curves = [
            uplot.Series(label=name, stroke=CURVES[i % len(CURVES)], width=1.5)
            for i, name in enumerate(names)
        ]
        return server.gui.add_uplot(
            data=tuple(np.zeros(2) for _ in range(len(names) + 1)),
            series=(uplot.Series(label="t"), *curves),
            title=title,
            scales={"x": uplot.Scale(time=False), "y": uplot.Scale(auto=False, range=(-1.05, 1.05))},
            legend=uplot.Legend(show=legend),
            aspect=2.2,
        )

    def show(self, state: State) -> None:
        """Add the present moment."""
        if self.rows and state.time < self.rows[-1][0]:
            self.rows.clear()  # the simulation was started anew
        signed = np.where(state.upper >= state.lower, state.upper, -state.lower)
        self.rows.append(np.concatenate([[state.time], signed, state.command / self.bounds]))
        columns = np.ascontiguousarray(np.array(self.rows).T)
        n = len(self.bounds)
        self.activations.data = (columns[0], *columns[1 : n + 1])
        self.commands.data = (columns[0], *columns[n + 1 :])
