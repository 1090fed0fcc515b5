"""Expressions over the columns of a trace: a small safe language with Python's syntax.

Columns are dotted names (`plant.depth`, `controller.bias[1]`, or `column("any name")`), conditions pick rows
(`plant.depth[controller.contact]`), and `and`, `or`, `not` (`&`, `|`, `~`) work row by row. Items of an
enumeration are texts: `controller.state == "Detect"`. A metric can use others: `metric.depth`. Numbers are
64-bit floats throughout; `5 * um` is 5e-6.
"""

from __future__ import annotations

import ast
import functools
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from cosim.errors import ExpressionError, closest
from cosim.metrics import functions
from cosim.units import CONSTANTS as UNITS
from cosim.units import PLAIN

Items = Mapping[str, int]
"""Items of an enumeration by name."""

LONGEST = 2000
normal = functools.partial(unicodedata.normalize, "NFKC")
"""Name as Python reads it: the micro sign and the letter mu are the same."""


class Columns(Protocol):
    """Columns of a trace by index: whole columns for a metric, single numbers for a row."""

    def __getitem__(self, index: int, /) -> Any: ...


@dataclass(frozen=True)
class Node:
    """A compiled part of an expression, with its unit; None if that is unknown."""

    evaluate: Callable[[Columns], Any]
    items: Items | None = None
    """Items of the enumeration that its values belong to."""
    unit: str | None = None
    logical: bool = False
    """Whether it is true or false."""
    constant: bool = False
    """Whether it depends on no column."""
    column: str = ""
    factor: float = 1.0
    absolute: bool = False
    """It is `factor` times some values, or `absolute` values, of this column."""


class Expression:
    """A compiled expression.

    The first of the columns is the time; they have items if they are enumerations. `where` is the location of
    the expression for messages: "`metric.depth.value`". With `rowwise` it is applied to single rows
    (`stop_when`). `known` are other compiled expressions by name; None if they are not allowed.
    """

    def __init__(
        self,
        text: str,
        columns: Mapping[str, Items | None],
        where: str,
        rowwise: bool = False,
        units: Mapping[str, str] | None = None,
        known: Mapping[str, Node] | None = None,
    ) -> None:
        self.text, self.where, self.rowwise = text, where, rowwise
        self.items, self.units, self.known = columns, units or {}, known
        self.names = {name: index for index, name in enumerate(columns)}
        self.normal: dict[str, list[str]] = {}
        for name in columns:
            self.normal.setdefault(normal(name), []).append(name)
        if len(text) > LONGEST:
            raise self.error(f"is longer than {LONGEST} characters")
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            reason = error.msg if isinstance(error, SyntaxError) else str(error)
            hint = 'Use `column("name")` for a name that is not a Python name.'
            raise self.error(f"is not an expression: {reason}", hint) from None
        self.converts = any(isinstance(part, ast.Mult | ast.Div | ast.Pow) for part in ast.walk(tree))
        try:
            self.root = self.build(tree.body)
        except RecursionError:
            raise self.error("is nested too deeply") from None
        self.unit = self.root.unit

    def __call__(self, columns: Columns) -> Any:
        """Value for columns (or one row) in the order given at compilation."""
        with np.errstate(all="ignore"):
            try:
                return self.root.evaluate(columns)
            except (ValueError, IndexError, TypeError) as error:
                lengths = isinstance(error, IndexError) or "shape" in str(error)
                hint = "Apply the same condition `[...]` to all columns." if lengths else ""
                raise self.error(f"cannot be computed: {error}", hint) from None

    def error(self, problem: str, hint: str = "") -> ExpressionError:
        """Make an error that quotes the expression."""
        shown = self.text if len(self.text) <= 100 else self.text[:97] + "..."
        return ExpressionError(f"{self.where} = `{shown}` {problem}", hint)

    def build(self, tree: ast.expr) -> Node:
        """Compile one node of the syntax tree; all other nodes are rejected."""
        match tree:
            case ast.Constant(value=bool() | int() | float() as value):
                return self.constant(value)
            case ast.Name() | ast.Attribute():
                return self.name(tree)
            case ast.Subscript():
                return self.subscript(tree)
            case ast.Call():
                return self.call(tree)
            case ast.BinOp() if type(tree.op) in functions.BINARY:
                return self.operate(tree.op, functions.BINARY[type(tree.op)], tree.left, tree.right)
            case ast.UnaryOp():
                return self.operate(tree.op, functions.UNARY[type(tree.op)], tree.operand)
            case ast.BoolOp():
                function = functions.AND if isinstance(tree.op, ast.And) else functions.OR
                return self.fold(function, [self.build(value) for value in tree.values])
            case ast.Compare():
                return self.compare(tree)
            case ast.Constant(value=str() as text):
                raise self.error(f"holds the text `{text}`", "Compare a text only with an enumeration.")
            case _:
                raise self.error(f"holds `{ast.unparse(tree)}`, which is not supported")

    def constant(self, value: float, unit: str = PLAIN) -> Node:
        """Compile a number as a float, so that powers and factorials are bounded."""
        try:
            number = np.float64(value)
        except OverflowError:
            raise self.error("holds a number that is too large") from None
        return Node(lambda columns: number, unit=unit, constant=True)

    def name(self, tree: ast.expr) -> Node:
        """Column, metric, constant or unit."""
        name = dotted(tree)
        if name in functions.CONSTANTS:
            return self.constant(functions.CONSTANTS[name])
        if name in UNITS:
            unit, number = UNITS[name]
            return self.constant(number, unit)
        if same := self.normal.get(name):
            if len(same) > 1:
                problem = f"names `{name}`, which may be " + " or ".join(f"`{column}`" for column in same)
                raise self.error(problem, f'Use `column("{same[0]}")`.')
            return self.found(same[0])
        known = self.known or {}
        if name in known:
            return known[name]
        missing = "column of the trace"
        if any(column.startswith("metric.") for column in self.names):
            missing = "column of the results"
        elif name.startswith("metric."):
            if self.known is None:
                problem = "metrics are available only in other metrics, after the run"
                raise self.error(f"names `{name}`, but {problem}")
            missing = "other metric"
        problem = f"names `{name or ast.unparse(tree)}`, which is not a known {missing}"
        raise self.error(problem, closest(name, [*self.names, *known]))

    def found(self, name: str) -> Node:
        """Compile an existing column."""
        index, items = self.names[name], self.items[name]
        unit = self.units.get(name) or (PLAIN if items else None)
        return Node(lambda columns: columns[index], items, unit, column=name)

    def subscript(self, tree: ast.Subscript) -> Node:
        """Column of a structured name (`bias[1]`), or the rows of a value that meet a condition."""
        name = dotted(tree)
        if name in self.normal or isinstance(tree.slice, ast.Constant):
            return self.name(tree)
        if self.rowwise:
            raise self.error("selects rows with `[...]`, but it is applied to one row at a time")
        value = self.build(tree.value)
        picked = self.apply(
            lambda rows, condition: rows[np.not_equal(condition, 0)], value, self.build(tree.slice)
        )
        return replace(value, evaluate=picked.evaluate, constant=False)

    def call(self, tree: ast.Call) -> Node:
        """Call of one of the functions of the language."""
        function = ast.unparse(tree.func)
        known = [*functions.ROWWISE, *functions.WHOLE, *functions.TIMES, "column"]
        if function not in known:
            raise self.error(f"calls `{function}`, which is not a known function", closest(function, known))
        if tree.keywords or any(isinstance(argument, ast.Starred) for argument in tree.args):
            raise self.error(f"calls `{function}` with more than plain arguments")
        if function == "column":
            return self.column(tree)
        if self.rowwise and function not in functions.ROWWISE:
            problem = "which needs the whole trace, but it is applied to one row at a time"
            raise self.error(f"calls `{function}`, {problem}")
        arguments = [self.build(argument) for argument in tree.args]
        if function in ("min", "max") and len(arguments) == 2:
            function += "imum"
        count, compute = (functions.ROWWISE | functions.WHOLE | functions.TIMES)[function]
        if len(arguments) != count:
            raise self.error(f"calls `{function}` with {len(arguments)} arguments instead of {count}")
        clock = [Node(lambda columns: columns[0])] if function in functions.TIMES else []
        made = derived(self.apply(compute, *clock, *arguments), function, arguments)
        if function in functions.KEEP_ITEMS:
            made = replace(made, items=arguments[0].items)
        if function == "abs" or function in functions.VALUES:
            made = of_column(made, arguments[0])
        return replace(made, absolute=made.absolute or function == "abs")

    def column(self, tree: ast.Call) -> Node:
        """Column by its name as a text."""
        match tree.args:
            case [ast.Constant(value=str() as name)]:
                if name in self.names:
                    return self.found(name)
                problem = f"names the column `{name}`, which is not in the trace"
                raise self.error(problem, closest(name, self.names))
        raise self.error("calls `column` without exactly one name in quotes")

    def operate(self, operator: ast.AST, function: Callable[..., Any], *sides: ast.expr) -> Node:
        """Apply an operator."""
        nodes = [self.build(side) for side in sides]
        made = derived(self.apply(function, *nodes), type(operator).__name__, nodes)
        match operator, nodes:
            case ast.Mult(), [Node(constant=True) as factor, value] | [value, Node(constant=True) as factor]:
                return of_column(made, value, number(factor))
            case ast.Div(), [value, Node(constant=True) as divisor] if number(divisor):
                return of_column(made, value, 1.0 / number(divisor))
        return made

    def apply(self, function: Callable[..., Any], *arguments: Node) -> Node:
        """Apply a function to the values of other nodes; the result is a plain number."""
        parts = [argument.evaluate for argument in arguments]
        constant = all(argument.constant for argument in arguments)
        return Node(
            lambda columns: function(*[part(columns) for part in parts]), unit=PLAIN, constant=constant
        )

    def fold(self, function: Callable[[Any, Any], Any], nodes: list[Node]) -> Node:
        """Join nodes by a logical function of two values, from the left."""
        joined = functools.reduce(functools.partial(self.apply, function), nodes)
        return replace(joined, logical=True)

    def compare(self, tree: ast.Compare) -> Node:
        """Comparison, chained as in `0 < x < 1`; a text is an item of the enumeration on the other side."""
        sides = [tree.left, *tree.comparators]
        parts = []
        for left, compared, right in zip(sides, tree.ops, sides[1:], strict=False):
            if type(compared) not in functions.COMPARE:
                raise self.error(f"holds `{ast.unparse(tree)}`, which is not supported")
            function = functions.COMPARE[type(compared)]
            parts.append(self.apply(function, self.side(left, right), self.side(right, left)))
        return self.fold(functions.AND, parts)

    def side(self, tree: ast.expr, other: ast.expr) -> Node:
        """One side of a comparison."""
        if not isinstance(tree, ast.Constant) or not isinstance(item := tree.value, str):
            return self.build(tree)
        items, problem = self.build(other).items, f"compares `{ast.unparse(other)}` with"
        if items is None:
            raise self.error(f"{problem} a text, but it is not an enumeration")
        if item not in items:
            raise self.error(f"{problem} `{item}`, which is not one of its items", closest(item, items))
        return self.constant(items[item])


def derived(made: Node, what: str, arguments: Sequence[Node]) -> Node:
    """Add its unit to the result of an operator or function, and whether it is true or false."""
    choices = [arguments[index].logical for index in functions.CHOICES.get(what, ())]
    unit = functions.unit_of(what, [argument.unit for argument in arguments])
    return replace(made, unit=unit, logical=what in functions.LOGICAL or (bool(choices) and all(choices)))


def number(constant: Node) -> float:
    """Value of a part without columns, such as `180 / pi`; 0 if it is not one number."""
    with np.errstate(all="ignore"):
        try:
            return float(constant.evaluate(()))
        except (ValueError, IndexError, TypeError):
            return 0.0


def of_column(made: Node, value: Node, factor: float = 1.0) -> Node:
    """Mark a result as a number times the values of another part."""
    if not factor or not np.isfinite(factor):
        return made
    return replace(made, column=value.column, factor=factor * value.factor, absolute=value.absolute)


def dotted(tree: ast.expr) -> str:
    """Dotted name of a chain of names and constant indices; empty for other expressions."""
    match tree:
        case ast.Name(id=name):
            return name
        case ast.Attribute(value=value, attr=attribute):
            before = dotted(value)
            return before and f"{before}.{attribute}"
        case ast.Subscript(value=value, slice=ast.Constant(value=int() as index)):
            before = dotted(value)
            return before and f"{before}[{index}]"
        case ast.Subscript(value=value, slice=ast.Tuple(elts=parts)):
            before = dotted(value)
            numbers = [str(part.value) for part in parts if isinstance(part, ast.Constant)]
            if before and len(numbers) == len(parts):
                return f"{before}[{','.join(numbers)}]"
    return ""
