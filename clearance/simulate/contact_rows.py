"""The overlaps of a run as a sequence that takes little memory however many there are.

Each is one row of numbers; the regions of the first ones are kept, those of the others are found again when they
are looked at. Not for: finding overlaps (`contact`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import overload

import numpy as np

from clearance.geometry.boolean import ClosedMesh
from clearance.query.contact import Contact
from clearance.simulate.record import StepContact

MOST_REGIONS = 2000
"""Regions that are kept; one takes some 2 to 10 kB."""

_NUMBERS = ("penetration", "penetration_at_least", "volume", "volume_at_least", "direction", "centroid", "exact")
_ROW = np.dtype(
    [
        ("step", "i8"),
        ("pair", "i4"),
        ("notes", "i4"),
        *[(name, "f8") for name in _NUMBERS[:4]],
        *[(name, "f8", 3) for name in _NUMBERS[4:6]],
        ("exact", "?", 2),
    ]
)


@dataclass(eq=False)
class ContactRows(Sequence[StepContact]):
    """Every pair in contact at every step, steps first.

    Attributes:
        names: link and obstacle of each pair.
        times: (n,) [s] of the steps.
        again: finds the overlap of a step and pair once more, in the world frame.
    """

    names: Sequence[tuple[str, str]]
    times: np.ndarray
    again: Callable[[int, int], Contact]
    _rows: np.ndarray = field(default_factory=lambda: np.empty(64, dtype=_ROW))
    _n_rows: int = 0
    _regions: list[ClosedMesh] = field(default_factory=list)
    _notes: dict[tuple[str, ...], int] = field(default_factory=dict)

    def add(self, step: int, i_pair: int, found: Contact) -> None:
        """Appends the overlap of a pair at a step; `found` is in the world frame."""
        if self._n_rows == len(self._rows):
            self._rows = np.resize(self._rows, 2 * self._n_rows)
        i_notes = self._notes.setdefault(found.notes, len(self._notes))
        numbers = [getattr(found, name) for name in _NUMBERS]
        self._rows[self._n_rows] = (step, i_pair, i_notes, *numbers)
        self._n_rows += 1
        if len(self._regions) < MOST_REGIONS:
            self._regions.append(found.region)

    @property
    def steps(self) -> np.ndarray:
        """(k,) the step of each, not decreasing."""
        return self._rows["step"][: self._n_rows]

    @property
    def penetrations(self) -> np.ndarray:
        """(k,) [m]."""
        return self._rows["penetration"][: self._n_rows]

    def __len__(self) -> int:
        return self._n_rows

    @overload
    def __getitem__(self, index: int) -> StepContact: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[StepContact, ...]: ...

    def __getitem__(self, index: int | slice) -> StepContact | tuple[StepContact, ...]:
        chosen = range(self._n_rows)[index]
        return self._at(chosen) if isinstance(chosen, int) else tuple(map(self._at, chosen))

    def _at(self, i: int) -> StepContact:
        row = self._rows[i]
        step, i_pair = int(row["step"]), int(row["pair"])
        known = i < len(self._regions)
        found = Contact(
            **{name: row[name].tolist() for name in _NUMBERS[:4]},
            **{name: row[name].copy() for name in _NUMBERS[4:6]},
            region=self._regions[i] if known else ClosedMesh.empty(),
            exact=tuple(row["exact"].tolist()),
            notes=tuple(self._notes)[row["notes"]],
        )
        again = None if known else lambda: self.again(step, i_pair)
        return StepContact(step, float(self.times[step]), *self.names[i_pair], found, again)
