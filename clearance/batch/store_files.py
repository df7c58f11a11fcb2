"""The files of a store's folder: which folder is one, and which is of something else.

Not for: what is in the database (`store`), nor in the answer (`output`).
"""

from __future__ import annotations

import re
from pathlib import Path

from clearance.errors import Unwritable

FILE = "store.sqlite"
CASES, FINDINGS = "cases.parquet", "findings.parquet"

_PART = re.compile(r"^part-\d+-of-\d+\.sqlite$")

_OWN = re.compile(r"^\.?(store|part-\d+-of-\d+)\.(sqlite(-journal)?|lock)$")
"""Databases and locks, one of which is the first file in a store."""


def is_store(place: Path) -> bool:
    """True if a folder is a store, or holds the tables of one."""
    return any((place / name).is_file() for name in (FILE, CASES)) or bool(parts_in(place))


def parts_in(place: Path) -> list[Path]:
    """The files of parts that are not merged yet."""
    return sorted(path for path in place.glob("part-*.sqlite") if _PART.match(path.name))


def require_place(place: Path, *, make: bool) -> None:
    """Refuses what no store is in, and none can be made in.

    Raises:
        Unwritable: why not, and what to do.
    """
    if not place.exists() and make:
        return
    if not place.is_dir():
        fault = "is a file" if place.exists() else "there is no such folder"
        raise Unwritable(
            fault, where=str(place), valid="a folder that `clearance batch` keeps rows in"
        )
    names = [path.name for path in place.iterdir()]
    if any(map(_OWN.match, names)) or (make and not names):
        return
    raise Unwritable(
        "is a folder of something else", where=str(place), valid="a new folder, or a store"
    )
