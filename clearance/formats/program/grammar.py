"""How a language writes expressions: operators, brackets, names. Not for: reading them (`expressions`)."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Act = Callable[..., Any]
"""What an operator does with values."""

LARGEST = 2**63
"""Whole numbers are smaller: they would grow without bound in a loop."""


def is_number(value: object) -> bool:
    """True for a number; a truth value is none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def numeric(act: Act) -> Act:
    """An operator that refuses all but numbers, and what is too large for a whole one."""

    def applied(a: Any, b: Any) -> Any:
        for one in (a, b):
            if not is_number(one):
                raise TypeError
        found = act(a, b)
        if isinstance(found, int) and abs(found) >= LARGEST:
            raise OverflowError
        return found

    return applied


USUAL: Mapping[str, Act] = {
    "OR": lambda a, b: bool(a) or bool(b),
    "XOR": lambda a, b: bool(a) != bool(b),
    "AND": lambda a, b: bool(a) and bool(b),
    **dict.fromkeys(("=", "=="), operator.eq),
    **dict.fromkeys(("<>", "!="), operator.ne),
    **{"<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge},
    **{"+": numeric(operator.add), "-": numeric(operator.sub)},
    **{"*": numeric(operator.mul), "/": numeric(operator.truediv)},
    "DIV": numeric(lambda a, b: float(math.trunc(a / b))),
    **dict.fromkeys(("MOD", "%"), numeric(math.fmod)),
}
"""Operators on two values, as most languages have them."""


def ranked(*ranks: str, own: Mapping[str, Act] | None = None) -> dict[str, tuple[int, Act]]:
    """Operators on two values with how firmly each binds, from 1 on.

    Args:
        ranks: the words of those that bind alike, the least firmly first. own: what some do that is not usual.
    """
    acts = {**USUAL, **(own or {})}
    words = ((power, word) for power, rank in enumerate(ranks, 1) for word in rank.split())
    return {word: (power, acts[word.upper()]) for power, word in words}


class Spelled(str):
    """A name as it is compared; messages show it as it is written."""

    def __new__(cls, name: str, written: str = "") -> Spelled:
        found = super().__new__(cls, name)
        found.written = written or name
        return found

    written: str

    def __str__(self) -> str:
        return self.written

    def __repr__(self) -> str:
        return repr(self.written)

    def __format__(self, spec: str) -> str:
        return format(self.written, spec)


@dataclass(frozen=True)
class Grammar:
    """How a language writes expressions.

    Attributes:
        binary, unary: operators, how firmly each binds, and what it does.
        constants: words for values. index: the brackets of an index. before_items: words before a bracket of
            values. optional: what is before the name of an argument (then `:=`); empty where `=` behind it is.
        leaves_out: whether nothing may stand where an argument is expected.
        fold: a name as it is compared, where capital letters mean the same as small ones; else None.
    """

    binary: Mapping[str, tuple[int, Act]]
    unary: Mapping[str, tuple[int, Act]]
    constants: Mapping[str, Any] = field(default_factory=dict)
    index: str = "[]"
    optional: str = ""
    before_items: tuple[str, ...] = ()
    leaves_out: bool = False
    fold: Callable[[str], str] | None = None

    def folded(self, name: str) -> str:
        """A name as it is compared."""
        return name if self.fold is None else self.fold(name)
