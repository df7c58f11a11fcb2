"""The overlaps that a replay draws: regions as surfaces, ways out as arrows, thinned where there are too many.

Not for: finding them (`contact.contacts`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.simulate.contact.sequence import StepContact
from clearance.simulate.record import Record

MOST_CONTACTS = 600
"""Most overlaps drawn: each is an object of its own in the viewer."""

MOST_TRIANGLES = 200_000
"""Most triangles of all regions together: about 5 MB on the page."""


@dataclass(frozen=True)
class DrawnContact:
    """One overlap: in which frame, between whom, where its arrow starts and points (world frame, [m]).

    `exact` and `volume_exact` are False where `penetration` [m] and `volume` [m^3] are upper bounds; lower ones
    stand beside them.
    """

    frame: int
    link: str
    obstacle: str
    penetration: float
    penetration_at_least: float
    volume: float
    volume_at_least: float
    exact: bool
    volume_exact: bool
    start: tuple[float, float, float]
    direction: tuple[float, float, float]


def drawn_contacts(
    record: Record, kept: np.ndarray
) -> tuple[tuple[DrawnContact, ...], tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """The overlaps that the run works out of the steps `kept`, and the region of each: vertices (n, 3) float32,
    triangles (m, 3) int32.

    Beyond `MOST_CONTACTS` or `MOST_TRIANGLES`, every second, third, … contact; always the deepest.
    """
    frames = {int(step): i for i, step in enumerate(kept)}
    rows = [row for row in record.worked_out if row.step in frames]
    chosen = _thinned(rows, record.deepest)
    return (
        tuple(_drawn(row, frames[row.step]) for row in chosen),
        tuple(
            (
                row.found.region.vertices.astype(np.float32),
                row.found.region.triangles.astype(np.int32),
            )
            for row in chosen
        ),
    )


def _thinned(rows: Sequence[StepContact], deepest: StepContact | None) -> list[StepContact]:
    every = max(1, -(-len(rows) // MOST_CONTACTS))
    while True:
        chosen = [row for i, row in enumerate(rows) if i % every == 0 or _same(row, deepest)]
        if len(chosen) <= 2:
            return chosen
        if len(chosen) <= MOST_CONTACTS:
            n_triangles = sum(len(row.found.region.triangles) for row in chosen)
            if n_triangles <= MOST_TRIANGLES:
                return chosen
        every += 1


def _same(row: StepContact, other: StepContact | None) -> bool:
    return other is not None and (row.step, row.link, row.obstacle) == (
        other.step,
        other.link,
        other.obstacle,
    )


def _drawn(row: StepContact, frame: int) -> DrawnContact:
    found = row.found
    return DrawnContact(
        frame=frame,
        link=row.link,
        obstacle=row.obstacle,
        penetration=found.penetration,
        penetration_at_least=found.penetration_at_least,
        volume=found.volume,
        volume_at_least=found.volume_at_least,
        exact=bool(found.exact[0]),
        volume_exact=bool(found.exact[1]),
        start=tuple(found.centroid.tolist()),
        direction=tuple(found.direction.tolist()),
    )
