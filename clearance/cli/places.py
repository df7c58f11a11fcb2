"""Refuses a place for output that cannot or must not be written before the long work, not after it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import Unwritable
from clearance.files import refuse_inputs

if TYPE_CHECKING:
    from clearance.world.case import Case


def require_folder_place(folder: Path | None) -> None:
    """Raises `Unwritable` if `folder` is given and is no folder, or none can be made or filled
    there.
    """
    if folder is None:
        return
    if folder.exists() and not folder.is_dir():
        raise Unwritable("is a file", where=str(folder), valid="--out needs a folder")
    _require_writable(folder, folder)


def require_file_place(file: Path | None, option: str = "--junit") -> None:
    """Raises `Unwritable` if `file` is given and is a folder, or cannot be made."""
    if file is None:
        return
    if file.is_dir():
        raise Unwritable("is a folder", where=str(file), valid=f"{option} needs a file")
    _require_writable(file, file.absolute().parent)


def refuse_inputs_of_cases(cases: Iterable[Case], outputs: Iterable[Path]) -> None:
    """Raises `Unwritable` if one of the files `outputs` is one that the cases were made from."""
    refuse_inputs(outputs, [one.read_from for case in cases for one in case.sources if one.is_file])


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
