"""The place where whoever reads mesh files says so, so that `Polyhedron.from_file` can call it.

Files are read in a room above this one, which must not be imported from here. The package's `__init__`
attaches a reader; it imports the room `load` only when a file is really read. Not for: reading.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any

from clearance.errors import Unavailable

Reader = Callable[[str | PathLike[str], float], Any]
_attached: list[Reader] = []


def attach_file_reader(reader: Reader) -> None:
    """Makes `reader(path, scale)`, which returns a `Polyhedron`, what `Polyhedron.from_file` calls."""
    _attached[:] = [reader]


def file_reader() -> Reader:
    """The reader that was attached last.

    Raises:
        Unavailable: none was.
    """
    if not _attached:
        raise Unavailable(
            "no reader of mesh files is attached", valid="import clearance attaches one"
        )
    return _attached[0]
