"""What of a case no trajectory changes, as one key: what follows from it alone is worked out once for many cases.

Two cases are of one cell where their robots, bases, obstacles, limits and what may touch are the same objects or
alike; what robots are asked to do is not among it. Not for: keeping cases (`lru_cache` holds its arguments; this
holds none of a case's trajectories).
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from functools import wraps
from typing import Any, Protocol, TypeVar

Result = TypeVar("Result")

MOST_CELLS = 16
"""Cells that are known at a time."""


class Cell:
    """The key of a cell: objects by what they are, values by what they say.

    It holds the objects, so that no other can come to lie in the place by which they are told apart.
    """

    __slots__ = ("_hash", "_held", "_told")

    def __init__(self, held: Sequence[object], told: Hashable) -> None:
        self._held, self._told = held, (tuple(map(id, held)), told)
        self._hash = hash(self._told)

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, Cell) and self._told == other._told)

    def __hash__(self) -> int:
        return self._hash


_known: OrderedDict[Cell, Cell] = OrderedDict()


def cell_of(held: Sequence[object], told: Hashable) -> Cell:
    """The cell of some objects and values; the same one as before where they are.

    Values that are no key, as lists are none, make a cell of its own.
    """
    try:
        made = Cell(held, told)
    except TypeError:
        return Cell([object()], None)
    cell = _known.setdefault(made, made)
    _keep_the_last(_known, MOST_CELLS)
    return cell


class CellOwner(Protocol):
    """What has a cell: a case."""

    @property
    def cell(self) -> Cell: ...


def once_a_cell(most: int) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Decorates a function of a case and of further keys whose answer follows from the case's cell and those.

    Nobody may change what it returns. Answers of the last `most` questions are kept.
    """

    def decorated(work: Callable[..., Result]) -> Callable[..., Result]:
        known: OrderedDict[tuple[Cell, tuple], Result] = OrderedDict()

        @wraps(work)
        def found(case: CellOwner, *others: Any) -> Result:
            key = (case.cell, others)
            if key in known:
                with suppress(KeyError):  # another thread may have let go of it
                    return known[key]
            answer = known[key] = work(case, *others)
            _keep_the_last(known, most)
            return answer

        return found

    return decorated


def _keep_the_last(known: OrderedDict, most: int) -> None:
    with suppress(KeyError):
        while len(known) > most:
            known.popitem(last=False)
