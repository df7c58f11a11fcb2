"""The sha256 of many input files with the marks that they had: some 70 bytes a file.

A file is kept as a digest of its path, one of path and marks together, and its sha256. So no path is told from
another by its marks alone, nor the reverse. Not for: whether a hash can be believed (`file_hashes`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import pyarrow as pa

from clearance.batch.digest_table import NONE, TEXT_WIDTH, DigestTable, digest_of_text

_SHA256_WIDTH = 32
_COLUMNS = {"path": TEXT_WIDTH, "marks": TEXT_WIDTH, "sha256": _SHA256_WIDTH}
"""Of the table that is kept, each with the bytes of an entry."""


class KnownHashes:
    """Hashes of files by path and marks; of each path the last marks that were told."""

    def __init__(self) -> None:
        self._paths = DigestTable(TEXT_WIDTH)
        self._marks, self._hashes = bytearray(), bytearray()

    def __len__(self) -> int:
        return len(self._paths)

    def find(self, path: str, marks: Sequence[int]) -> str | None:
        """The sha256 of a file of these marks; None where it is not known."""
        number = self._paths.find(digest_of_text(path))
        if number == NONE or self._marks[_entry(number, TEXT_WIDTH)] != _digest(path, marks):
            return None
        return self._hashes[_entry(number, _SHA256_WIDTH)].hex()

    def learn(self, path: str, marks: Sequence[int], sha256: str) -> bool:
        """Takes over what is known of a file; True if that is new."""
        told, content = _digest(path, marks), bytes.fromhex(sha256)
        number = self._paths.enter(digest_of_text(path))
        at, of_hash = _entry(number, TEXT_WIDTH), _entry(number, _SHA256_WIDTH)
        if self._marks[at] == told and self._hashes[of_hash] == content:
            return False
        self._marks[at], self._hashes[of_hash] = told, content
        return True

    def table(self) -> pa.Table:
        """All of them, as `of` takes them."""
        parts = (self._paths.content, self._marks, self._hashes)
        columns = {
            name: pa.FixedSizeBinaryArray.from_buffers(
                pa.binary(width), len(self), [None, pa.py_buffer(bytes(content))]
            )
            for (name, width), content in zip(_COLUMNS.items(), parts, strict=True)
        }
        return pa.table(columns)

    @staticmethod
    def of(batches: Iterable[pa.RecordBatch]) -> KnownHashes:
        """Those of a table.

        Raises:
            KeyError, ValueError: it is of another form.
        """
        made = KnownHashes()
        for batch in batches:
            paths, marks, hashes = (
                _bytes(batch.column(name), width) for name, width in _COLUMNS.items()
            )
            for start in range(0, len(paths), TEXT_WIDTH):
                made._paths.enter(paths[start : start + TEXT_WIDTH])
            made._marks += marks
            made._hashes += hashes
        if TEXT_WIDTH * len(made) != len(made._marks):
            raise ValueError("a path stands twice")
        return made


def _entry(number: int, width: int) -> slice:
    """Where an entry of a column lies."""
    return slice(width * number, width * (number + 1))


def _bytes(column: pa.Array, width: int) -> bytes:
    """The entries of a column, one after another."""
    if column.type != pa.binary(width) or column.null_count:
        raise ValueError("another form")
    content = column.buffers()[1]
    start = width * column.offset
    return content.slice(start, width * len(column)).to_pybytes()


def _digest(path: str, marks: Sequence[int]) -> bytes:
    return digest_of_text(f"{path}\0{tuple(marks)}")
