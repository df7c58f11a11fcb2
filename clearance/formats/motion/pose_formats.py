"""A file of poses to a table, by the reader of its suffix: a further format is a file and a row here.

Not for: when the table is followed (`timed_files`).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePath

from clearance.errors import at
from clearance.formats.motion.pose_table_request import PoseRequest, ReadPoses, ReadSamples


def _csv(request: PoseRequest) -> ReadSamples:
    from clearance.formats.motion.pose_table_file import read_csv_poses

    return read_csv_poses(request)


def _json(request: PoseRequest) -> ReadSamples:
    from clearance.formats.motion.pose_messages import read_json_poses

    return read_json_poses(request)


def _yaml(request: PoseRequest) -> ReadSamples:
    from clearance.formats.motion.pose_messages import read_yaml_poses

    return read_yaml_poses(request)


READERS: dict[str, Callable[[PoseRequest], ReadSamples]] = {
    ".csv": _csv,
    ".json": _json,
    ".yaml": _yaml,
    ".yml": _yaml,
}
"""By suffix in small letters; a file of another suffix is read as CSV."""


def read_samples(request: PoseRequest, shown: str) -> ReadSamples:
    """The samples in a file, as they stand there.

    Args:
        shown: the file's name, in errors.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        return READERS.get(PurePath(shown).suffix.lower(), _csv)(request)


def read_poses(request: PoseRequest, shown: str) -> ReadPoses:
    """The table of the samples in a file.

    Args:
        shown: the file's name, in errors.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    samples, notes = read_samples(request, shown)
    with at(shown):
        return ReadPoses(samples.table(), notes)
