"""The overlaps of a run: which pair at which step, with the figures of those that the run works out.

Which pairs are in contact is asked when somebody looks, and so are depth, volume and way out: of the deepest
moment of every event, of all, or of none. Any other row is worked out when it is looked at itself. Not for: how
(`contacts`), and which moment (`events`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from clearance.geometry.boolean import ClosedMesh
from clearance.progress import Progress
from clearance.query.contact import Contact
from clearance.simulate.contact.rows_on_demand import RowsOnDemand
from clearance.simulate.contact.sequence import ContactSequence, StepContact

MOST_REGIONS = 2000
"""Regions that are kept; one takes some 2 to 10 kB."""

_NUMBERS = (
    "penetration",
    "penetration_at_least",
    "volume",
    "volume_at_least",
    "direction",
    "centroid",
    "exact",
)
_ROW = np.dtype(
    [
        ("notes", "i4"),
        *[(name, "f8") for name in _NUMBERS[:4]],
        *[(name, "f8", 3) for name in _NUMBERS[4:6]],
        ("exact", "?", 2),
    ]
)


class ContactFinder(Protocol):
    """What finds overlaps.

    Attributes:
        work_out: of which rows depth, volume and way out are worked out: "none", "events" or "every".
    """

    work_out: str

    def touching(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) steps and (n,) pairs in contact, steps first."""

    def contact(self, step: int, i_pair: int) -> Contact:
        """The overlap of a pair that is in contact at a step, in the world frame."""

    def chosen(
        self, steps: np.ndarray, pairs: np.ndarray, progress: Progress | None
    ) -> Iterator[tuple[int, Contact]]:
        """The rows that the run works out, each with its overlap."""

    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies so far, where it is not they themselves."""


@dataclass(eq=False)
class ContactRows(ContactSequence):
    """Every pair in contact at every step, steps first.

    Attributes:
        names: link and obstacle of each pair.
        times: (n,) [s] of the steps.
        finder: finds what is looked at.
    """

    names: Sequence[tuple[str, str]]
    times: np.ndarray
    finder: ContactFinder
    _slots: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    _n_known: int = 0
    _rows: np.ndarray = field(default_factory=lambda: np.empty(64, dtype=_ROW))
    _regions: list[ClosedMesh] = field(default_factory=list)
    _notes: dict[tuple[str, ...], int] = field(default_factory=dict)
    _told: tuple[str, ...] = ()
    _is_worked_out: bool = False

    @cached_property
    def _touching(self) -> tuple[np.ndarray, np.ndarray]:
        return self.finder.touching()

    @property
    def steps(self) -> np.ndarray:
        """(k,) the step of each, not decreasing."""
        return self._touching[0]

    @property
    def pairs(self) -> np.ndarray:
        """(k,) the pair of each, as an index into `names`."""
        return self._touching[1]

    @property
    def are_asked(self) -> bool:
        """True unless the run asks for the depth of none."""
        return self.finder.work_out != "none"

    def work_out(self, progress: Progress | None = None) -> None:
        """Works out what the run asks for, once; `progress` is called with how many of how many."""
        if not self._is_worked_out:
            self._slots = np.full(len(self), -1, dtype=np.int64)
            for i, found in self.finder.chosen(*self._touching, progress):
                self._add(i, found)
            self._told = self.finder.notes()
            self._is_worked_out = True

    @property
    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves; one line each."""
        self.work_out()
        return self._told

    @property
    def worked_out(self) -> Sequence[StepContact]:
        """The rows that the run works out, steps first."""
        self.work_out()
        return _SelectedRows(self, np.flatnonzero(self._slots >= 0))

    def numbers_between(self, start: int, stop: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """The steps of the rows from a step to before another, their depth and volume; NaN if not worked out."""
        self.work_out()
        low, high = np.searchsorted(self.steps, [start, stop])
        numbers = {name: np.full(high - low, np.nan) for name in ("penetration", "volume")}
        slots = self._slots[low:high]
        for name, column in numbers.items():
            column[slots >= 0] = self._rows[name][slots[slots >= 0]]
        return self.steps[low:high], numbers

    def _add(self, i: int, found: Contact) -> None:
        slot = self._n_known
        self._n_known += 1
        if slot == len(self._rows):
            self._rows = np.resize(self._rows, 2 * slot)
        i_notes = self._notes.setdefault(found.notes, len(self._notes))
        self._rows[slot] = (i_notes, *(getattr(found, name) for name in _NUMBERS))
        self._slots[i] = slot
        if len(self._regions) < MOST_REGIONS:
            self._regions.append(found.region)

    def _at(self, i: int) -> StepContact:
        self.work_out()
        step, i_pair = int(self.steps[i]), int(self.pairs[i])
        slot = int(self._slots[i])
        again = (
            None if 0 <= slot < len(self._regions) else lambda: self.finder.contact(step, i_pair)
        )
        known = None if slot < 0 else self._known(slot)
        return StepContact(step, float(self.times[step]), *self.names[i_pair], known, again)

    def _known(self, slot: int) -> Contact:
        row = self._rows[slot]
        return Contact(
            **{name: row[name].tolist() for name in _NUMBERS[:4]},
            **{name: row[name].copy() for name in _NUMBERS[4:6]},
            region=self._regions[slot] if slot < len(self._regions) else ClosedMesh.empty(),
            exact=tuple(row["exact"].tolist()),
            notes=tuple(self._notes)[row["notes"]],
        )


@dataclass(frozen=True, eq=False)
class _SelectedRows(RowsOnDemand[StepContact]):
    """Some of the rows, made when they are looked at."""

    rows: ContactRows
    which: np.ndarray

    def __len__(self) -> int:
        return len(self.which)

    def _at(self, i: int) -> StepContact:
        return self.rows[int(self.which[i])]
