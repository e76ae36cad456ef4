"""Works out a launch file's `$(eval …)`, as far as it is arithmetic, comparisons and names."""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

from course_lib.grading.launch_values import converted

if TYPE_CHECKING:
    from collections.abc import Callable

    Known = Callable[[str, str], str]

_MOST_TEXT = 2000  # characters, of the expression and of what comes of it


class NotUnderstoodError(Exception):
    """It is more than is understood here."""


def _of_numbers(work: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """Keep texts out: one that is repeated, or formatted, could fill the memory."""

    def guarded(one: Any, other: Any) -> Any:  # noqa: ANN401
        if isinstance(one, str) or isinstance(other, str):
            raise NotUnderstoodError
        return work(one, other)

    return guarded


_OPERATORS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _of_numbers(operator.mul),
    ast.Mod: _of_numbers(operator.mod),
    ast.FloorDiv: operator.floordiv,
    ast.Div: operator.truediv,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "int": int,
    "float": float,
    "str": str,
    "bool": bool,
    "abs": abs,
    "max": max,
    "min": min,
    "round": round,
}
_SIGNS: dict[type[ast.AST], Callable[[Any], Any]] = {ast.Not: operator.not_, ast.USub: operator.neg}
_SUBSTITUTIONS = {"arg", "find", "env", "optenv", "dirname", "anon"}


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
        When it holds anything but names, constants, arithmetic, comparisons and a few functions.
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
        case ast.Call(func=ast.Name(id=name), args=inner) if name in _FUNCTIONS:
            found = _FUNCTIONS[name](*(_value(each, known) for each in inner))
        case (
            ast.BinOp(left=left, op=sign, right=right)
            | ast.Compare(left=left, ops=[sign], comparators=[right])
        ) if type(sign) in _OPERATORS:
            found = _OPERATORS[type(sign)](_value(left, known), _value(right, known))
        case ast.BoolOp(op=sign, values=several):
            decide = all if isinstance(sign, ast.And) else any
            found = decide(_value(each, known) for each in several)
        case ast.UnaryOp(op=sign, operand=one) if type(sign) in _SIGNS:
            found = _SIGNS[type(sign)](_value(one, known))
        case ast.IfExp(test=test, body=body, orelse=orelse):
            found = _value(body if _value(test, known) else orelse, known)
        case _:
            raise NotUnderstoodError
    if isinstance(found, str) and len(found) > _MOST_TEXT:
        raise NotUnderstoodError
    return found
