"""A file of poses to a table, by the reader of its format.

Not for: when the table is followed (`timed_files`).
"""

from __future__ import annotations

from clearance.errors import at
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.motion.pose_table_request import PoseRequest, ReadPoses, ReadSamples


def read_samples(request: PoseRequest, shown: str) -> ReadSamples:
    """The samples in a file, as they stand there.

    Args:
        shown: the file's name, in errors.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        known = format_of(Kind.POSES, shown)
        assert known is not None  # as any file is CSV where nothing says otherwise
        found: ReadSamples = function_at(known.read)(request)
    return found


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
