"""Works out a launch file's `$(eval …)`, as far as it is sums, comparisons and names."""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

from course_lib.grading.launch_values import converted

if TYPE_CHECKING:
    from collections.abc import Callable

    Known = Callable[[str, str], str]

_MOST_TEXT = 2000  # characters, of the expression and of what comes of it
_OPERATORS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Div: operator.truediv,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_CONVERSIONS: dict[str, Callable[[Any], Any]] = {
    "int": int,
    "float": float,
    "str": str,
    "bool": bool,
}
_SUBSTITUTIONS = {"arg", "find", "env", "optenv", "dirname", "anon"}


class NotUnderstoodError(Exception):
    """It is more than is understood here."""


def evaluate(expression: str, known: Known) -> str:
    """
    Return what an expression comes to, as text.

    Parameters
    ----------
    expression : str
        A stranger's, such as ``find('unit4') + '/' + arg('file')``; it is never executed.
    known : callable
        Gives what ``arg``, ``find`` and the like stand for, by their name and argument.

    Returns
    -------
    str

    Raises
    ------
    NotUnderstoodError
        When it holds anything but names, constants, sums, comparisons and ``and``, ``or``, ``not``.
    """
    if len(expression) > _MOST_TEXT:
        raise NotUnderstoodError
    try:
        found = _value(ast.parse(expression.strip(), mode="eval").body, known)
    except (ValueError, SyntaxError, TypeError, ArithmeticError, RecursionError, MemoryError):
        raise NotUnderstoodError from None
    return str(found)


def _value(node: ast.expr, known: Known) -> Any:  # noqa: ANN401
    match node:
        case ast.Constant(value=str() | int() | float() as value):
            found: Any = value
        case ast.Name(id=name):
            found = converted(name if name.lower() in {"true", "false"} else known("arg", name))
        case ast.Call(func=ast.Name(id=name), args=inner) if name in _SUBSTITUTIONS:
            text = known(name, " ".join(str(_value(each, known)) for each in inner))
            found = converted(text) if name == "arg" else text
        case ast.Call(func=ast.Name(id=name), args=[one]) if name in _CONVERSIONS:
            found = _CONVERSIONS[name](_value(one, known))
        case (
            ast.BinOp(left=left, op=sign, right=right)
            | ast.Compare(left=left, ops=[sign], comparators=[right])
        ) if type(sign) in _OPERATORS:
            found = _OPERATORS[type(sign)](_value(left, known), _value(right, known))
        case ast.BoolOp(op=sign, values=several):
            decide = all if isinstance(sign, ast.And) else any
            found = decide(_value(each, known) for each in several)
        case ast.UnaryOp(op=ast.Not(), operand=one):
            found = not _value(one, known)
        case _:
            raise NotUnderstoodError
    if isinstance(found, str) and len(found) > _MOST_TEXT:
        raise NotUnderstoodError
    return found
