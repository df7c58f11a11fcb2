"""What a reader of poses is asked for and gives, and the reader of a file by its format. Not for: when poses
are followed (`timed_files`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from clearance.errors import at
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.message.values import NANO
from clearance.formats.table.csv_table import Opener
from clearance.formats.text.notes import note_on_rounded
from clearance.geometry.quaternions import of_unit_length
from clearance.world.pose_table import PoseTable


@dataclass(frozen=True)
class PoseRequest:
    """A file to read.

    Attributes:
        opened: opens the file, again and again.
        length: of lengths that name no unit themselves, "m" or "mm"; None where the case says nothing.
    """

    opened: Opener
    length: str | None = None


@dataclass(frozen=True, eq=False)
class PoseSamples:
    """What a file of poses says, number by number.

    Attributes:
        times: (n,) [s]. positions: (n, 3) [m]. quaternions: (n, 4) xyzw, before they are made of length one.
        frame: what they are seen from, and child: what they are of, where messages say so.
        stamp: [ns] of the first sample in a file of messages, whose times count from there.
    """

    times: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    frame: str = ""
    child: str = ""
    stamp: int = 0

    def table(self) -> PoseTable:
        """What a body follows.

        Raises:
            BadTime, BadPose, NotFinite: samples that nothing can follow.
        """
        began = self.stamp / NANO if self.stamp else None
        return PoseTable(
            self.times, self.positions, self.quaternions, frame=self.frame, began=began
        )


class ReadSamples(NamedTuple):
    """What a file says, and a line each on what was taken how."""

    samples: PoseSamples
    notes: tuple[str, ...] = ()


def samples_of(written: PoseSamples, notes: tuple[str, ...]) -> ReadSamples:
    """What a file says, its quaternions of three digits or so made of length one, with a note."""
    quaternions, n_rounded = of_unit_length(written.quaternions)
    samples = replace(written, quaternions=quaternions)
    return ReadSamples(samples, (*notes, *note_on_rounded(n_rounded)))


def read_samples(request: PoseRequest, shown: str) -> ReadSamples:
    """The samples in a file, as they stand there, which something can follow.

    Args:
        shown: the file's name, in errors.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        known = format_of(Kind.POSES, shown)
        assert known is not None  # as any file is CSV where nothing says otherwise
        found: ReadSamples = function_at(known.read)(request)
        found.samples.table()  # which raises, where nothing can follow them
    return found
