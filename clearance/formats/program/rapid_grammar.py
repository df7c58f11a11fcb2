"""How RAPID is written: its words, and its expressions. Not for: statements (`rapid_text`).

Source: ABB, Technical reference manual, RAPID kernel.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from functools import partial
from typing import Any

from clearance.formats.program.expressions import COMPARED, numeric
from clearance.formats.program.grammar import Grammar, Spelled
from clearance.formats.program.rapid_words import WORDS as KNOWN

WORDS = re.compile(
    r"""(?P<skip>\s+|![^\n]*|%%%.*?%%%)
    |(?P<number>0[xX][0-9a-fA-F]+|0[bB][01]+|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    |(?P<name>[A-Za-z_][A-Za-z_0-9]*)
    |(?P<string>"(?:[^"\n]|"")*")
    |(?P<operator>:=|<>|<=|>=|[-+*/<>=(){}\[\],.;:\\|?%])""",
    re.VERBOSE | re.DOTALL,
)


def added(a: object, b: object) -> object:
    """Numbers, texts and positions are added."""
    if isinstance(a, str) and isinstance(b, str):
        return a + b
    return _by_item(operator.add, a, b)


def _by_item(act: Callable[[Any, Any], Any], a: object, b: object) -> object:
    """An operator on numbers, or on each item of two positions."""
    if isinstance(a, list) and isinstance(b, list):
        return [numeric(act)(x, y) for x, y in zip(a, b, strict=True)]
    return numeric(act)(a, b)


def _product(a: object, b: object) -> object:
    """Numbers, and a position by a number, are multiplied.

    Raises:
        TypeError: other things are.
    """
    for one, by in ((a, b), (b, a)):
        if isinstance(one, list) and len(one) == 3 and not isinstance(by, list):
            return [numeric(operator.mul)(x, by) for x in one]
    return numeric(operator.mul)(a, b)


GRAMMAR = Grammar(
    binary={
        "OR": (1, lambda a, b: bool(a) or bool(b)),
        "XOR": (1, lambda a, b: bool(a) != bool(b)),
        "AND": (2, lambda a, b: bool(a) and bool(b)),
        "=": (4, operator.eq),
        "<>": (4, operator.ne),
        **{word: (4, act) for word, act in COMPARED.items()},
        "+": (5, added),
        "-": (5, partial(_by_item, operator.sub)),
        "*": (6, _product),
        "/": (6, numeric(operator.truediv)),
        "DIV": (6, numeric(lambda a, b: float(int(a / b)))),
        "MOD": (6, numeric(lambda a, b: a - b * int(a / b))),
    },
    unary={
        "NOT": (3, operator.not_),
        "-": (7, lambda a: _product(-1.0, a)),
        "+": (7, lambda a: a),
    },
    constants={"true": True, "false": False},
    index="{}",
    optional="\\",
    fold=lambda name: KNOWN.get(name.lower()) or Spelled(name.lower(), str(name)),
)
