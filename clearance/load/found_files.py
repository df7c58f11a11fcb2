"""What is told of files that lie elsewhere than where they were named. Not for: finding them (`mesh_paths`)."""

from __future__ import annotations

from collections.abc import Mapping

from clearance.world.notice import Notice, Severity

Found = Mapping[str, Mapping[str, str]]
"""By package or variable: what was asked for, and the file as it is shown."""


def notes_on_variables(by_variable: Found) -> list[str]:
    """A line for each variable of the environment that led to files."""
    return [f"${name} leads to {_first(files)}" for name, files in by_variable.items()]


def notices_on_stand_ins(stand_ins: Found) -> list[Notice]:
    """A warning for each package that is not there, on the files that stand in for its own."""
    return [
        Notice(
            Severity.WARNING,
            "package",
            f"package {package!r} is not there: {_first(files, 'is taken from ')}; is it the same file?",
        )
        for package, files in stand_ins.items()
    ]


def _first(files: Mapping[str, str], verb: str = "as ") -> str:
    (given, shown), *others = files.items()
    rest = "" if not others else f", and {len(others)} more likewise"
    return f"{given} {verb}{shown}{rest}"
