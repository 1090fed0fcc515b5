"""Conditions over the current row of a trace, and their programs for native code.

An expression that is applied to symbols gives its program.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cosim.errors import CosimError, ExpressionError, concerning
from cosim.fmu.description import Variable
from cosim.metrics.expression import Expression

Program = list[tuple[str, float]]
"""Postfix: (`column`, index), (`number`, value) and (name of a ufunc, 0)."""
EXACT = {
    "add", "subtract", "multiply", "divide", "negative", "positive", "absolute", "sqrt", "minimum", "maximum",
    "equal", "not_equal", "less", "less_equal", "greater", "greater_equal",
    "logical_and", "logical_or", "logical_not", "isfinite",
}  # fmt: skip
"""Functions with the same rounding in every library."""


class Symbol(np.lib.mixins.NDArrayOperatorsMixin):
    """A symbolic value with the program that computes it."""

    def __init__(self, program: Program) -> None:
        self.program = program

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Record a function without computing it."""
        if method != "__call__" or options or ufunc.__name__ not in EXACT:
            return NotImplemented
        sides = [
            value.program if isinstance(value, Symbol) else [("number", float(value))] for value in inputs
        ]
        return Symbol([*(step for side in sides for step in side), (ufunc.__name__, 0.0)])

    def astype(self, kind: type[np.float64]) -> Symbol:
        """Truth values are numbers in a program."""
        return self

    def __array_function__(self, *arguments: Any) -> Any:
        """Reject functions that are not ufuncs."""
        return NotImplemented

    def __bool__(self) -> bool:
        """Reject branches."""
        raise TypeError("a symbol has no truth value")


def program(expression: Expression, columns: int) -> Program | None:
    """Program of a condition over rows; None if it would not be bit-identical to numpy."""
    symbols = [Symbol([("column", float(index))]) for index in range(columns)]
    try:
        found = expression(symbols)
    except CosimError:
        return None
    return found.program if isinstance(found, Symbol) else None


def compiled(text: str, key: str, found: Mapping[str, Variable | None]) -> Expression | None:
    """Condition over the current row of the trace, from a key of the scenario; None for an empty text.

    An expression that gives a number is rejected: any number except 0 would be true immediately.
    """
    if not text:
        return None
    with concerning(key):
        made = Expression(text, items_of(found), f"`{key}`", rowwise=True)
        column = found.get(made.root.column)
        made(np.zeros(len(found)))
        if not made.root.logical and (column is None or column.kind != "Boolean"):
            hint = f"Compare it with a number: `{text} > 0`."
            raise ExpressionError(f"`{key}` = `{text}` is not a condition", hint)
    return made


def items_of(found: Mapping[str, Variable | None]) -> dict[str, dict[str, int] | None]:
    """Columns with the items of those that are enumerations."""
    return {name: dict(v.items) if v and v.items else None for name, v in found.items()}
