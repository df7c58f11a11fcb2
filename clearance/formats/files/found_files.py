"""Notes on files found elsewhere than where they were named, and the names that were searched in several
places: does a name still lead to the same file?

A file that appears in an earlier place of a search path changes a case none of whose files has changed. Not
for: searching (`mesh_paths`).
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from clearance.errors import ClearanceError
from clearance.formats.files.input_files import InputFiles
from clearance.formats.files.mesh_paths import MeshPath, mesh_path, model_path, package_folder
from clearance.formats.files.place import here
from clearance.world.case import LOOKUP, Source
from clearance.world.notice import Notice, Severity


class FoundFiles:
    """Finds the files that one robot or scene names, and keeps what is to be told of them.

    Args:
        files: of the case. package_dirs: where packages are looked up first.
    """

    def __init__(self, files: InputFiles, package_dirs: Sequence[Path]) -> None:
        self._files, self._dirs = files, package_dirs
        self._by_variable: dict[str, dict[str, str]] = {}
        self._stand_ins: dict[str, dict[str, str]] = {}
        self._elsewhere: dict[str, str] = {}

    def add(self, given: str, found: MeshPath, shown: str) -> None:
        """Keeps where a file was found, where that is to be told.

        Args:
            given: as it was named. shown: the file's own name.
        """
        if found.variable:
            self._by_variable.setdefault(found.variable, {}).setdefault(given, shown)
        if found.elsewhere and not found.package:
            self._elsewhere[given] = shown
        if found.package:
            self._stand_ins.setdefault(found.package, {}).setdefault(given, shown)

    def mesh(self, given: str, folder: Path) -> Path:
        """The mesh file that a name in a file of a folder means, kept with where it was found.

        Raises:
            BadInput: as `mesh_path`.
        """
        found = mesh_path(given, folder, self._dirs)
        note_lookup(self._files, MESH, given, folder, self._dirs, found.path)
        self.add(given, found, self._files.shown(found.path))
        return found.path

    def notes(self) -> list[str]:
        """A line for each variable of the environment that led to files, and on paths of another machine."""
        notes = notes_on_variables(self._by_variable)
        if self._elsewhere:
            first = _first(self._elsewhere, "is read from ")
            notes.append(f"path of another machine, found in the same package here: {first}")
        return notes

    def notices(self) -> list[Notice]:
        """Suspect input for each missing package: the files that were read instead."""
        return [
            Notice(
                Severity.SUSPECT,
                "package",
                f"CHECK PACKAGE: package {package!r} was not found: {_first(files, 'is taken from ')}; "
                "is it the same file? give the package's folder in package_dirs",
            )
            for package, files in self._stand_ins.items()
        ]


def notes_on_variables(by_variable: Mapping[str, Mapping[str, str]]) -> list[str]:
    """A line for each variable of the environment that led to files: what was asked for, and the file as shown."""
    return [f"${name} leads to {_first(files)}" for name, files in by_variable.items()]


def _first(files: Mapping[str, str], verb: str = "as ") -> str:
    (given, shown), *others = files.items()
    rest = "" if not others else f", and {len(others)} more in the same way"
    return f"{given} {verb}{shown}{rest}"


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
    moved = Path(given).is_absolute() and found is not None and found != here(given)
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
    """sha256 of a path as seen from a folder, the same on every machine; of no bytes for nothing."""
    path = b"" if found is None else os.fsencode(os.path.relpath(found, folder))
    return hashlib.sha256(path).hexdigest()
