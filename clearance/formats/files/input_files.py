"""The files of one case: each is read once, through here, and remembered with its sha256 for the
summary.

Paths are shown relative to the case's folder, so that messages and summaries do not depend on the
machine. Not for: what is in the files.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property
from io import BufferedReader, BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from clearance.errors import MissingFile
from clearance.formats.files.brought import brought_folders, brought_path, is_brought
from clearance.formats.files.place import here, top

if TYPE_CHECKING:
    from clearance.world.case import Source

SHORT = 2**20
"""[bytes] Files up to this length are read once, whoever goes through them how often."""


class InputFiles:
    """Reads files and keeps their checksums.

    Args:
        folder: the case's folder, against which paths are looked up and shown.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._place = os.path.abspath(folder)
        self._contents: dict[Path, bytes] = {}
        self._sources: dict[Path, Source] = {}
        self._lookups: dict[str, Source] = {}
        self._in_memory: set[Path] = set()

    @cached_property
    def _brought(self) -> dict[str, str]:
        return brought_folders()

    @property
    def sources(self) -> tuple[Source, ...]:
        """Every file read so far, sorted by its shown path, and what was looked for."""
        found = [*self._sources.values(), *self._lookups.values()]
        return tuple(sorted(found, key=lambda source: source.path))

    def sources_beside(self, others: Iterable[Source]) -> tuple[Source, ...]:
        """The same and others, each path once."""
        found = {source.path: source for source in (*others, *self.sources)}
        return tuple(found[path] for path in sorted(found))

    def resolved(self, given: str) -> Path:
        """The path that a text in a file of the folder means.

        Raises:
            Unavailable, MissingFile: as `resolved`.
        """
        return resolved(given, self.folder)

    def read(self, path: Path) -> bytes:
        """The content of a file; a second call gives the same bytes without reading again.

        Raises:
            MissingFile: it is not there, is no file on disk, or cannot be read.
        """
        path = Path(os.path.abspath(path))
        if path not in self._contents:
            data = read_bytes(path, self.shown(path))
            self._contents[path] = data
            self._note(path, hashlib.sha256(data).hexdigest(), len(data))
        return self._contents[path]

    def put(self, path: Path, data: bytes) -> None:
        """Keeps what is written out in another file as the content of a file of its own, which is not on disk."""
        self._contents[Path(os.path.abspath(path))] = data
        self._in_memory.add(Path(os.path.abspath(path)))

    def is_in_memory(self, path: Path) -> bool:
        """Whether a file is not on disk."""
        return Path(os.path.abspath(path)) in self._in_memory

    def unread(self, path: Path) -> Callable[[], BinaryIO]:
        """Opens a file, again and again; its checksum is remembered, its content only while a short one is read.

        Raises:
            MissingFile: it is not there, is no file on disk, or cannot be read.
        """
        path = Path(os.path.abspath(path))
        if path in self._in_memory:
            data = self._contents[path]
            return lambda: BytesIO(data)
        content = b""
        with _openable(self.shown(path)), regular_file(path) as file:
            n_bytes = os.fstat(file.fileno()).st_size
            if n_bytes <= SHORT:
                content = file.read()
                _refuse_pointer(content, self.shown(path))
                digest, n_bytes = hashlib.sha256(content).hexdigest(), len(content)
            else:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
        self._note(path, digest, n_bytes)
        return lambda: BytesIO(content) if n_bytes <= SHORT else regular_file(path)

    def add_sources(self, others: InputFiles) -> None:
        """Takes over the checksums of files that were read through others."""
        self._sources |= others._sources
        self._lookups |= others._lookups

    def note(self, source: Source) -> None:
        """Keeps what is no file and decides what is read all the same."""
        self._lookups[source.read_from] = source

    def _note(self, path: Path, digest: str, n_bytes: int) -> None:
        from clearance.world.case import Source

        self._sources[path] = Source(self.shown(path), digest, n_bytes, str(path))

    def shown(self, path: Path | str) -> str:
        """How a path is written in messages and summaries: the same on every machine."""
        whole = os.path.abspath(path)
        for folder, name in self._brought.items():
            if (below := _below(whole, folder)) is not None:
                return f"{name}:{below}"
        return _below(whole, self._place) or relative_path(Path(whole), self.folder)


_POINTER = b"version https://git-lfs.github.com/spec/"


def read_bytes(path: Path, shown: str) -> bytes:
    """The content of the file at `path`, called `shown` in the error.

    Raises:
        MissingFile: it is not there, is no file on disk, or cannot be read.
    """
    with _openable(shown), regular_file(path) as file:
        data = file.read()
    _refuse_pointer(data, shown)
    return data


def _refuse_pointer(data: bytes, shown: str) -> None:
    if data.startswith(_POINTER):
        raise MissingFile(
            f"{shown!r} is a pointer of git LFS, the file itself is not there", valid="git lfs pull"
        )


def require_file(path: Path, shown: str) -> None:
    """Refuses what `read_bytes` would refuse, without reading it.

    Raises:
        MissingFile: it is not there, is no file on disk, or cannot be read.
    """
    with _openable(shown), regular_file(path):
        pass


class _NotRegular(OSError):
    """A pipe, socket or device."""


FileState = tuple[int, int, int]
"""What changes with a file: time [ns] of its content, size, inode."""

_OPENED: ContextVar[dict[Path, FileState | None] | None] = ContextVar("opened", default=None)


@contextmanager
def files_opened() -> Iterator[dict[Path, FileState | None]]:
    """Collects the files that are opened in the block, missing ones too, each as it was just before."""
    opened: dict[Path, FileState | None] = {}
    token = _OPENED.set(opened)
    try:
        yield opened
    finally:
        _OPENED.reset(token)


def state_of(path: Path) -> FileState | None:
    """What a file is like now; None if it is not there."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def regular_file(path: Path) -> BufferedReader:
    """Opens a file on disk; a pipe or a device, which may never end, is not waited for."""
    opened = _OPENED.get()
    if opened is not None:
        place = Path(os.path.abspath(path))
        opened.setdefault(place, state_of(place))
    descriptor = os.open(
        path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    )
    try:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError
        if not stat.S_ISREG(mode):
            raise _NotRegular
        return os.fdopen(descriptor, "rb")
    except OSError:
        os.close(descriptor)
        raise


@contextmanager
def _openable(shown: str) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise MissingFile(
            f"there is no file {shown!r}", valid="a path to a file is needed"
        ) from None
    except IsADirectoryError:
        raise MissingFile(f"{shown!r} is a folder", valid="a path to a file is needed") from None
    except _NotRegular:
        raise MissingFile(
            f"{shown!r} is a pipe or a device", valid="a path to a file on disk is needed"
        ) from None
    except OSError as error:
        reason = (error.strerror or "unknown error").lower()
        raise MissingFile(f"{shown!r} cannot be read: {reason}") from None


def relative_path(path: Path, folder: Path) -> str:
    """`path` as seen from `folder`, with `/`; the bare name where they share only the root."""
    folder = Path(os.path.abspath(folder))
    try:
        shared = Path(os.path.commonpath([path, folder]))
    except ValueError:  # two drives
        return path.name
    if shared in (Path(shared.anchor), Path(top())) and folder != shared:
        return path.name
    return Path(os.path.relpath(path, folder)).as_posix()


def _below(path: str, folder: str) -> str | None:
    """What follows a folder in a path below it, with `/`, or None for another path; both absolute."""
    before = os.path.join(folder, "")
    if not path.startswith(before) or path == before:
        return None
    return path[len(before) :].replace(os.sep, "/")


def resolved(given: str, folder: Path) -> Path:
    """The path that a text in a case file means: `PACKAGE:…`, or relative to `folder`.

    Raises:
        Unavailable, MissingFile: as `brought_path`.
    """
    brought = brought_path(given)
    if brought is not None:
        return brought
    return here(os.path.normpath(folder / given))  # also from a folder that is not there yet


FARTHEST = 4
"""Folders up; a path that climbs higher is written from the root, as one that has only the root in common."""


def path_from(folder: Path, given: str | Path) -> str:
    """How a path that is relative to the current folder is written in a file in `folder`, which need not be there.

    From the root where `folder` is reached by a link, since `..` would then be of two meanings.
    """
    if is_brought(given):
        return str(given)
    path, folder = Path(os.path.abspath(given)), Path(os.path.abspath(folder))
    try:
        shared = Path(os.path.commonpath([path, folder]))
    except ValueError:  # two drives
        return path.as_posix()
    below = folder.relative_to(shared)
    is_linked = os.path.realpath(folder) != os.path.join(os.path.realpath(shared), below)
    is_far = shared == Path(shared.anchor) or len(below.parts) > FARTHEST
    if is_far or (is_linked and below.parts):
        return path.as_posix()
    return Path(os.path.relpath(path, folder)).as_posix()
