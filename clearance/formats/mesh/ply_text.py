"""Rows of a text PLY file, one a line, each with as many numbers as the header and its lists say."""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.mesh.ply_rows import Element, PlyRows, Property
from clearance.formats.text.numbers import floats, integers


class TextRows:
    """Rows of a text file: one a line."""

    def __init__(self, body: bytes) -> None:
        self.lines = [row for line in body.splitlines() if (row := line.split())]
        self.place = 0

    def rows(self, element: Element) -> PlyRows:
        """The next rows."""
        lines = self.lines[self.place : self.place + element.n_rows]
        if len(lines) < element.n_rows:
            raise BadSyntax(
                f"{len(lines)} of its {element.n_rows} lines are there: the file is cut off"
            )
        self.place += element.n_rows
        lists = [item for item in element.properties if item.length_kind is not None]
        if not lists:
            return self._table(lines, element.properties)
        return self._with_lists(lines, element.properties)

    def _table(self, lines: list[list[bytes]], properties: list[Property]) -> PlyRows:
        for i, row in enumerate(lines):
            if len(row) != len(properties):
                raise BadSyntax(f"row {i} has {len(row)} numbers", valid=f"{len(properties)}")
        columns = {
            item.name: _column([row[k] for row in lines], item.kind)
            for k, item in enumerate(properties)
        }
        return PlyRows(len(lines), columns, {})

    def _with_lists(self, lines: list[list[bytes]], properties: list[Property]) -> PlyRows:
        single: dict[str, list[bytes]] = {p.name: [] for p in properties if p.length_kind is None}
        flat: dict[str, list[bytes]] = {p.name: [] for p in properties if p.length_kind is not None}
        counts: dict[str, list[int]] = {name: [] for name in flat}
        for i, row in enumerate(lines):
            place = 0
            for item in properties:
                if item.length_kind is None:
                    single[item.name] += row[place : place + 1]
                    place += 1
                    continue
                count = _length(row[place]) if place < len(row) else -1
                flat[item.name] += row[place + 1 : place + 1 + max(count, 0)]
                counts[item.name].append(count)
                place = place + 1 + count if count >= 0 else -len(row) - 1
            if place != len(row):
                raise BadSyntax(f"row {i} has {len(row)} numbers, which is not what its lists say")
        kinds = {item.name: item.kind for item in properties}
        columns = {name: _column(words, kinds[name]) for name, words in single.items()}
        lists = {n: (_column(words, kinds[n]), np.array(counts[n])) for n, words in flat.items()}
        return PlyRows(len(lines), columns, lists)

    def refuse_rest(self) -> None:
        """Refuses lines that no element has."""
        if self.place < len(self.lines):
            n_more = len(self.lines) - self.place
            raise BadSyntax(f"the PLY file has {n_more} lines more than its header says")


def _length(word: bytes) -> int:
    """How long a list is; -1 where that is no number, or one that no line has room for."""
    return int(word) if word.isdigit() and len(word) < 10 else -1


def _column(words: list[bytes], kind: np.dtype) -> np.ndarray:
    """The words as numbers: whole ones where the header says so, others in double precision."""
    return integers(words) if kind.kind in "iu" else floats(words)
