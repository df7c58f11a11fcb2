"""Files of one command, written all or none, and over nothing unasked. Not for: reports (`clearance.files`)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from clearance.cli.places import refuse_inputs
from clearance.errors import Unwritable


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
    from clearance.files import fill_folder

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
            raise Unwritable("is there already", where=str(file), valid="--force overwrites it")
