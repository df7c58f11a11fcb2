"""All or nothing: files that are either whole in their place or not there at all.

Everything is first written beside its place, on the same file system, and moved there when the last
byte is on disk. `LAST` moves last and, where an older report is replaced, is taken away first: a
folder that holds it is whole. Should a move fail or be interrupted, the older report is put back.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from clearance.errors import Unwritable

LAST = "summary.json"


def fill_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Calls `fill` with an empty folder and then moves what it wrote into `folder`.

    Other files in `folder` stay as they are.

    Raises:
        Unwritable: there is no way to write there; `folder` is then as it was.
    """
    with _unwritable(folder):
        beside = folder if folder.is_dir() else folder.parent
        beside.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".report-", suffix=".partial", dir=beside))
        try:
            fresh = staging / "fresh"
            fresh.mkdir()
            fill(fresh)
            if folder.is_dir():
                _exchange(fresh, folder, staging / "older")
            else:
                os.rename(fresh, folder)
        finally:
            shutil.rmtree(staging, ignore_errors=True)


def write_file(path: Path, content: bytes) -> None:
    """Writes one file, whole or not at all.

    Raises:
        Unwritable: there is no way to write there; an older file is then as it was.
    """
    with _unwritable(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, partial = tempfile.mkstemp(
            prefix=f".{path.name}-", suffix=".partial", dir=path.parent
        )
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.chmod(partial, 0o666 & ~_umask())
            os.replace(partial, path)
        except BaseException:
            Path(partial).unlink(missing_ok=True)
            raise


def _exchange(fresh: Path, folder: Path, older: Path) -> None:
    """Replaces files of `folder` by those of the same name in `fresh`; puts all back if it cannot
    finish."""
    older.mkdir()
    names = sorted((path.name for path in fresh.iterdir()), key=lambda name: name == LAST)
    try:
        for name in reversed(names):
            if (folder / name).exists():
                os.replace(folder / name, older / name)
        for name in names:
            os.replace(fresh / name, folder / name)
    except BaseException:
        for name in names:
            if (older / name).exists():
                os.replace(older / name, folder / name)
            elif not (fresh / name).exists():
                (folder / name).unlink(missing_ok=True)
        raise


@contextmanager
def _unwritable(place: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise Unwritable(
            f"cannot write here: {error.strerror or error}",
            where=str(place),
            valid="a folder that can be written, on a disk with room, is needed",
        ) from error


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
