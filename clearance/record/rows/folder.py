"""The folder that resumable rows lie in: made by us, marked, ours alone, and taken away by nobody but us.

Whatever else stands in its place, a link above all, is refused and left as it is: what an interrupted run has left
is emptied where the next one asks something else. Not for: what lies in it (`resumable`).
"""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import FileIO
from pathlib import Path

from clearance.errors import Unwritable, unwritable

LOCK = "lock"
MARK = b"rows of an unfinished run of clearance check; the same command goes on with them\n"
"""The content of the lock: what has it, is of our user and can be read by nobody else was made here."""

_BY_DESCRIPTOR = os.scandir in os.supports_fd and os.unlink in os.supports_dir_fd


@contextmanager
def own_folder(place: Path) -> Iterator[None]:
    """Makes the folder `place`, or takes what an interrupted run has left, for this process as long as it lives.

    Raises:
        Unwritable: something else is there, another run is writing there, or there is no way or room to write.
    """
    with ExitStack() as opened:
        while not _is_acquired(place, opened):
            opened.close()  # the run before has just finished, and taken its folder away
        yield


def clear(place: Path) -> None:
    """Takes away all but the lock, through no link that has come to stand at `place` since."""
    if not _BY_DESCRIPTOR:
        for path in place.iterdir():
            if path.name != LOCK:
                shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        return
    folder = os.open(place, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        with os.scandir(folder) as entries:
            found = [(entry.name, entry.is_dir(follow_symlinks=False)) for entry in entries]
        for name, is_folder in found:
            if name != LOCK:
                shutil.rmtree(name, dir_fd=folder) if is_folder else os.unlink(name, dir_fd=folder)
    finally:
        os.close(folder)


def take_away(place: Path) -> None:
    """Takes the folder away; it is renamed first, so that a process killed meanwhile leaves none in its place."""
    if place.is_symlink() or not _is_marked(place):
        return
    aside = place.with_name(f"{place.name}-{os.getpid()}.done")
    try:
        os.rename(place, aside)
    except OSError:
        aside = place
    shutil.rmtree(aside, ignore_errors=True)  # which follows no link


def _is_marked(place: Path) -> bool:
    try:
        with open(place / LOCK, "rb", buffering=0) as lock:
            return _has_mark(lock)
    except OSError:
        return False


def _has_mark(lock: FileIO) -> bool:
    """Whether the file is one of ours; its first byte is left out, which Windows lets only who locks it read."""
    lock.seek(1)
    return lock.read(len(MARK)) == MARK[1:]


def _is_acquired(place: Path, opened: ExitStack) -> bool:
    """Whether `place` is there now, ours and locked; `opened` keeps it."""
    with unwritable(place):
        place.parent.mkdir(parents=True, exist_ok=True)
        fresh = Path(tempfile.mkdtemp(prefix=f"{place.name}-", suffix=".new", dir=place.parent))
        try:
            like = fresh.lstat()
            (fresh / LOCK).write_bytes(MARK)
            if not _moved(fresh, place) and not _is_like(place, like):
                return False
        finally:
            shutil.rmtree(fresh, ignore_errors=True)
        lock = _opened(place, opened)
    return lock is not None and _is_locked(lock, place)


def _moved(fresh: Path, place: Path) -> bool:
    """Whether the fresh folder has become `place`, where nothing was."""
    if os.path.lexists(place):
        return False
    try:
        os.rename(fresh, place)
    except (FileExistsError, NotADirectoryError, IsADirectoryError):
        return False
    except OSError:
        if os.path.lexists(place):  # another run has come first
            return False
        raise
    return True


def _is_like(place: Path, like: os.stat_result) -> bool:
    """True for a folder of the same owner, and open to as few, as one that we make; False if it is gone.

    Raises:
        Unwritable: anything else is there.
    """
    try:
        found = place.lstat()
    except FileNotFoundError:
        return False
    if stat.S_ISLNK(found.st_mode):
        raise _foreign(place, "a link is there")
    if not stat.S_ISDIR(found.st_mode):
        raise _foreign(place, "a file is there")
    if (found.st_uid, stat.S_IMODE(found.st_mode)) != (like.st_uid, stat.S_IMODE(like.st_mode)):
        raise _foreign(
            place, "a folder that is not as one of ours (another owner, or open to others) is there"
        )
    return True


def _opened(place: Path, opened: ExitStack) -> FileIO | None:
    """The lock of a folder that we made; None if the folder is gone.

    Raises:
        Unwritable: it has none with our mark.
    """
    try:
        descriptor = os.open(place / LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        if not os.path.lexists(place):
            return None
        raise _foreign(place, "a folder is there that no run of ours has made") from None
    lock = opened.enter_context(FileIO(descriptor, "r+"))
    if not _has_mark(lock):
        raise _foreign(place, "a folder is there that no run of ours has made")
    return lock


def _is_locked(lock: FileIO, place: Path) -> bool:
    """Whether the lock is taken, and still that of `place`.

    Raises:
        Unwritable: another process has it.
    """
    from filelock import lock_descriptor

    try:
        is_ours = lock_descriptor(lock.fileno(), blocking=False)
    except OSError:  # a file system without such locks
        return True
    if not is_ours:
        raise Unwritable(
            "another run is writing its report there",
            where=str(place),
            valid="wait for it, or choose another folder",
        )
    try:
        return os.path.samestat(
            os.fstat(lock.fileno()), os.stat(place / LOCK, follow_symlinks=False)
        )
    except FileNotFoundError:
        return False


def _foreign(place: Path, problem: str) -> Unwritable:
    return Unwritable(
        f"{problem}, where the rows of this run would go",
        where=str(place),
        valid="move it away, or choose another folder for the report",
    )
