"""The part of a case that no trajectory changes, as one key: its results are computed once for many cases.

Two cases are of one cell where their robots, bases, obstacles, limits and what may touch are the same objects or
alike; commanded motions are no part of it. Not for: caching cases (`lru_cache` keeps its arguments; this
keeps none of a case's trajectories).
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from functools import wraps
from typing import Any, TypeVar

Result = TypeVar("Result")

MOST_CELLS = 16
"""Cells that are known at a time."""


class Cell:
    """The key of a cell: objects by what they are, values by what they say.

    It keeps the objects, so that no other can get an address that identifies one of them.
    """

    __slots__ = ("_hash", "_key", "_objects")

    def __init__(self, objects: Sequence[object], values: Hashable) -> None:
        self._objects, self._key = objects, (tuple(map(id, objects)), values)
        self._hash = hash(self._key)

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, Cell) and self._key == other._key)

    def __hash__(self) -> int:
        return self._hash


_known: OrderedDict[Cell, Cell] = OrderedDict()


def cell_of(objects: Sequence[object], values: Hashable) -> Cell:
    """The cell of some objects and values; the same one as before where they are.

    Values that are no key, as lists are none, make a cell of its own.
    """
    try:
        made = Cell(objects, values)
    except TypeError:
        return Cell([object()], None)
    cell = _known.setdefault(made, made)
    _drop_the_oldest(_known, MOST_CELLS)
    return cell


def once_a_cell(most: int) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Decorates a function of a case and of further keys whose answer follows from the case's cell and those.

    Nobody may change what it returns. It caches the last `most` answers.
    """

    def decorated(work: Callable[..., Result]) -> Callable[..., Result]:
        known: OrderedDict[tuple[Cell, tuple], Result] = OrderedDict()

        @wraps(work)
        def found(case: Any, *others: Any) -> Result:
            key = (case.cell, others)
            if key in known:
                with suppress(KeyError):  # another thread may have let go of it
                    return known[key]
            answer = known[key] = work(case, *others)
            _drop_the_oldest(known, most)
            return answer

        return found

    return decorated


def _drop_the_oldest(known: OrderedDict, most: int) -> None:
    with suppress(KeyError):
        while len(known) > most:
            known.popitem(last=False)
