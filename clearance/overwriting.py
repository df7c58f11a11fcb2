"""Keeps what is written from taking the place of what was read. Not for: other files that are there."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from clearance.errors import Unwritable


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
