"""Strict-priority task-space control of redundant robots that meets joint limits without a jump."""

from tope._core import (
    LIMIT_METHODS,
    CenterOfMass,
    ConfigError,
    Controller,
    Damping,
    Error,
    Exponential,
    FrameOrientation,
    FramePose,
    FramePosition,
    JointPosition,
    LimitOptions,
    Pointing,
    Posture,
    PotentialFieldOptions,
    PredefinedTime,
    Robot,
    Scenario,
    SelectedRows,
    Status,
    Task,
    TaskHandle,
    UnilateralOptions,
)
from tope.compare import compare
from tope.export import export
from tope.runs import Run
from tope.simulation import load_run, load_scenario, simulate

__version__ = "0.1.0"

__all__ = [
    "LIMIT_METHODS",
    "CenterOfMass",
    "ConfigError",
    "Controller",
    "Damping",
    "Error",
    "Exponential",
    "FrameOrientation",
    "FramePose",
    "FramePosition",
    "JointPosition",
    "LimitOptions",
    "Pointing",
    "Posture",
    "PotentialFieldOptions",
    "PredefinedTime",
    "Robot",
    "Run",
    "Scenario",
    "SelectedRows",
    "Status",
    "Task",
    "TaskHandle",
    "UnilateralOptions",
    "compare",
    "export",
    "load_run",
    "load_scenario",
    "simulate",
]
