"""How a language writes expressions: operators, brackets, names. Not for: reading them (`expressions`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


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

    binary: Mapping[str, tuple[int, Callable[..., Any]]]
    unary: Mapping[str, tuple[int, Callable[..., Any]]]
    constants: Mapping[str, Any] = field(default_factory=dict)
    index: str = "[]"
    optional: str = ""
    before_items: tuple[str, ...] = ()
    leaves_out: bool = False
    fold: Callable[[str], str] | None = None

    def folded(self, name: str) -> str:
        """A name as it is compared."""
        return name if self.fold is None else self.fold(name)
