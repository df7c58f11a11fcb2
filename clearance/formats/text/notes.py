"""Wording of notes: those on many files as one line each, and how many of something there are."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import PurePosixPath

from clearance.world.notice import listed


def note_on_rounded(n_rounded: int) -> list[str]:
    """A line that says so where quaternions are rounded."""
    if not n_rounded:
        return []
    were = counted(n_rounded, "quaternion is", "quaternions are")
    return [f"{were} rounded to three digits or so and made of length 1"]


def grouped(notes: Iterable[tuple[str, str]]) -> list[str]:
    """One line for each kind of note on a file: `meshes/a.stl: 2 triangles …; likewise b.stl, c.stl and 9 more`.

    Args:
        notes: (file as it is shown, note) in the order in which they were made; notes that differ only in
            their numbers are of one kind.
    """
    kinds: dict[str, dict[str, str]] = {}
    for file, note in notes:
        kinds.setdefault(re.sub(r"\d+", "#", note), {}).setdefault(file, note)
    lines = []
    for files in kinds.values():
        (first, note), *others = files.items()
        line = f"{short(first)}: {note}"
        if others:
            names = listed([PurePosixPath(file).name for file, _ in others])
            line = f"{len(files)} meshes: {line}; the same for {names}"
        lines.append(line)
    return lines


def short(file: str) -> str:
    """The end of a path: folder and name."""
    parts = PurePosixPath(file).parts
    return file if len(parts) <= 2 or ":" in file else "/".join(parts[-2:])


def counted(n: int, what: str, several: str = "") -> str:
    """`1 link`, `2 links`; or one and several as they are given."""
    return f"{n} {what if n == 1 else several or what + 's'}"
