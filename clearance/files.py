"""All or nothing, and never over an input: files that are either whole in their place or not there at all.

Everything is first written beside its place, on the same file system, and moved there when the last
byte is on disk. A folder that holds nothing but an older answer is exchanged as a whole, by one
rename: a process killed at any moment leaves the older answer or the new one. Where the folder
holds other files too, files are exchanged one by one: `LAST` moves last and is taken away first, so
that a folder that holds it is whole; should a move fail or be interrupted, the older answer is put
back. Places that cannot be written, or hold an input of the run, are refused before the work. Not for: what is
written.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from clearance.errors import Unwritable, unwritable

LAST = "summary.json"
"""The file by which programs know that a report is whole."""

_EXCHANGE = 2  # RENAME_EXCHANGE of Linux's renameat2
_HERE = -100  # AT_FDCWD
_PARTIAL = ".partial"


def fill_folder(
    folder: Path, fill: Callable[[Path], None], own: Collection[str], room: Path | None = None
) -> None:
    """Calls `fill` with an empty folder and then moves what it wrote into `folder`.

    Other files in `folder` stay as they are.

    Args:
        own: the names of all files that such an answer can have; what an older one had of them goes.
        room: a folder to work in, on the same file system; beside or in `folder` by default.

    Raises:
        Unwritable: there is no way to write there; `folder` is then as it was.
    """
    with unwritable(folder):
        folder = Path(os.path.realpath(folder))
        as_a_whole = not folder.is_dir() or _is_only_an_answer(folder, own)
        beside = room or (folder.parent if as_a_whole else folder)
        beside.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".report-", suffix=_PARTIAL, dir=beside))
        try:
            fresh = staging / "fresh"
            fresh.mkdir()
            fill(fresh)
            if not folder.is_dir():
                folder.parent.mkdir(parents=True, exist_ok=True)
                os.rename(fresh, folder)
            elif as_a_whole and _is_only_an_answer(folder, own):
                _exchange_whole(fresh, folder, staging / "older")
            else:
                _exchange_files(fresh, folder, staging / "older", own)
        finally:
            shutil.rmtree(staging, ignore_errors=True)


def _is_only_an_answer(folder: Path, own: Collection[str]) -> bool:
    """True if `folder` can be replaced as a whole: nothing of anybody else is in it, and nobody stands in it."""
    parent = folder.parent
    mine = os.stat(folder)
    return (
        all(path.name in own and stat.S_ISREG(path.lstat().st_mode) for path in folder.iterdir())
        and mine.st_dev == os.stat(parent).st_dev
        and os.access(parent, os.W_OK)
        and not os.path.samefile(folder, os.curdir)
        and (not hasattr(os, "geteuid") or mine.st_uid == os.geteuid())
    )


def write_file(path: Path, content: bytes) -> None:
    """Writes one file, whole or not at all.

    Raises:
        Unwritable: there is no way to write there; an older file is then as it was.
    """
    with written_file(path) as file:
        file.write(content)


@contextmanager
def written_file(path: Path) -> Iterator[BinaryIO]:
    """A file to be written part by part, which is there once it is closed; whole or not at all.

    Raises:
        Unwritable: there is no way to write there; an older file is then as it was.
    """
    with unwritable(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, partial = tempfile.mkstemp(
            prefix=f".{path.name}-", suffix=_PARTIAL, dir=path.parent
        )
        try:
            with os.fdopen(handle, "wb") as file:
                yield file
            os.chmod(partial, 0o666 & ~_umask())
            os.replace(partial, path)
        except BaseException:
            Path(partial).unlink(missing_ok=True)
            raise


def refuse_inputs(outputs: Iterable[Path], inputs: Iterable[str | Path]) -> None:
    """Raises `Unwritable` if one of the files `outputs` is one of `inputs`, by whatever name or link."""
    read = {_identity(Path(path)): path for path in inputs}
    read.pop(None, None)
    for output in outputs:
        found = read.get(_identity(output))
        if found is not None:
            raise Unwritable(
                f"would overwrite {str(found)!r}, which this run reads",
                where=str(output),
                valid="another place is needed",
            )


def _identity(path: Path) -> tuple[int, int] | None:
    """What two names of one file share; None for what is not there."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


def require_folder_place(folder: Path | None, option: str = "--out") -> None:
    """Raises `Unwritable` if `folder` is given and is no folder, or none can be made or filled
    there.
    """
    if folder is None:
        return
    if folder.exists() and not folder.is_dir():
        raise Unwritable("is a file", where=str(folder), valid=f"{option} needs a folder")
    _require_writable(folder, folder)


def require_file_place(file: Path | None, option: str = "--junit") -> None:
    """Raises `Unwritable` if `file` is given and is a folder, or cannot be made."""
    if file is None:
        return
    if file.is_dir():
        raise Unwritable("is a folder", where=str(file), valid=f"{option} needs a file")
    _require_writable(file, file.absolute().parent)


def _require_writable(place: Path, folder: Path) -> None:
    """Makes and removes a nameless file where `place` would go: permission bits alone do not
    tell.
    """
    for link in (folder.absolute(), *folder.absolute().parents):
        if link.is_symlink() and not link.exists():
            raise Unwritable(
                f"{link.name!r} is a link that leads nowhere",
                where=str(place),
                valid="a place inside a folder that can be written is needed",
            )
    existing = next(p for p in (folder.absolute(), *folder.absolute().parents) if p.exists())
    try:
        with tempfile.TemporaryFile(dir=existing):
            pass
    except OSError as error:
        raise Unwritable(
            f"cannot be written ({error.strerror or error})",
            where=str(place),
            valid="a place inside a folder that can be written is needed",
        ) from None


def write_files(
    folder: Path,
    contents: Mapping[str, bytes],
    read: Iterable[str | Path],
    *,
    force: bool,
    others: Iterable[str] = (),
) -> None:
    """Writes `contents` by name into `folder`, which is made where it is not there.

    Args:
        read: the files that the contents are made from. force: overwrite what is there.
        others: names of files that such a folder may have of an earlier time, which go.

    Raises:
        Unwritable: a file is there already, or is one of `read`, or there is no way to write; the folder is as it
        was then.
    """
    names = dict.fromkeys((*others, *contents))
    refuse_there([folder / name for name in names], force=force)
    refuse_inputs([folder / name for name in names], read)

    def fill(fresh: Path) -> None:
        for name, content in contents.items():
            (fresh / name).write_bytes(content)

    fill_folder(folder, fill, set(names))


def refuse_there(files: Iterable[Path], *, force: bool) -> None:
    """Raises `Unwritable` for the first of `files` that is a folder, or is there and may not be overwritten."""
    for file in files:
        if file.is_dir():
            raise Unwritable("is a folder", where=str(file), valid="a file is to be written there")
        if file.exists() and not force:
            raise Unwritable("already exists", where=str(file), valid="--force overwrites it")


def _exchange_whole(fresh: Path, folder: Path, older: Path) -> None:
    """Replaces `folder` by `fresh`: at once where the system can; else there is no folder for a moment."""
    os.chmod(fresh, stat.S_IMODE(os.stat(folder).st_mode))
    if _exchanged(fresh, folder):
        return
    os.rename(folder, older)
    try:
        os.rename(fresh, folder)
    except BaseException:
        if not folder.exists():
            os.rename(older, folder)
        raise


def _exchanged(one: Path, other: Path) -> bool:
    """Whether the system has given each of two folders the other's name, in one step."""
    call = getattr(ctypes.CDLL(None), "renameat2", None) if os.name == "posix" else None
    names = os.fsencode(one), os.fsencode(other)
    return call is not None and call(_HERE, names[0], _HERE, names[1], _EXCHANGE) == 0


def _exchange_files(fresh: Path, folder: Path, older: Path, own: Collection[str]) -> None:
    """Replaces files of `folder` by those of the same name in `fresh`, and takes away what else an older report
    had; puts all back if it cannot finish."""
    older.mkdir()
    names = sorted((path.name for path in fresh.iterdir()), key=lambda name: name == LAST)
    gone = sorted({*own} - {*names})
    try:
        for name in [*reversed(names), *gone]:
            if (folder / name).exists():
                os.replace(folder / name, older / name)
        for name in names:
            os.replace(fresh / name, folder / name)
    except BaseException:
        for name in [*names, *gone]:
            if (older / name).exists():
                os.replace(older / name, folder / name)
            elif name in names and not (fresh / name).exists():
                _remove(folder / name)
        raise


def _remove(path: Path) -> None:
    """Takes away a file, or a folder with all that is in it, if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
