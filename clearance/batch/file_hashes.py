"""The sha256 of input files, known from an earlier run where a file has not changed since.

A file counts as unchanged if its device, inode, size, and times of change of content and of status are those of
before, and both times lay more than `RACY` before it was read. A file that is written twice within the clock's
grain keeps its times; whatever was read within `RACY` of its last change is therefore read again. So is what has
times in the future. The time of status cannot be set back as that of content can (`cp -p`, `rsync -t`, `tar`).
Not for: what is done with them (`keys`).
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from clearance.formats.files.input_files import regular_file

RACY = 2_000_000_000
"""[ns] The coarsest clock of a file system that is in use (FAT) counts two seconds."""

Marks = tuple[int, int, int, int, int]
"""What tells a file from what it was: device, inode, size, [ns] times of content and of status."""


class FileStamp(NamedTuple):
    """A file as it was when it was read.

    Attributes:
        times: [ns] of its content and of its status. read: [ns] when reading it began.
    """

    device: int
    inode: int
    n_bytes: int
    changed: int
    status_changed: int
    read: int
    sha256: str

    @property
    def marks(self) -> Marks:
        """What tells it from what it was."""
        return self.device, self.inode, self.n_bytes, self.changed, self.status_changed

    @property
    def is_settled(self) -> bool:
        """True if a later change of the file cannot go unseen."""
        return max(self.changed, self.status_changed) + RACY < self.read


def _nothing(path: str, marks: Marks) -> None:
    """Knows of no earlier run."""


class FileHashes:
    """The hashes of files by absolute path.

    Args:
        known: the sha256 of a file that had some marks in an earlier run, or None.
    """

    def __init__(self, known: Callable[[str, Marks], str | None] = _nothing) -> None:
        self._known = known
        self._now: dict[str, str | None] = {}
        self._new: dict[str, FileStamp] = {}

    def of(self, path: str) -> str | None:
        """The sha256 of a file; None if it cannot be read. Each is looked at once."""
        if path not in self._now:
            self._now[path] = self._found(path)
        return self._now[path]

    def learn(self, read: Iterable[tuple[str, FileStamp]]) -> None:
        """Takes over what others have read."""
        self._new.update((path, one) for path, one in read if one.is_settled)

    def stamps(self) -> list[tuple[str, FileStamp]]:
        """What was read since this was last asked, and can be believed later on."""
        new, self._new = list(self._new.items()), {}
        return new

    def _found(self, path: str) -> str | None:
        try:
            known = self._known(path, _marks(os.stat(path)))
            if known is not None:
                return known
            read = time.time_ns()
            with regular_file(Path(path)) as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
                marks = _marks(os.fstat(file.fileno()))
        except OSError:
            return None
        self.learn([(path, FileStamp(*marks, read, digest))])
        return digest


def seen(path: str, sha256: str, read: int) -> FileStamp | None:
    """A file whose content was found from the time `read` [ns] on; None if it is gone."""
    try:
        return FileStamp(*_marks(os.stat(path)), read, sha256)
    except OSError:
        return None


def _marks(found: os.stat_result) -> Marks:
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
