"""Arithmetic written in a scenario file: strings that begin with "=".

Only numbers, names, arithmetic, comparisons, `a if c else b` and the functions below exist; there
are no attributes, subscripts or operations on strings, so a scenario file cannot run code.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from typing import Any

import numpy as np
from simpleeval import NameNotDefined, SimpleEval

from ...errors import UserError
from ...util.spelling import suggestion
from .syntax import ALLOWED, advice, complaint, depends_on

MAX_LENGTH = 500
POSITION_NAMES = ("x", "y", "z")
CONSTANTS = {"pi": math.pi}
Function = Callable[..., Any]
Functions = Mapping[str, Function]


class ExpressionError(ValueError):
    """An expression that cannot be evaluated; the message says why, in words."""


def _of_whole_digits(function: Function) -> Function:
    """A function that rounds, with its number of digits as an integer."""

    def rounded(value: Any, *digits: Any) -> Any:
        for each in digits:
            if isinstance(each, np.ndarray) or not float(each).is_integer():
                raise ExpressionError("the second value of round, how many digits, is not whole")
        return function(value, *map(int, digits))

    return rounded


SCALAR_FUNCTIONS: dict[str, Function] = {
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "exp": math.exp,
    "log": math.log,
    "log10": math.log10,
    "radians": math.radians,
    "round": _of_whole_digits(round),
    "floor": math.floor,
    "ceil": math.ceil,
    "abs": abs,
    "min": min,
    "max": max,
}


def _elementwise(function: Function) -> Function:
    """A function of numpy without its further arguments, which would be overwritten."""
    return lambda value: function(value)


def _of_several(function: Function) -> Function:
    """The least or greatest of two values or more, element by element."""
    return lambda first, second, *others: reduce(function, others, function(first, second))


ARRAY_FUNCTIONS: dict[str, Function] = SCALAR_FUNCTIONS | {
    "sqrt": _elementwise(np.sqrt),
    "sin": _elementwise(np.sin),
    "cos": _elementwise(np.cos),
    "tan": _elementwise(np.tan),
    "sinh": _elementwise(np.sinh),
    "cosh": _elementwise(np.cosh),
    "tanh": _elementwise(np.tanh),
    "exp": _elementwise(np.exp),
    "log": _elementwise(np.log),
    "log10": _elementwise(np.log10),
    "radians": _elementwise(np.radians),
    "round": _of_whole_digits(np.round),
    "floor": _elementwise(np.floor),
    "ceil": _elementwise(np.ceil),
    "abs": _elementwise(np.abs),
    "min": _of_several(np.minimum),
    "max": _of_several(np.maximum),
}
RESERVED_NAMES = {*POSITION_NAMES, *CONSTANTS, *SCALAR_FUNCTIONS}


def is_expression(value: object) -> bool:
    """Whether a value of a scenario file is an expression."""
    return isinstance(value, str) and value.lstrip().startswith("=")


def names_in(text: str) -> set[str]:
    """The names an expression mentions, functions included."""
    return {node.id for node in ast.walk(_parse(text)) if isinstance(node, ast.Name)}


def evaluate(text: str, names: Mapping[str, Any]) -> Any:
    """The value of the expression `text` ("= ...") with the given names.

    Raises ExpressionError, or the UserError that looking up a name raised.
    """
    return _evaluate(text, names, SCALAR_FUNCTIONS)


def evaluate_at(text: str, names: Mapping[str, Any], position: np.ndarray) -> np.ndarray:
    """The expression at each of N positions (N, dim), as an array (N,); it may use x, y, z.

    Raises ExpressionError, also when a value is not finite.
    """
    if depends_on(_parse(text), POSITION_NAMES):
        raise ExpressionError(
            f'"{text}" chooses by x, y or z, which are many: multiply by conditions, as in'
            " (x > 0)*2 + (x <= 0)*3; of two conditions write a product for both, max(...) for"
            " one of them, 1 - (...) for not"
        )
    axes = dict(zip(POSITION_NAMES, position.T, strict=False))
    value = _evaluate(text, {**names, **axes}, ARRAY_FUNCTIONS)
    try:
        values = np.broadcast_to(np.asarray(value, dtype=float), len(position)).copy()
    except (TypeError, ValueError):
        raise ExpressionError(f'"{text}" is not a number at every particle') from None
    if not np.isfinite(values).all():
        raise ExpressionError(f'"{text}" is not finite at every particle')
    return values


def _parse(text: str) -> ast.Expression:
    source = text.strip().removeprefix("=").strip()
    if len(source) > MAX_LENGTH:
        raise ExpressionError(f"an expression may have {MAX_LENGTH} characters, not {len(source)}")
    try:
        return ast.parse(source, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f'"{text}" is not a valid expression{advice(source)}') from None


def _evaluate(text: str, names: Mapping[str, Any], functions: Functions) -> Any:
    tree = _parse(text)
    if said := complaint(tree, functions):
        raise ExpressionError(f'"{text}" {said}')
    named = {name: _told(name, function) for name, function in functions.items()}
    evaluator = SimpleEval(operators=OPERATORS, functions=named, names=_Names(names))
    evaluator.nodes = {kind: run for kind, run in evaluator.nodes.items() if kind in ALLOWED}
    try:
        with np.errstate(all="ignore"):
            return evaluator.eval(text, previously_parsed=tree.body)
    except (ExpressionError, UserError):
        raise
    except NameNotDefined as error:
        near = suggestion(error.name, [*names, *CONSTANTS])
        raise ExpressionError(f'"{text}" uses the unknown name {error.name}{near}') from None
    except ZeroDivisionError:
        raise ExpressionError(f'"{text}" divides by zero') from None
    except OverflowError:
        raise ExpressionError(f'"{text}" has numbers that are too large') from None
    except RecursionError:
        raise ExpressionError(f'"{text}" is nested too deeply') from None
    except Exception as error:
        # Whatever the arithmetic objects to (types, domains, overflow) is the user's expression.
        raise ExpressionError(f'"{text}" cannot be evaluated: {error}') from None


class _Names:
    """Names as simpleeval reads them: anything with [] that raises KeyError when unknown."""

    def __init__(self, names: Mapping[str, Any]) -> None:
        self._names = names

    def __getitem__(self, name: str) -> Any:
        return CONSTANTS[name] if name in CONSTANTS else self._names[name]


def _told(name: str, function: Function) -> Function:
    """The function, with words about values that it has no number for."""

    def called(*values: Any) -> Any:
        _check_numbers(name, values)
        try:
            return function(*values)
        except ExpressionError:
            raise
        except (ValueError, OverflowError, TypeError):
            shown = ", ".join(f"{value:g}" for value in values if not isinstance(value, np.ndarray))
            raise ValueError(f"{name}({shown}) is no finite number") from None

    return called


def _of_numbers(operation: Function, what: str = "arithmetic") -> Function:
    """The operation, refused for anything but numbers and arrays (no "a" * 10**9)."""

    def checked(*operands: Any) -> Any:
        _check_numbers(what, operands)
        return operation(*operands)

    return checked


def _comparison(operation: Function) -> Function:
    """The comparison, whose results are numbers wherever those of numpy would be none."""

    def compared(first: Any, second: Any) -> Any:
        found = operation(first, second)
        return found if isinstance(found, bool) else 1.0 * found

    return compared


def _check_numbers(what: str, values: Iterable[Any]) -> None:
    for value in values:
        if not isinstance(value, int | float | np.ndarray | np.number):
            raise ExpressionError(f"{what} needs numbers, not {repr(value)[:60]}")


def _power(base: Any, exponent: Any) -> Any:
    """base ** exponent in floating point, so that integers cannot grow without bound."""
    result = np.asarray(base, dtype=float) ** exponent
    return result if result.ndim else float(result)


OPERATORS = {
    ast.Add: _of_numbers(operator.add),
    ast.Sub: _of_numbers(operator.sub),
    ast.Mult: _of_numbers(operator.mul),
    ast.Div: _of_numbers(operator.truediv),
    ast.FloorDiv: _of_numbers(operator.floordiv),
    ast.Mod: _of_numbers(operator.mod),
    ast.Pow: _of_numbers(_power),
    ast.USub: _of_numbers(operator.neg),
    ast.UAdd: _of_numbers(operator.pos),
    ast.Not: operator.not_,
    ast.Eq: _comparison(operator.eq),
    ast.NotEq: _comparison(operator.ne),
    ast.Lt: _of_numbers(_comparison(operator.lt), "a comparison"),
    ast.LtE: _of_numbers(_comparison(operator.le), "a comparison"),
    ast.Gt: _of_numbers(_comparison(operator.gt), "a comparison"),
    ast.GtE: _of_numbers(_comparison(operator.ge), "a comparison"),
}
