"""A YAML file read so that every mistake in it can be told with its file, line and key."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import yaml

from tope import _core

WORDS: dict[str, Any] = {"true": True, "false": False, "null": None, "~": None, "": None}
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
WHOLE = re.compile(r"[-+]?\d+")


@dataclass(frozen=True)
class Place:
    """Where something stands in a file."""

    file: str
    line: int
    key: str

    def error(self, message: str) -> _core.ConfigError:
        """An error of what stands there."""
        return _core.ConfigError(f"{self.file}:{self.line}: {self.key}: {message}")


class Entry:
    """A value of a YAML file, with its place."""

    def __init__(self, node: yaml.Node, file: str, key: str, name: yaml.Node | None = None) -> None:
        """`key` is the dotted path to the value, `name` its last part as it stands in the file."""
        self.node = node
        self.place = Place(file, (name or node).start_mark.line + 1, key)

    def fail(self, message: str) -> NoReturn:
        """Raise ConfigError that names the place."""
        raise self.place.error(message)

    @property
    def is_map(self) -> bool:
        """Whether it has keys."""
        return isinstance(self.node, yaml.MappingNode)

    @property
    def is_list(self) -> bool:
        """Whether it has items."""
        return isinstance(self.node, yaml.SequenceNode)

    def child(self, node: yaml.Node, key: str, name: yaml.Node | None = None) -> Entry:
        """A value inside this one."""
        return Entry(node, self.place.file, f"{self.place.key}.{key}".lstrip("."), name)

    def entries(self) -> dict[str, Entry]:
        """The values of a map by their keys."""
        if not self.is_map:
            self.fail(f"expected a map of keys, got {self.told()}")
        found: dict[str, Entry] = {}
        for name, node in self.node.value:
            key = str(name.value)
            if key in found:
                self.child(name, key).fail("stands there twice")
            found[key] = self.child(node, key, name)
        return found

    def items(self) -> list[Entry]:
        """The values of a list."""
        if not self.is_list:
            self.fail(f"expected a list, got {self.told()}")
        return [self.child(node, str(i)) for i, node in enumerate(self.node.value)]

    def plain(self) -> Any:
        """The value as Python knows it; numbers as in YAML 1.2, where 1e-3 is one."""
        if self.is_map:
            return {key: entry.plain() for key, entry in self.entries().items()}
        if self.is_list:
            return [entry.plain() for entry in self.items()]
        text = str(self.node.value)
        if self.node.style is not None:  # quoted
            return text
        if WHOLE.fullmatch(text):
            return int(text)
        return float(text) if NUMBER.fullmatch(text) else WORDS.get(text, text)

    def text(self) -> str:
        """A text."""
        if self.is_map or self.is_list or not self.node.value:
            self.fail(f"expected text, got {self.told()}")
        return str(self.node.value)

    def whole(self, least: int) -> int:
        """A whole number that is not below `least`."""
        value = self.plain()
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            self.fail(f"expected a whole number from {least} on, got {self.told()}")
        return value

    def told(self) -> str:
        """The value as an error quotes it."""
        if self.is_map:
            return "a map of keys"
        return "a list" if self.is_list else f"'{self.node.value}'"


def read(file: str | os.PathLike[str]) -> Entry:
    """The map at the top of a file."""
    path = os.fspath(file)
    try:
        node = yaml.compose(Path(file).read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
    except (OSError, UnicodeDecodeError) as error:
        raise _core.ConfigError(f"{path}: no such file, or it cannot be read") from error
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise _core.ConfigError(f"{path}:{line}: not YAML: {error.problem}") from error
    if not isinstance(node, yaml.MappingNode):
        raise _core.ConfigError(f"{path}:1: expected a map of keys at the top")
    return Entry(node, path, "")


def leaves(entry: Entry) -> Iterator[Entry]:
    """The single values inside a value."""
    inside = entry.entries().values() if entry.is_map else entry.items() if entry.is_list else ()
    for each in inside:
        yield from leaves(each)
    if not entry.is_map and not entry.is_list:
        yield entry


def hint(name: str, known: Collection[str]) -> str:
    """What would be right in place of an unknown name."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"; did you mean '{near[0]}'?" if near else f"; known: {', '.join(known)}"
