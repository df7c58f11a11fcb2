"""Dimensions as expressions of named parameters, evaluated without `eval`.

Allowed: numbers, names, + - * / **, unary signs, parentheses, pi, and the functions sqrt, sin, cos,
tan, asin, acos, atan, atan2, radians, degrees, abs, min, max, hypot. Anything else is refused with
the expression.
"""

from __future__ import annotations

import ast
import functools
import math
import operator
from collections.abc import Callable, Mapping

from clearance.errors import BadSyntax, NotFinite, UnknownKey, nearest_name

_FUNCTIONS = {
    name: getattr(math, name)
    for name in "sqrt sin cos tan asin acos atan atan2 radians degrees hypot".split()
} | {"abs": abs, "min": min, "max": max}
_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.unaryop], Callable[[float], float]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_LONGEST = 1000


def names_in(expression: str) -> frozenset[str]:
    """The parameters that an expression mentions.

    Raises:
        BadSyntax: it is not an expression of the allowed kind.
    """
    called = {id(node.func) for node in ast.walk(_parsed(expression)) if isinstance(node, ast.Call)}
    return frozenset(
        node.id
        for node in ast.walk(_parsed(expression))
        if isinstance(node, ast.Name) and id(node) not in called and node.id != "pi"
    )


def evaluated(expression: str, numbers: Mapping[str, float]) -> float:
    """The value of an expression for the given parameters.

    Raises:
        BadSyntax: it is not an expression of the allowed kind.
        UnknownKey: it mentions a parameter that is not there.
        NotFinite: it has no finite value (division by zero, root of a negative number).
    """
    tree = _parsed(expression)
    try:
        value = float(_value(tree, numbers, expression))
    except (ArithmeticError, ValueError, TypeError) as fault:
        if isinstance(fault, (BadSyntax, UnknownKey)):
            raise
        raise NotFinite(f"the expression {expression!r} has no value ({fault})") from None
    if not math.isfinite(value):
        raise NotFinite(f"the expression {expression!r} is {value}", valid="a finite number")
    return value


@functools.lru_cache(maxsize=4096)
def _parsed(expression: str) -> ast.expr:
    if len(expression) > _LONGEST:
        raise BadSyntax(
            f"an expression of {len(expression)} characters", valid=f"at most {_LONGEST}"
        )
    try:
        return ast.parse(expression, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise BadSyntax(
            f"{expression!r} is not an expression",
            valid="numbers, names, + - * / **, sqrt, sin, ...",
        ) from None


def _value(node: ast.expr, numbers: Mapping[str, float], whole: str) -> float:
    if isinstance(node, ast.Constant):
        if isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            return float(node.value)
    if isinstance(node, ast.Name):
        if node.id == "pi":
            return math.pi
        if node.id not in numbers:
            raise UnknownKey(
                f"unknown parameter {node.id!r} in {whole!r}", valid=nearest_name(node.id, numbers)
            )
        return numbers[node.id]
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        left, right = _value(node.left, numbers, whole), _value(node.right, numbers, whole)
        return _BINARY[type(node.op)](left, right)
    if isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        return _UNARY[type(node.op)](_value(node.operand, numbers, whole))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id in _FUNCTIONS:
            return _FUNCTIONS[node.func.id](*(_value(a, numbers, whole) for a in node.args))
        raise BadSyntax(
            f"unknown function {node.func.id!r} in {whole!r}",
            valid=nearest_name(node.func.id, _FUNCTIONS),
        )
    raise BadSyntax(
        f"{whole!r} uses what is not allowed", valid="numbers, names, + - * / **, sqrt(...), ..."
    )
