"""Rows that are made when they are looked at. Not for: what is kept of them, which each kind of row decides."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TypeVar, overload

Row = TypeVar("Row")


class RowsOnDemand(Sequence[Row]):
    """A sequence that says how long it is and makes one row at a time; a slice is a tuple."""

    @abstractmethod
    def _at(self, i: int) -> Row:
        """Row `i`, from 0."""

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Row, ...]: ...

    def __getitem__(self, index: int | slice) -> Row | tuple[Row, ...]:
        chosen = range(len(self))[index]
        return self._at(chosen) if isinstance(chosen, int) else tuple(map(self._at, chosen))
