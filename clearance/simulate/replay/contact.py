"""The overlaps that a replay draws: regions as surfaces, ways out as arrows, thinned where there are too many.

Not for: finding them (`contact.contacts`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.record.contact import StepContact
from clearance.record.replay import DrawnContact
from clearance.simulate.answers.measured_run import MeasuredRun

if TYPE_CHECKING:
    from clearance.query.contact import Contact

MOST_CONTACTS = 600
"""Most overlaps drawn: each is an object of its own in the viewer."""

MOST_TRIANGLES = 200_000
"""Most triangles of all regions together: about 5 MB on the page."""


def drawn_contacts(
    run: MeasuredRun, kept: np.ndarray
) -> tuple[tuple[DrawnContact, ...], tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """The overlaps that the run works out of the steps `kept`, and the region of each: vertices (n, 3) float32,
    triangles (m, 3) int32.

    Beyond `MOST_CONTACTS` or `MOST_TRIANGLES`, every second, third, … contact; always the deepest.
    """
    frames = {int(step): i for i, step in enumerate(kept)}
    rows = [row for row in run.record.worked_out if row.step in frames]
    chosen = _thinned(run, rows)
    return (
        tuple(_drawn(row, found, frames[row.step]) for row, found in chosen),
        tuple(
            (found.region.vertices.astype(np.float32), found.region.triangles.astype(np.int32))
            for _, found in chosen
        ),
    )


def _thinned(run: MeasuredRun, rows: Sequence[StepContact]) -> list[tuple[StepContact, Contact]]:
    every, deepest = max(1, -(-len(rows) // MOST_CONTACTS)), run.record.deepest
    while True:
        chosen = [row for i, row in enumerate(rows) if i % every == 0 or _same(row, deepest)]
        if len(chosen) <= MOST_CONTACTS:
            found = [(row, run.overlap(row)) for row in chosen]
            n_triangles = sum(len(one.region.triangles) for _, one in found)
            if len(chosen) <= 2 or n_triangles <= MOST_TRIANGLES:
                return found
        every += 1


def _same(row: StepContact, other: StepContact | None) -> bool:
    return other is not None and (row.step, row.link, row.obstacle) == (
        other.step,
        other.link,
        other.obstacle,
    )


def _drawn(row: StepContact, found: Contact, frame: int) -> DrawnContact:
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
