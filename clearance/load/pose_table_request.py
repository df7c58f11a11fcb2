"""What a reader of pose tables is asked for, and what it gives. Not for: the formats (`pose_formats`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from clearance.errors import BadInput
from clearance.load.csv_table import Opener
from clearance.world.pose_table import PoseTable


@dataclass(frozen=True)
class PoseRequest:
    """A file to read.

    Attributes:
        opened: opens the file, `n_bytes` long, again and again.
        length: of lengths that name no unit themselves, "m" or "mm"; None where the case says nothing.
    """

    opened: Opener
    n_bytes: int
    length: str | None = None

    def refuse_units(self, why: str) -> None:
        """Nothing, if the case says nothing of units.

        Raises:
            BadInput: it does, though the file says by itself what they are.
        """
        if self.length is not None:
            raise BadInput(f"'units' is given, and {why}", valid="leave 'units' out of moves")


class ReadPoses(NamedTuple):
    """A table, and a line each on what was taken how."""

    table: PoseTable
    notes: tuple[str, ...] = ()
