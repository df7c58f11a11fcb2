"""What was looked for in several places, kept among the files of a case: does a name still lead to the same file?

A file that appears in an earlier place of a search path changes a case none of whose files has changed. Not for:
searching (`mesh_paths`).
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path

from clearance.errors import ClearanceError
from clearance.formats.files.input_files import InputFiles
from clearance.formats.files.mesh_paths import mesh_path, model_path, package_folder
from clearance.world.case import LOOKUP, Source

MESH, MODEL, PACKAGE, OPTIONAL = "mesh", "model", "package", "optional"
"""What is looked for: a mesh, a model, the folder of a package, or one file that may be there or not."""

_SEARCHES = {MESH: mesh_path, MODEL: model_path, PACKAGE: package_folder}


def note_lookup(
    files: InputFiles,
    kind: str,
    given: str,
    folder: Path,
    package_dirs: Sequence[Path],
    found: Path | None,
) -> None:
    """Keeps among the files of a case what a name led to; None for nothing. A plain path needs no search."""
    moved = Path(given).is_absolute() and found is not None and found != Path(given)
    if kind not in (PACKAGE, OPTIONAL) and "://" not in given and not moved:
        return
    dirs = [os.path.abspath(one) for one in package_dirs]
    asked = json.dumps([kind, given, os.path.abspath(folder), dirs])
    files.note(Source(f"{LOOKUP}{kind} {given}", _digest(found, folder), 0, asked))


def leads_to(asked: str) -> str:
    """Where a search leads now, as the `sha256` of its source would have it.

    Args:
        asked: what its source was read from.
    """
    kind, given, folder, dirs = json.loads(asked)
    place, package_dirs = Path(folder), [Path(one) for one in dirs]
    if kind == OPTIONAL:
        return _digest(place / given if (place / given).is_file() else None, place)
    try:
        found = _SEARCHES[kind](given, place, package_dirs)
    except ClearanceError:
        return _digest(None, place)
    return _digest(found.path, place)


def _digest(found: Path | None, folder: Path) -> str:
    """sha256 of a path as seen from a folder, the same on every machine; empty for nothing."""
    if found is None:
        return ""
    return hashlib.sha256(os.fsencode(os.path.relpath(found, folder))).hexdigest()
