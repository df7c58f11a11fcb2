"""Which paths are bags of ROS, and of which files. Not for: what is in them (`rosbag_file`)."""

from __future__ import annotations

from pathlib import Path

from clearance.formats.known_formats import BAGS


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag: a folder, or a file by its suffix."""
    return path.suffix.lower() in BAGS or path.is_dir()


def files_of(path: Path) -> list[Path]:
    """The files of a bag."""
    if not path.is_dir():
        return [path]
    return sorted(one for one in path.iterdir() if one.is_file() and not one.name.startswith("."))
