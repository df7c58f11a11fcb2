"""Where the rows of a run are kept: in memory, or in a folder from which an interrupted run goes on.

On disk each array is a file mapped into memory, so that what a process has written outlives it however it ends,
and its pages can be let go as the run proceeds. Beside them stands a small state for each pass: how many parts are
done, in order. The rows are on disk before the state that counts them. Not for: what is measured (`measure`).
"""

from __future__ import annotations

import io
import math
import mmap
import os
import time
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clearance.errors import unwritable
from clearance.record.rows.folder import clear, own_folder, take_away
from clearance.record.table import Column, Names, Table

SAVE_AFTER = 1.0
"""[s] between two states of a pass: so much work is lost at most. Writing one takes milliseconds."""

_QUESTION = "question.json"


@dataclass(eq=False)
class PassLog:
    """How far a pass over the steps has come: parts done, in order, and what was gathered over them."""

    done: int = 0
    gathered: dict[str, np.ndarray] = field(default_factory=dict)

    def note(self, done: int, gathered: dict[str, np.ndarray], *, last: bool) -> None:
        """Tells that the first `done` parts are done, with what was gathered over them."""


@dataclass(eq=False)
class MeasuredRows:
    """Rows in memory, which nobody else can see."""

    def array(self, name: str, shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
        """An array to be filled; its content is that of before if the run goes on."""
        return np.empty(shape, dtype=kind)

    def log(self, name: str, spans: Sequence[slice]) -> PassLog:
        """The log of the pass `name` in parts `spans`, to be asked for after the arrays `name.…` of that pass."""
        return PassLog()

    def let_go(self) -> None:
        """Frees the memory of what is on disk as well; it comes back when it is looked at."""

    def table(self, name: str, n_rows: int, batches: Iterable[Table]) -> Table:
        """The batches as one table; what they took of memory on the way is let go."""
        columns: dict[str, Column] = {}
        start = 0
        for batch in batches:
            rows = slice(start, start + batch.n_rows)
            for key, column in batch.columns.items():
                values = column.codes if isinstance(column, Names) else column
                if not start:
                    empty = self.array(f"{name}.{key}", (n_rows,), values.dtype.type)
                    columns[key] = (
                        Names(empty, column.names) if isinstance(column, Names) else empty
                    )
                columns[key] = _filled(columns[key], rows, column)
            start = rows.stop
            self.let_go()
        return Table(columns)

    @property
    def folder(self) -> Path | None:
        """Where there is room for files of the run, if it has any."""
        return None

    def ask(self, fingerprint: str) -> None:
        """Says what decides every row; rows of another fingerprint are thrown away."""


def _filled(column: Column, rows: slice, more: Column) -> Column:
    """A column with `more` in some rows, and with all names of both."""
    if not isinstance(column, Names):
        column[rows] = more
        return column
    assert isinstance(more, Names)
    known, codes = column.names, more.codes
    if known != more.names:
        known = [*known, *(name for name in more.names if name not in known)]
        codes = more.places_in(known)
    column.codes[rows] = codes
    return Names(column.codes, known)


IN_MEMORY = MeasuredRows()
"""Rows in memory only."""


@dataclass(eq=False)
class ResumableRows(MeasuredRows):
    """Rows in a folder; made by `open_resumable_rows`.

    Attributes:
        say: called with one line if a run goes on or starts anew.
    """

    place: Path
    say: Callable[[str], None] = lambda line: None
    _maps: dict[str, mmap.mmap] = field(default_factory=dict)
    _fresh: set[str] = field(default_factory=set)
    _noted: bool = False
    _closed: bool = False

    @property
    def folder(self) -> Path | None:
        return None if self._closed else self.place

    def close(self) -> None:
        """Takes the folder away; arrays that are in use stay, and later ones are in memory."""
        if not self._closed:
            self._closed = True
            take_away(self.place)

    def ask(self, fingerprint: str) -> None:
        question = self.place / _QUESTION
        with unwritable(self.place):
            known = question.read_text() if question.exists() else fingerprint
            if known != fingerprint:
                self.say("starting anew: the interrupted run had other inputs")
            if known != fingerprint or not question.exists():
                clear(self.place)
                _replace(question, fingerprint.encode())

    def array(self, name: str, shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
        n_bytes = math.prod(shape) * np.dtype(kind).itemsize
        if n_bytes == 0 or self._closed:
            return np.empty(shape, dtype=kind)
        path = self.place / f"{name}.rows"
        with unwritable(self.place), path.open("r+b" if path.exists() else "w+b") as file:
            if os.fstat(file.fileno()).st_size != n_bytes:
                _claim(file, n_bytes)
                self._fresh.add(name.split(".")[0])
            self._maps[name] = mmap.mmap(file.fileno(), n_bytes)
        return np.frombuffer(self._maps[name], dtype=kind).reshape(shape)

    def log(self, name: str, spans: Sequence[slice]) -> PassLog:
        if self._closed:
            return PassLog()
        path = self.place / f"{name}.state"
        state = {} if name in self._fresh else _state(path)
        arrays = [self._maps[key] for key in self._maps if key.split(".")[0] == name]
        done = int(state.pop("done", 0))
        if done and not self._noted:
            self._noted = True
            n_done, n_all = spans[done - 1].stop, spans[-1].stop
            self.say(f"resuming: {n_done:,} of {n_all:,} steps are reused from an interrupted run")
        return _ResumableLog(done, state, path, arrays)

    def let_go(self) -> None:
        for mapped in self._maps.values():
            if hasattr(mmap, "MADV_DONTNEED"):  # what was written to it stays in the file
                mapped.madvise(mmap.MADV_DONTNEED)


@dataclass(eq=False)
class _ResumableLog(PassLog):
    path: Path = Path()
    arrays: list[mmap.mmap] = field(default_factory=list)
    _saved: float = field(default_factory=time.monotonic)

    def note(self, done: int, gathered: dict[str, np.ndarray], *, last: bool) -> None:
        if not last and time.monotonic() - self._saved < SAVE_AFTER:
            return
        text = io.BytesIO()
        # mypy takes a name for `allow_pickle`, which numpy 2.0 does not know
        np.savez(text, done=done, **gathered)  # type: ignore[arg-type]
        with unwritable(self.path.parent):
            for mapped in self.arrays:
                mapped.flush()
            _replace(self.path, text.getvalue())
        self._saved = time.monotonic()


@contextmanager
def open_resumable_rows(place: Path, say: Callable[[str], None]) -> Iterator[ResumableRows]:
    """The rows in the folder `place`, for this process alone; taken away if the block is left without an error.

    Raises:
        Unwritable: another run is writing there, something is there that we have not made, or there is no way or
            no room to write.
    """
    with own_folder(place):
        rows = ResumableRows(place, say)
        try:
            yield rows
        except BaseException:
            if not any(place.glob("*.state")):  # nothing was worth keeping yet
                rows.close()
            raise
        rows.close()


def _claim(file: io.BufferedRandom, n_bytes: int) -> None:
    """Makes the file so long, with room on the disk for all of it: a mapped hole on a full disk kills."""
    file.truncate(0)
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file.fileno(), 0, n_bytes)
        return
    block = bytes(2**20)
    for start in range(0, n_bytes, len(block)):
        file.write(block[: n_bytes - start])
    file.flush()


def _state(path: Path) -> dict[str, np.ndarray]:
    """What a pass had noted; nothing if it had not, or the state was lost with the machine's power."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            return dict(stored)
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile):
        return {}


def _replace(path: Path, content: bytes) -> None:
    fresh = path.with_name(f"{path.name}.new")
    with fresh.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(fresh, path)
