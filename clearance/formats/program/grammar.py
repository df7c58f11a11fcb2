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
        folds: whether capital letters mean the same as small ones. spelling: how names are written then, by their
            small letters; others are in small letters.
    """

    binary: Mapping[str, tuple[int, Callable[..., Any]]]
    unary: Mapping[str, tuple[int, Callable[..., Any]]]
    constants: Mapping[str, Any] = field(default_factory=dict)
    index: str = "[]"
    optional: str = ""
    before_items: tuple[str, ...] = ()
    folds: bool = False
    spelling: Mapping[str, str] = field(default_factory=dict)

    def folded(self, name: str) -> str:
        """A name as it is compared."""
        if not self.folds:
            return name
        return self.spelling.get(name.lower()) or Spelled(name.lower(), str(name))
