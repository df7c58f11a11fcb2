"""The folder that rows are kept in: segments that are there as a whole or not at all, and nothing that must agree.

Whatever ends a process at whatever moment, the rows of the segments that are there count, and no others. Nothing
is synchronised to the disk: what a power cut takes away of a segment is found by its checksum, dropped, and
measured again. Several batches may write at once: a segment's name is its content. What is written over, the
answer and the known hashes, is written under a lock, each file in one step. Not for: what is in a row (`rows`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import field
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.file_hashes import FileStamp
from clearance.batch.rows import STORED
from clearance.batch.segments import generation_of, is_whole, name_of, rows_in
from clearance.errors import Incomplete, Unwritable, unwritable
from clearance.late_dataclass import dataclass
from clearance.report.folder import write_file

MARK = "store.json"
FORMAT = 1
_SEGMENTS, _HASHES, _LOCK = "segments", "files.parquet", ".lock"
_INDEX = ("key", "file", "inputs")


@dataclass(eq=False)
class Store:
    """The rows in a folder; made by `open_store`.

    Attributes:
        inputs: of each case file all that was ever read with it, as `rows.inputs_text` writes it.
        n_damaged: segments that were not what their names say, and are gone.
        generation: of what is written from now on; of two rows of one key the later generation's counts.
    """

    place: Path
    inputs: dict[str, dict[str, None]] = field(default_factory=dict)
    n_damaged: int = 0
    generation: int = 0
    _at: dict[str, str] = field(default_factory=dict)
    _read: set[str] = field(default_factory=set)

    def __contains__(self, key: str) -> bool:
        return key in self._at

    def __len__(self) -> int:
        return len(self._at)

    def look(self) -> None:
        """Takes in the segments that have come since, whoever has written them."""
        for name in self._names():
            if name not in self._read:
                content = self._content(name)
                if content is not None:
                    self._enter(name, rows_in(content, _INDEX))

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
        self._enter(name, rows_in(content, _INDEX))

    def rows(self, keys: Sequence[str]) -> pa.Table:
        """The rows of keys, in their order; each key must be there."""
        names = sorted({self._at[key] for key in keys})
        wanted = frozenset(keys)
        parts: list[pa.Table] = []
        found: dict[str, int] = {}
        n_rows = 0
        for name in names:
            table = rows_in((self.place / _SEGMENTS / name).read_bytes())
            for i, key in enumerate(table["key"].to_pylist()):
                if key in wanted and self._at[key] == name:
                    found.setdefault(key, n_rows + i)
            parts.append(table)
            n_rows += table.num_rows
        if not parts:
            return STORED.empty_table()
        order = pa.array([found[key] for key in keys], type=pa.int64())
        return pa.concat_tables(parts).take(order)

    def hashes(self) -> dict[str, FileStamp]:
        """What is known of input files; nothing where that is damaged."""
        try:
            table = pq.read_table(self.place / _HASHES, partitioning=None)
            columns = [table[name].to_pylist() for name in ("path", *FileStamp._fields)]
        except (OSError, KeyError, pa.ArrowException):
            return {}
        return {path: FileStamp(*seen) for path, *seen in zip(*columns, strict=True)}

    def keep_hashes(self, known: Mapping[str, FileStamp]) -> None:
        """Keeps what is known of input files; where there is no room, a later run hashes them again."""
        columns: dict[str, list] = {"path": list(known)}
        for i, name in enumerate(FileStamp._fields):
            columns[name] = [seen[i] for seen in known.values()]
        with suppress(OSError, Unwritable), self.locked():
            sink = pa.BufferOutputStream()
            pq.write_table(pa.table(columns), sink, compression="zstd")
            write_file(self.place / _HASHES, sink.getvalue().to_pybytes())

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Alone among the batches that write over something here."""
        from filelock import FileLock

        with FileLock(self.place / _LOCK, fallback_to_soft=False):
            yield

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

    def _enter(self, name: str, index: pa.Table) -> None:
        self._read.add(name)
        later = generation_of(name) or 0
        columns = (index[column].to_pylist() for column in _INDEX)
        for key, file, inputs in zip(*columns, strict=True):
            known = self._at.get(key)
            if known is None or later > (generation_of(known) or 0):
                self._at[key] = name
            self.inputs.setdefault(file, {})[inputs] = None


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
    if not mark.exists():
        if make and not any(path.name != _SEGMENTS for path in place.iterdir()):
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
            f"is a store of format {found!r}", where=str(place), valid="one of this version's"
        )


def _make(place: Path) -> None:
    with unwritable(place):
        (place / _SEGMENTS).mkdir(parents=True, exist_ok=True)
    write_file(place / MARK, (json.dumps({"format": FORMAT}) + "\n").encode())
