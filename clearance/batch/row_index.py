"""Where the rows of a store lie, by key, and from which files they were made: some 50 bytes a row.

Not for: the segments themselves (`store`).
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence

from clearance.batch.digest_table import NONE, TEXT_WIDTH, DigestTable, digest_of_text


class RowIndex:
    """Rows numbered by key, each in the latest segment that has it."""

    def __init__(self) -> None:
        self.segments: list[str] = []
        self._generations: list[int] = []
        self._keys = DigestTable(32)
        self._segment, self._row = array("I"), array("I")
        self._inputs = _InputsIndex()

    def __len__(self) -> int:
        return len(self._keys)

    def find(self, key: str) -> int:
        """The number of a key's row; `NONE` where there is none."""
        return self._keys.find(bytes.fromhex(key))

    def key(self, number: int) -> str:
        """The key of a row."""
        return self._keys[number].hex()

    def place(self, number: int) -> tuple[int, int]:
        """The segment that a row is in, by number, and its place there."""
        return self._segment[number], self._row[number]

    def enter(
        self,
        name: str,
        generation: int,
        keys: Sequence[str],
        files: Sequence[str],
        inputs: Sequence[str],
    ) -> None:
        """Takes the rows of a segment in; of two rows of one key the later generation's counts, then the first."""
        segment = len(self.segments)
        self.segments.append(name)
        self._generations.append(generation)
        for row, key in enumerate(keys):
            number = self._keys.enter(bytes.fromhex(key))
            if number == len(self._segment):
                self._segment.append(segment)
                self._row.append(row)
            elif generation > self._generations[self._segment[number]]:
                self._segment[number], self._row[number] = segment, row
        last = ("", "")
        for row, pair in enumerate(zip(files, inputs, strict=True)):
            if pair != last:
                self._inputs.enter(*pair, segment, row)
                last = pair

    def inputs(self, file: str) -> Iterator[tuple[int, int]]:
        """Segment and row of each list of files that a case file was ever read with, in order."""
        return self._inputs.places(file)


class _InputsIndex:
    """What case files were read with: of each list of files one row that has it."""

    def __init__(self) -> None:
        self._files, self._lists = DigestTable(TEXT_WIDTH), DigestTable(TEXT_WIDTH)
        self._first, self._last, self._next = array("i"), array("i"), array("i")
        self._segment, self._row = array("I"), array("I")

    def enter(self, file: str, inputs: str, segment: int, row: int) -> None:
        """Takes in what a case file was read with, unless it is known."""
        number = self._lists.enter(digest_of_text(f"{file}\0{inputs}"))
        if number < len(self._segment):
            return
        self._segment.append(segment)
        self._row.append(row)
        self._next.append(NONE)
        whose = self._files.enter(digest_of_text(file))
        if whose == len(self._first):
            self._first.append(number)
            self._last.append(number)
        else:
            self._next[self._last[whose]] = number
            self._last[whose] = number

    def places(self, file: str) -> Iterator[tuple[int, int]]:
        """Segment and row of each list of a case file."""
        whose = self._files.find(digest_of_text(file))
        number = NONE if whose == NONE else self._first[whose]
        while number != NONE:
            yield self._segment[number], self._row[number]
            number = self._next[number]
