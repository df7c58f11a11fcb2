"""The folder that rows are kept in: segments that are there as a whole or not at all, and nothing that must agree.

Whatever ends a process at whatever moment, the rows of the segments that are there count, and no others. Nothing
is synchronised to the disk: what a power cut takes away of a segment is found by its checksum, dropped, and
measured again. Several batches may write at once: a segment's name is its content. What is written over, the
answer and the known hashes, is written under a lock, each file in one step. Not for: what is in a row (`rows`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import accumulate
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.known_hashes import KnownHashes
from clearance.batch.mark import MARK
from clearance.batch.row_index import RowIndex
from clearance.batch.rows import STORED
from clearance.batch.segments import generation_of, is_whole, name_of, rows_in
from clearance.errors import Incomplete, Unwritable, unwritable
from clearance.report.folder import is_partial, write_file, written_file

FORMAT = 1
_SEGMENTS, _HASHES, _LOCK = "segments", "files.parquet", ".lock"
_INDEX = ("key", "file", "inputs")

HASHES = 4096
"""Known hashes of files that are read or written at a time."""

MOST_TEXTS = 1000
"""Lists of input files that are kept as text."""


@dataclass(eq=False)
class Store:
    """The rows in a folder; made by `open_store`.

    Attributes:
        n_damaged: segments that were not what their names say, and are gone.
        generation: of what is written from now on; of two rows of one key the later generation's counts.
    """

    place: Path
    n_damaged: int = 0
    generation: int = 0
    _index: RowIndex = field(default_factory=RowIndex)
    _last: tuple[tuple[str, ...], dict[int, pa.Table]] = ((), {})
    _texts: dict[tuple[int, int], str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self._index)

    def find(self, key: str) -> int:
        """The number of a key's row; `NONE` where there is none."""
        return self._index.find(key)

    def key(self, number: int) -> str:
        """The key of a row."""
        return self._index.key(number)

    def inputs(self, file: str) -> Iterator[str]:
        """All that a case file was ever read with, as `rows.inputs_text` writes it."""
        for segment, row in self._index.inputs(file):
            if (segment, row) not in self._texts:
                self._read_inputs(segment)
            yield self._texts[segment, row]

    def _read_inputs(self, segment: int) -> None:
        """Reads what the cases of a segment were made from; what is known of others is dropped if it is much."""
        if len(self._texts) > MOST_TEXTS:
            self._texts.clear()
        table = rows_in(self._kept(segment), ("inputs",))
        for row, text in enumerate(table["inputs"].to_pylist()):
            self._texts[segment, row] = text

    def look(self) -> None:
        """Takes in the segments that have come since, whoever has written them."""
        known = frozenset(self._index.segments)
        for name in self._names():
            if name not in known:
                content = self._content(name)
                if content is not None:
                    self._enter(name, content)

    def put(self, content: bytes) -> None:
        """Keeps a segment.

        Raises:
            Incomplete: there is no way or no room to write; all that was kept before still is.
        """
        name = name_of(content, self.generation)
        try:
            write_file(self.place / _SEGMENTS / name, content)
        except Unwritable as error:
            raise Incomplete(
                error.problem,
                where=str(self.place),
                valid="what was measured before is kept; the same command goes on once there is room",
            ) from None
        self._enter(name, content)

    def rows(self, numbers: Sequence[int], columns: Sequence[str]) -> pa.Table:
        """Some columns of rows, in their order."""
        places = [self._index.place(number) for number in numbers]
        parts = self._tables(dict.fromkeys(segment for segment, _ in places), tuple(columns))
        begins = dict(zip(parts, accumulate(map(len, parts.values()), initial=0), strict=False))
        if not parts:
            return pa.schema([STORED.field(name) for name in columns]).empty_table()
        order = [begins[segment] + row for segment, row in places]
        return (
            pa.concat_tables(parts.values()).take(pa.array(order, type=pa.int64())).select(columns)
        )

    def _tables(self, segments: Iterable[int], columns: tuple[str, ...]) -> dict[int, pa.Table]:
        """Some columns of segments; the last is kept, since what is asked for next begins where this ends."""
        asked, before = self._last
        known = before if asked == columns else {}
        found = {
            one: known[one] if one in known else rows_in(self._kept(one), columns)
            for one in segments
        }
        self._last = columns, dict([*found.items()][-1:])
        return found

    def _kept(self, segment: int) -> bytes:
        return (self.place / _SEGMENTS / self._index.segments[segment]).read_bytes()

    def hashes(self) -> KnownHashes:
        """What is known of input files; nothing where that is damaged."""
        try:
            with pq.ParquetFile(self.place / _HASHES) as file:
                return KnownHashes.of(file.iter_batches(HASHES, use_threads=False))
        except (OSError, KeyError, ValueError, pa.ArrowException):
            return KnownHashes()

    def keep_hashes(self, known: KnownHashes) -> None:
        """Keeps what is known of input files; where there is no room, a later run hashes them again."""
        with suppress(OSError, Unwritable), self.locked():
            with written_file(self.place / _HASHES) as file:
                pq.write_table(known.table(), file, row_group_size=HASHES, use_dictionary=False)

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Alone among the batches that write over something here.

        Raises:
            Unwritable: there is no way to write here.
        """
        from filelock import FileLock

        lock = FileLock(self.place / _LOCK, fallback_to_soft=False)
        with unwritable(self.place):
            lock.acquire()
        try:
            yield
        finally:
            lock.release()

    def _names(self) -> list[str]:
        """All segments, the latest generation first."""
        with os.scandir(self.place / _SEGMENTS) as entries:
            names = [e.name for e in entries if generation_of(e.name) is not None]
        return sorted(names, key=lambda name: (-(generation_of(name) or 0), name))

    def _content(self, name: str) -> bytes | None:
        """The content of a segment; what is damaged is taken away."""
        path = self.place / _SEGMENTS / name
        try:
            content = path.read_bytes()
        except OSError:
            return None
        if is_whole(name, content):
            return content
        self.n_damaged += 1
        with suppress(OSError):
            path.unlink()
        return None

    def _enter(self, name: str, content: bytes) -> None:
        table = rows_in(content, _INDEX)
        columns = [table[column].to_pylist() for column in _INDEX]
        self._index.enter(name, generation_of(name) or 0, *columns)


def open_store(place: Path, *, make: bool = True, fresh: bool = False) -> Store:
    """The store in a folder, which is made where there is none.

    Args:
        make: False to refuse where there is none. fresh: what is written from now on replaces what is there.

    Raises:
        Unwritable: something else is there, or it cannot be written. Incomplete: there is no room.
    """
    _require_store(place, make)
    if make and not (place / MARK).exists():
        _make(place)
    store = Store(place)
    store.look()
    generations = [generation_of(name) or 0 for name in store._names()]
    store.generation = max(generations, default=0) + (1 if fresh else 0)
    return store


def _require_store(place: Path, make: bool) -> None:
    if not place.exists() and make:
        return
    if not place.is_dir():
        fault = "is a file" if place.exists() else "there is no such folder"
        raise Unwritable(
            fault, where=str(place), valid="a folder that `clearance batch` keeps rows in"
        )
    mark = place / MARK
    nothing_else = all(_is_of_beginning(path.name) for path in place.iterdir())
    if not mark.exists():  # asked last: what other batches write, they write once it is there
        if make and nothing_else:
            return
        raise Unwritable(
            "is a folder of something else", where=str(place), valid="a new folder, or a store"
        )
    try:
        found = json.loads(mark.read_text())["format"]
    except (OSError, ValueError, KeyError, TypeError):
        found = None
    if found != FORMAT:
        raise Unwritable(
            f"is a store of format {found!r}",
            where=str(place),
            valid=f"one of format {FORMAT}, or a new folder",
        )


def _is_of_beginning(name: str) -> bool:
    """True for what is in a store before its mark is: the folder of segments, and marks that are being written."""
    return name == _SEGMENTS or is_partial(name, MARK)


def _make(place: Path) -> None:
    with unwritable(place):
        (place / _SEGMENTS).mkdir(parents=True, exist_ok=True)
    write_file(place / MARK, (json.dumps({"format": FORMAT}) + "\n").encode())
