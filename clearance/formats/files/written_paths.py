"""How paths of files that are read are written in a file that is made. Not for: finding them (`input_files`)."""

from __future__ import annotations

import os
from pathlib import Path

from clearance.formats.files.input_files import PYBULLET_DATA

FARTHEST = 4
"""Folders up; a path that climbs higher is written from the root, as one that has only the root in common."""


def path_from(folder: Path, given: str | Path) -> str:
    """How a path that is relative to the current folder is written in a file in `folder`, which need not be there.

    From the root where `folder` is reached by a link, since `..` would then be of two meanings.
    """
    if str(given).startswith(PYBULLET_DATA):
        return str(given)
    path, folder = Path(os.path.abspath(given)), Path(os.path.abspath(folder))
    try:
        shared = Path(os.path.commonpath([path, folder]))
    except ValueError:  # two drives
        return path.as_posix()
    below = folder.relative_to(shared)
    is_linked = os.path.realpath(folder) != os.path.join(os.path.realpath(shared), below)
    is_far = shared == Path(shared.anchor) or len(below.parts) > FARTHEST
    if is_far or (is_linked and below.parts):
        return path.as_posix()
    return Path(os.path.relpath(path, folder)).as_posix()
