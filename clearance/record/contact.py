"""The pairs in contact at the steps of a run, and the overlaps that the run works out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np

if TYPE_CHECKING:
    from clearance.geometry.boolean import ClosedMesh
    from clearance.query.contact import Contact

FIGURES = (
    "penetration",
    "penetration_at_least",
    "volume",
    "volume_at_least",
    "direction",
    "centroid",
    "exact",
)
OVERLAP = np.dtype(
    [
        ("notes", "i4"),
        *[(name, "f8") for name in FIGURES[:4]],
        *[(name, "f8", 3) for name in FIGURES[4:6]],
        ("exact", "?", 2),
    ]
)
"""One overlap, world frame: its figures as in `Contact`, and the place of its notes."""


@dataclass(frozen=True, eq=False)
class StepContact:
    """One pair that overlaps at one step; `link` and `obstacle` are its two bodies, whatever they are.

    Attributes:
        known: the overlap in the world frame, `link` its body a; None where the run has not worked it out.
        has_region: whether `known` has its region, which is kept of the first 2,000 only.
    """

    step: int
    time: float  # [s]
    link: str
    obstacle: str
    known: Contact | None
    has_region: bool = False

    @property
    def penetration(self) -> float:
        """[m] of the overlap; 0 where the run has not worked it out."""
        return 0.0 if self.known is None else self.known.penetration


class KnownOverlaps(NamedTuple):
    """The overlaps that a run has worked out.

    Attributes:
        figures: (k,) of `OVERLAP`. regions: those that are kept, by place. notes: the different notes on overlaps.
    """

    figures: np.ndarray
    regions: Mapping[int, ClosedMesh]
    notes: tuple[tuple[str, ...], ...]

    def at(self, place: int) -> Contact:
        """One of them; without its region where that is not kept."""
        from clearance.geometry.boolean import ClosedMesh
        from clearance.query.contact import Contact

        row = self.figures[place]
        return Contact(
            **{name: row[name].tolist() for name in FIGURES[:4]},
            **{name: row[name].copy() for name in FIGURES[4:6]},
            region=self.regions.get(place, ClosedMesh.empty()),
            exact=tuple(row["exact"].tolist()),
            notes=self.notes[row["notes"]],
        )


@dataclass(frozen=True, eq=False)
class ContactRows(Sequence[StepContact]):
    """Every pair in contact at every step, steps first.

    Attributes:
        names: the two bodies of each pair of the run. times: (n,) [s] of its steps.
        steps, pairs: (k,) of each row. places: (k,) of its overlap among those known, or -1.
        worked: (m, 2) row and place of each overlap worked out, steps first.
        are_asked: whether the run asks for the depth of any.
        notes: what stands for the bodies in contact, where it is not they themselves; one line each.
    """

    names: Sequence[tuple[str, str]]
    times: np.ndarray
    steps: np.ndarray
    pairs: np.ndarray
    places: np.ndarray
    worked: np.ndarray
    known: KnownOverlaps
    are_asked: bool
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.steps)

    @overload
    def __getitem__(self, index: int) -> StepContact: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[StepContact, ...]: ...

    def __getitem__(self, index: int | slice) -> StepContact | tuple[StepContact, ...]:
        chosen = range(len(self))[index]
        if isinstance(chosen, int):
            return self.row(chosen, int(self.places[chosen]))
        return tuple(self.row(i, int(self.places[i])) for i in chosen)

    def row(self, i: int, place: int) -> StepContact:
        """Row `i`, with the overlap at a place among those known, or none for -1."""
        step, pair = int(self.steps[i]), self.names[int(self.pairs[i])]
        known = None if place < 0 else self.known.at(place)
        return StepContact(step, float(self.times[step]), *pair, known, place in self.known.regions)

    @property
    def worked_out(self) -> Iterator[StepContact]:
        """The rows that the run has worked out, steps first; one is made at a time, to save memory."""
        return (self.row(*row) for row in self.worked.tolist())

    def numbers_between(self, start: int, stop: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """The steps of the rows from a step to before another, their depth and volume; NaN if not worked out."""
        low, high = np.searchsorted(self.steps, [start, stop])
        places = self.places[low:high]
        numbers = {name: np.full(high - low, np.nan) for name in ("penetration", "volume")}
        for name, column in numbers.items():
            column[places >= 0] = self.known.figures[name][places[places >= 0]]
        return self.steps[low:high], numbers
