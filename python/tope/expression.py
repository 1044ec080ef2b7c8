"""Arithmetic in a campaign file: numbers, names of what was drawn before, + - * / **, min, max, sqrt, abs."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from tope.yaml_entry import Entry, Place, hint

Names = Mapping[str, Any]

BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
FUNCTIONS: dict[str, Callable[..., float]] = {"min": min, "max": max, "sqrt": math.sqrt, "abs": abs}
CONSTANTS = {"pi": math.pi}


@dataclass(frozen=True)
class Expression:
    """A formula, with its place for errors."""

    text: str
    place: Place

    @classmethod
    def read(cls, entry: Entry) -> Expression:
        """From a file; raises ConfigError if it is no formula."""
        expression = cls(entry.text(), entry.place)
        try:
            parsed(expression.text)
        except (SyntaxError, ValueError) as error:
            entry.fail(f"'{expression.text}' is not a formula such as 2 * dt + 0.1")
            raise AssertionError from error
        return expression

    @property
    def constant(self) -> float | None:
        """Its value, if it names nothing."""
        named = any(isinstance(node, ast.Name | ast.Attribute) for node in ast.walk(parsed(self.text)))
        return None if named else self.number({})

    def value(self, names: Names) -> Any:
        """What it comes to; a single name may stand for anything."""
        try:
            return self.evaluate(parsed(self.text), {**CONSTANTS, **names})
        except (ArithmeticError, TypeError, ValueError) as error:
            raise self.place.error(f"'{self.text}' has no value: {error}") from error

    def number(self, names: Names) -> float:
        """Its value, if that is a number."""
        value = self.value(names)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise self.place.error(f"'{self.text}' should be a finite number, but is {value!r}")
        return float(value)

    def evaluate(self, node: ast.expr, names: Names) -> Any:
        """The value of a part."""
        match node:
            case ast.Constant(value=int() | float() as value):
                return value
            case ast.Name() | ast.Attribute():
                return self.named(ast.unparse(node), names)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.evaluate(operand, names)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in BINARY:
                return BINARY[type(op)](self.evaluate(left, names), self.evaluate(right, names))
            case ast.Call(func=ast.Name(id=function), args=arguments, keywords=[]) if function in FUNCTIONS:
                return FUNCTIONS[function](*(self.evaluate(each, names) for each in arguments))
        known = f"numbers, names, + - * / ** and {', '.join(FUNCTIONS)}"
        raise self.place.error(f"'{ast.unparse(node)}' is not understood: a formula has {known}")

    def named(self, name: str, names: Names) -> Any:
        """What a name stands for."""
        if name not in names:
            raise self.place.error(f"nothing drawn before is called '{name}'{hint(name, list(names))}")
        return names[name]


@lru_cache(maxsize=1024)
def parsed(text: str) -> ast.expr:
    """The formula as a tree."""
    return ast.parse(text.strip(), mode="eval").body
