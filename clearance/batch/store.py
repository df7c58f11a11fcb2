"""The SQLite database that keeps a batch: a row a case, the hashes of input files, the list of the last batch.

One process writes: the batch's parent. Each task's rows are one transaction, so whatever ends a process, all that
was committed is there and nothing else. Every row carries a digest of itself; a row that the disk has damaged is
not found, and its case is measured again. A part of a batch writes a file of its own beside the store, and reads
what the store has. Not for: what is in a row (`rows`), nor the answer in the same folder (`output`).
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from clearance.batch.file_hashes import FileStamp, Marks
from clearance.batch.store_files import FILE, parts_in, require_place
from clearance.batch.stored_row import COLUMNS, N_VALUES, is_whole, read_row, sealed, stored
from clearance.errors import BadBatch, BadInput, ClearanceError, Incomplete, Unwritable, unwritable

FORMAT = 3
"""Of the tables: 1 were parquet segments, 2 had no reservations, and are not read."""

APPLICATION = 0x636C7242
"""Marks a SQLite file as a store."""

BUSY = 60.0
"""[s] The longest wait for another process that reads or commits."""

_TABLES = f"""
CREATE TABLE cases (key TEXT PRIMARY KEY, {COLUMNS}, digest BLOB NOT NULL);
CREATE TABLE inputs (file BLOB, read TEXT, digest BLOB, PRIMARY KEY (file, read));
CREATE TABLE files (path BLOB PRIMARY KEY, marks TEXT, sha256 TEXT);
CREATE TABLE faults (name TEXT PRIMARY KEY, text TEXT, trace TEXT, files TEXT);
CREATE TABLE listed (number INTEGER PRIMARY KEY, name TEXT, item TEXT, options INTEGER);
CREATE TABLE options (number INTEGER PRIMARY KEY, asked TEXT);
"""
"""`inputs` are the lists of files that a case file was read with; `listed` and `options` are the last batch."""

_READ = ("cases", "inputs", "files")
"""Tables of the store that a part reads beside its own."""

_FULL = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR)
_SHUT = (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM)
_HELD = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)


class Store:
    """A database of rows; made by `open_store`.

    Attributes:
        place: the folder. path: the file. n_damaged: rows that were found damaged, and count as missing.
    """

    def __init__(self, path: Path, *, make: bool, base: Path | None = None) -> None:
        self.place, self.path, self.n_damaged = path.parent, path, 0
        self._lock = FileLock(path.parent / f".{path.stem}.lock", fallback_to_soft=False)
        with self._in_words():
            mode = "rwc" if make else "rw"
            self._db = sqlite3.connect(
                f"{path.absolute().as_uri()}?mode={mode}", BUSY, uri=True, isolation_level=None
            )
            _require_format(self._db, path, make=make)
            self._attach(base)

    def _attach(self, base: Path | None) -> None:
        """Views of all rows: the file's own, then those of the store that it is a part of."""
        if base is not None:
            self._db.execute("ATTACH ? AS base", (f"{base.absolute().as_uri()}?mode=rw",))
            _require_format(self._db, base, "base")
        for name in _READ:
            others = "" if base is None else f" UNION ALL SELECT * FROM base.{name}"
            self._db.execute(f"CREATE TEMP VIEW all_{name} AS SELECT * FROM main.{name}{others}")

    def __len__(self) -> int:
        return int(self._one("SELECT count(*) FROM all_cases")[0])

    def close(self) -> None:
        """Lets go of the file."""
        self._db.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def has(self, key: str) -> bool:
        """True if the row of a key is there and whole."""
        row = self._one("SELECT * FROM all_cases WHERE key = ?", key)
        if row is not None and not is_whole(row):
            self.n_damaged += 1
            return False
        return row is not None

    def rows(self, keys: Iterable[str]) -> Iterator[dict[str, Any]]:
        """The rows of some keys, which are there, in their order; each with its key.

        Raises:
            BadInput: one is damaged, or gone.
        """
        for key in keys:
            row = self._one("SELECT * FROM all_cases WHERE key = ?", key)
            if row is None or not is_whole(row):
                raise _damaged(self.path, "a row that was there is gone")
            yield read_row(row)

    def inputs(self, file: str) -> list[str]:
        """All that a case file was ever read with, as `rows.inputs_text` writes it."""
        rows = self._all("SELECT * FROM all_inputs WHERE file = ?", os.fsencode(file))
        return list(dict.fromkeys(row[1] for row in rows if is_whole(row)))

    def known_hash(self, path: str, marks: Marks) -> str | None:
        """The sha256 of a file that had these marks when it was read; None where that is not known."""
        asked = (os.fsencode(path), json.dumps(marks))
        found = self._one("SELECT sha256 FROM all_files WHERE path = ? AND marks = ?", *asked)
        return None if found is None else found[0]

    def fault(self, name: str) -> tuple[str, str, str] | None:
        """Text, trace and files of the fault that a case had when it was last tried; None for none."""
        return self._one("SELECT text, trace, files FROM faults WHERE name = ?", name)

    def put(
        self,
        rows: Iterable[tuple[str, dict[str, Any]]] = (),
        inputs: Iterable[tuple[str, str]] = (),
        stamps: Iterable[tuple[str, FileStamp]] = (),
        faults: Iterable[tuple[str, str, str, str]] = (),
        answered: Iterable[str] = (),
    ) -> None:
        """Keeps what a task came to, all or nothing; what was known of the same is replaced.

        Args:
            rows: by key. inputs: case files, and what they were read with. faults: name, text, trace and files of
                cases without an answer. answered: names of cases that have one.

        Raises:
            Incomplete: there is no room; all that was kept before still is.
        """
        marks = ", ".join("?" * N_VALUES)
        with self._writing() as db:
            db.executemany(
                f"INSERT OR REPLACE INTO cases VALUES ({marks})",
                (stored(key, row) for key, row in rows),
            )
            db.executemany(
                "INSERT OR REPLACE INTO inputs VALUES (?, ?, ?)",
                (sealed((os.fsencode(file), read)) for file, read in inputs),
            )
            db.executemany(
                "INSERT OR REPLACE INTO files VALUES (?, ?, ?)",
                ((os.fsencode(path), json.dumps(one.marks), one.sha256) for path, one in stamps),
            )
            db.executemany("DELETE FROM faults WHERE name = ?", ((name,) for name in answered))
            db.executemany("INSERT OR REPLACE INTO faults VALUES (?, ?, ?, ?)", faults)

    def write_list(
        self, options: Iterable[str], items: Iterable[tuple[int, str, str, int]]
    ) -> None:
        """Keeps the list of a batch in place of the last one's: see `listed`."""
        with self._writing() as db:
            db.execute("DELETE FROM listed")
            db.execute("DELETE FROM options")
            db.executemany("INSERT INTO options VALUES (?, ?)", enumerate(options))
            db.executemany("INSERT INTO listed VALUES (?, ?, ?, ?)", items)

    def read_list(self) -> tuple[list[str], list[tuple[str, str, int]]]:
        """What `write_list` was given; both are empty where there was no batch."""
        options = [asked for (asked,) in self._all("SELECT asked FROM options ORDER BY number")]
        return options, self._all("SELECT name, item, options FROM listed ORDER BY number")

    def take_in(self, part: Path) -> int:
        """Takes over all that a part's file has, and says how many rows that were; its list becomes the last."""
        with self._in_words():
            self._db.execute("ATTACH ? AS part", (f"{part.absolute().as_uri()}?mode=rw",))
        try:
            with self._in_words():
                _require_format(self._db, part, "part")
            with self._writing() as db:
                for name in ("listed", "options"):
                    db.execute(f"DELETE FROM main.{name}")
                for name in (*_READ, "faults", "listed", "options"):
                    db.execute(f"INSERT OR REPLACE INTO main.{name} SELECT * FROM part.{name}")
            return int(self._one("SELECT count(*) FROM part.cases")[0])
        finally:
            self._db.execute("DETACH part")

    @contextmanager
    def locked(self, say: Callable[[str], None]) -> Iterator[None]:
        """Alone among the batches that write here; one that is not waits, and says so.

        Raises:
            Unwritable: there is no way to write here.
        """
        with unwritable(self.place):
            try:
                self._lock.acquire(timeout=0)
            except Timeout:
                say(f"{self.path}: another batch writes here; this one goes on when that has ended")
                self._lock.acquire()
        try:
            yield
        finally:
            self._lock.release()

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        """A transaction."""
        with self._in_words():
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield self._db
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def _one(self, asked: str, *values: object) -> Any:
        with self._in_words():
            return self._db.execute(asked, values).fetchone()

    def _all(self, asked: str, *values: object) -> list[Any]:
        with self._in_words():
            return self._db.execute(asked, values).fetchall()

    @contextmanager
    def _in_words(self) -> Iterator[None]:
        """Turns what SQLite says into one line."""
        try:
            yield
        except sqlite3.DatabaseError as error:
            raise _in_words(error, self.path) from None


def open_store(place: Path, *, make: bool = True, shard: tuple[int, int] | None = None) -> Store:
    """The store in a folder, which is made where there is none.

    Args:
        make: False to refuse where there is none. shard: `(i, n)` for the file of that part, which is made.

    Raises:
        Unwritable: something else is there, or it cannot be written. Incomplete: there is no room, or only parts
            are there. BadInput: the file is damaged, or no store.
    """
    require_place(place, make=make)
    if make:
        with unwritable(place):
            place.mkdir(parents=True, exist_ok=True)
    path = place / FILE
    if shard is not None:
        base = path if path.is_file() else None
        return Store(place / "part-{}-of-{}.sqlite".format(*shard), make=True, base=base)
    if not make and not path.is_file():
        raise Incomplete(
            "only parts of a batch are here",
            where=str(place),
            valid=f"`clearance batch merge {place}` first",
        )
    return Store(path, make=make)


def merge(store: Store, others: Sequence[Path], say: Callable[[str], None]) -> tuple[int, int]:
    """Takes the parts of a batch into its store; how many files and rows that were.

    Args:
        store: whose own parts are taken in, and are then gone. others: folders or files elsewhere, which stay.

    Raises:
        BadInput: one is no store of this format. Incomplete: there is no room.
    """
    own = parts_in(store.place)
    n_rows = 0
    for path in [*own, *(one for other in others for one in _files_of(other))]:
        with Store(path, make=False) as part, part.locked(say):
            n_rows += store.take_in(path)
            if path in own:
                path.unlink()
    return len(own) + len(others), n_rows


def _files_of(place: Path) -> list[Path]:
    """The store and the parts in a folder; of a file that file."""
    if not place.is_dir():
        return [place]
    found = [path for path in (place / FILE, *parts_in(place)) if path.is_file()]
    if not found:
        raise BadBatch(
            "no store or part of one is here", where=str(place), valid="the --out of a batch"
        )
    return found


def _require_format(
    db: sqlite3.Connection, path: Path, schema: str = "main", *, make: bool = False
) -> None:
    """Refuses a file of something else; a new one gets its tables."""
    if make and _is_new(db):
        _make(db)
    (application,) = db.execute(f"PRAGMA {schema}.application_id").fetchone()
    (found,) = db.execute(f"PRAGMA {schema}.user_version").fetchone()
    if application != APPLICATION:
        raise BadBatch("this is no store", where=str(path), valid="a file that a batch has written")
    if found != FORMAT:
        raise Unwritable(
            f"a store of format {found}",
            where=str(path),
            valid="a new folder: the same command measures all once more",
        )


def _make(db: sqlite3.Connection) -> None:
    """Makes the tables, unless another process just did."""
    db.execute("BEGIN IMMEDIATE")
    if _is_new(db):
        marks = f"PRAGMA application_id = {APPLICATION};PRAGMA user_version = {FORMAT}"
        for one in f"{_TABLES}{marks}".split(";"):
            db.execute(one)
    db.execute("COMMIT")


def _is_new(db: sqlite3.Connection) -> bool:
    (application,) = db.execute("PRAGMA application_id").fetchone()
    return not application and not db.execute("SELECT 1 FROM sqlite_master").fetchone()


def _in_words(error: sqlite3.DatabaseError, path: Path) -> ClearanceError:
    """What SQLite says, as one line."""
    code = getattr(error, "sqlite_errorcode", 0) & 0xFF
    where, rows_stay = str(path), "what was measured before is kept; the same command goes on"
    if code in _FULL:
        return Incomplete(
            f"cannot write here: {error}", where=where, valid=f"{rows_stay} once there is room"
        )
    if code in _HELD:
        return Incomplete("another process holds it", where=where, valid=rows_stay)
    if code in _SHUT:
        return Unwritable(
            f"cannot write here: {error}", where=where, valid="a folder that can be written"
        )
    return _damaged(path, str(error))


def _damaged(path: Path, why: str) -> BadInput:
    return BadBatch(
        f"the store is damaged, or is none ({why})",
        where=str(path),
        valid="a new folder: the same command measures all once more",
    )
