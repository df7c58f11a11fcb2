"""What is told of files that lie elsewhere than where they were named. Not for: finding them (`mesh_paths`)."""

from __future__ import annotations

from collections.abc import Mapping

from clearance.formats.files.mesh_paths import MeshPath
from clearance.world.notice import Notice, Severity

PathsByName = Mapping[str, Mapping[str, str]]
"""By package or variable: what was asked for, and the file as it is shown."""


class FoundFiles:
    """What is to be told of the files that one robot or scene names."""

    def __init__(self) -> None:
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

    def notes(self) -> list[str]:
        """A line for each variable of the environment that led to files, and on paths of another machine."""
        notes = notes_on_variables(self._by_variable)
        if self._elsewhere:
            told = _first(self._elsewhere, "is read from ")
            notes.append(f"path of another machine, found in the same package here: {told}")
        return notes

    def notices(self) -> list[Notice]:
        """Suspect input for each missing package: the files that were read instead."""
        return _notices_on_stand_ins(self._stand_ins)


def notes_on_variables(by_variable: PathsByName) -> list[str]:
    """A line for each variable of the environment that led to files."""
    return [f"${name} leads to {_first(files)}" for name, files in by_variable.items()]


def _notices_on_stand_ins(stand_ins: PathsByName) -> list[Notice]:
    """Suspect input for each package that is not there: the files that stand in for its own."""
    return [
        Notice(
            Severity.SUSPECT,
            "package",
            f"CHECK PACKAGE: package {package!r} was not found: {_first(files, 'is taken from ')}; "
            "is it the same file? give the package's folder in package_dirs",
        )
        for package, files in stand_ins.items()
    ]


def _first(files: Mapping[str, str], verb: str = "as ") -> str:
    (given, shown), *others = files.items()
    rest = "" if not others else f", and {len(others)} more likewise"
    return f"{given} {verb}{shown}{rest}"
