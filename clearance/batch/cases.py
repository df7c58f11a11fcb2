"""The cases of a batch in some 40 bytes each: an `Item` is made when somebody asks for it.

What many cases have in common, as cell, reading and options, is there once. Not for: which cases there are
(`manifest`).
"""

from __future__ import annotations

import os
from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, overload

from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.options import CaseOptions


class Texts:
    """Texts by number, as bytes one after another."""

    def __init__(self) -> None:
        self._bytes, self._ends = bytearray(), array("Q", [0])

    def append(self, text: str) -> None:
        """Adds a text, the next by number."""
        self._bytes += text.encode("utf-8", "surrogatepass")
        self._ends.append(len(self._bytes))

    def __len__(self) -> int:
        return len(self._ends) - 1

    def __getitem__(self, number: int) -> str:
        start, end = self._ends[number], self._ends[number + 1]
        return self._bytes[start:end].decode("utf-8", "surrogatepass")


class _Shared(NamedTuple):
    """What cases have in common.

    Attributes:
        cell: the cell's file; None where each case is a file of its own.
        folder: that the paths of most are in, with a separator at its end.
    """

    cell: str | None
    reading: str
    robot: str | None
    options: CaseOptions
    folder: str


class Cases(Sequence[Item]):
    """The cases of a batch in order; the number of each is its place."""

    def __init__(self) -> None:
        self._names, self._paths = Texts(), Texts()
        self._kinds = array("I")
        self._shared: list[_Shared] = []
        self._kind_of: dict[tuple[str | None, str, str | None, int], int] = {}

    @staticmethod
    def of(items: Iterable[Item]) -> Cases:
        """The cases that some items are, numbered anew."""
        made = Cases()
        for item in items:
            made.append(item)
        return made

    def append(self, item: Item) -> None:
        """Adds a case; its number is its place from now on."""
        given = item.trajectory
        path = item.file if given is None else given.path
        kind = self._kind(item, path)
        folder = self._shared[kind].folder
        self._names.append(item.name)
        self._paths.append(path[len(folder) :] if path.startswith(folder) else path)
        self._kinds.append(kind)

    def _kind(self, item: Item, path: str) -> int:
        given = item.trajectory
        cell = None if given is None else item.file
        reading, robot = ("", None) if given is None else (given.reading, given.robot)
        key = (cell, reading, robot, id(item.options))  # which `_shared` keeps alive
        kind = self._kind_of.get(key)
        if kind is None:
            kind = self._kind_of[key] = len(self._shared)
            folder = os.path.join(os.path.dirname(os.path.dirname(path)), "")
            self._shared.append(_Shared(cell, reading, robot, item.options, folder))
        return kind

    def __len__(self) -> int:
        return len(self._kinds)

    @overload
    def __getitem__(self, at: int) -> Item: ...
    @overload
    def __getitem__(self, at: slice) -> SomeCases: ...
    def __getitem__(self, at: int | slice) -> Item | SomeCases:
        if isinstance(at, slice):
            return SomeCases(self, range(len(self))[at])
        return self._item(range(len(self))[at])

    def __iter__(self) -> Iterator[Item]:
        return map(self._item, range(len(self)))

    def _item(self, number: int) -> Item:
        shared = self._shared[self._kinds[number]]
        path = os.path.join(shared.folder, self._paths[number])
        name = self._names[number]
        if shared.cell is None:
            return Item(number, name, path, None, shared.options)
        given = GivenTrajectory(path, shared.reading, shared.robot)
        return Item(number, name, shared.cell, given, shared.options)

    @property
    def numbers(self) -> Sequence[int]:
        """The number of each."""
        return range(len(self))

    @property
    def cells(self) -> list[str]:
        """The files of cells, in the order in which the cases come to them."""
        found = dict.fromkeys(shared.cell for shared in self._shared)
        return [cell for cell in found if cell is not None]

    def of_cell(self, file: str) -> SomeCases:
        """The motions in a cell."""
        own = [shared.cell == file for shared in self._shared]
        return self.among(i for i, kind in enumerate(self._kinds) if own[kind])

    def names(self) -> Iterator[str]:
        """The name of each."""
        return map(self._names.__getitem__, range(len(self)))

    def name(self, number: int) -> str:
        """The name of a case."""
        return self._names[number]

    def among(self, places: Iterable[int]) -> SomeCases:
        """Those at some places."""
        return SomeCases(self, array("I", places))

    @property
    def options(self) -> list[CaseOptions]:
        """What is asked of some case, each once, in the order in which the cases come to it."""
        return list(dict.fromkeys(shared.options for shared in self._shared))


class SomeCases(Sequence[Item]):
    """Some cases of a batch in any order, under the numbers that they have in it.

    Args:
        numbers: theirs.
    """

    def __init__(self, cases: Cases, numbers: Sequence[int]) -> None:
        self._cases, self._numbers = cases, numbers

    def __len__(self) -> int:
        return len(self._numbers)

    @overload
    def __getitem__(self, at: int) -> Item: ...
    @overload
    def __getitem__(self, at: slice) -> SomeCases: ...
    def __getitem__(self, at: int | slice) -> Item | SomeCases:
        if isinstance(at, slice):
            return SomeCases(self._cases, self._numbers[at])
        return self._cases[self._numbers[at]]

    @property
    def numbers(self) -> Sequence[int]:
        """Theirs."""
        return self._numbers

    def names(self) -> Iterator[str]:
        """The name of each."""
        return map(self._cases.name, self._numbers)

    def among(self, places: Iterable[int]) -> SomeCases:
        """Those at some places of these."""
        return SomeCases(self._cases, array("I", (self._numbers[i] for i in places)))


SomeOrAll = Cases | SomeCases
"""The cases of a batch or of a part of it."""
