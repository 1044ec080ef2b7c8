"""Parts of the package that need more packages than the rest."""

from __future__ import annotations

import importlib
from types import ModuleType

from tope import _core


def load(module: str, what: str, extra: str) -> ModuleType:
    """Import a module of ours; raises Error that names the package it lacks and what installs it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise _core.Error(f"{what} needs the package {error.name}: install tope[{extra}]") from error
