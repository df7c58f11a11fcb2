"""The contacts of a run in one table, with the overlaps that it asks for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.boolean import ClosedMesh
from clearance.progress import Progress
from clearance.query.contact import Contact
from clearance.record.contact import FIGURES, OVERLAP, ContactRows, KnownOverlaps, StepContact
from clearance.record.names import pair_names
from clearance.simulate.answers.contact.contacts import OverlapFinder, overlap_finder
from clearance.simulate.measure.sections import SectionAnswer
from clearance.world.case import Case
from clearance.world.pairs import Pair

MOST_REGIONS = 2000
"""Regions of a part that are cached; one takes some 2 to 10 kB."""


def contacts_of(
    case: Case,
    pairs: Sequence[Pair],
    answers: Sequence[SectionAnswer],
    times: np.ndarray,
    work_out: str,
    progress: Progress | None = None,
) -> FoundContacts | None:
    """The contacts of a run, of what its sections have found; None where no pair that one time has touches.

    Args:
        pairs: those of the run. times: (n,) [s] of its steps.
        work_out: of which rows depth, volume and separation vector are found: the deepest moment of each of the
            "events", "every" one, or "none".
        progress: called with how many of how many.
    """
    parts = [
        _part_of(answer, work_out, progress)
        for answer in answers
        if answer.section.tied
        and (answer.found.clearance <= 0.0).any()
        and not all(pair.has_cloud(case) for pair in answer.section.pairs)
    ]
    names = list(zip(*pair_names(case, pairs), strict=True))
    return joined_contacts(parts, names, times) if parts else None


def _part_of(answer: SectionAnswer, work_out: str, progress: Progress | None) -> ContactPart:
    section, found = answer.section, answer.found
    finder = overlap_finder(
        section.phase.case,
        section.phase.motions,
        section.pairs,
        found.clearance,
        found.pair,
        work_out,
    )
    return ContactPart.of(finder, section.phase.first, section.places, progress)


@dataclass(frozen=True, eq=False)
class ContactPart:
    """The contacts of one part of a run.

    Attributes:
        first: the step of the run that it begins with. places: (p,) of its pairs in the run.
        steps, pairs: (k,) of each row, as the part counts. worked: (m,) rows whose overlaps are known.
    """

    finder: OverlapFinder
    first: int
    places: np.ndarray
    steps: np.ndarray
    pairs: np.ndarray
    worked: np.ndarray
    known: KnownOverlaps

    @staticmethod
    def of(
        finder: OverlapFinder, first: int, places: np.ndarray, progress: Progress | None = None
    ) -> ContactPart:
        """The part with the overlaps that are asked for; `progress` is called with how many of how many."""
        steps, pairs = finder.touching()
        worked, known = _gathered(finder.chosen(steps, pairs, progress))
        return ContactPart(finder, first, places, steps, pairs, worked, known)

    def overlap(self, step: int, pair: int) -> Contact | None:
        """All of the overlap of a pair at a step, as the run counts them; None if this part has no such row."""
        own = np.flatnonzero((self.steps + self.first == step) & (self.places[self.pairs] == pair))
        if not len(own):
            return None
        return self.finder.contact(int(self.steps[own[0]]), int(self.pairs[own[0]]))


def _gathered(found: Iterator[tuple[int, Contact]]) -> tuple[np.ndarray, KnownOverlaps]:
    """(m,) the rows of some overlaps, and these as a table in that order."""
    notes: dict[tuple[str, ...], int] = {}
    worked, figures, regions = [], [], {}
    for place, (row, one) in enumerate(found):
        i_notes = notes.setdefault(one.notes, len(notes))
        worked.append(row)
        figures.append((i_notes, *(getattr(one, name) for name in FIGURES)))
        if place < MOST_REGIONS:
            regions[place] = one.region
    known = KnownOverlaps(np.array(figures, dtype=OVERLAP), regions, tuple(notes))
    return np.array(worked, dtype=np.int64), known


@dataclass(frozen=True, eq=False)
class FoundContacts:
    """The contacts of a run as data, and the parts that can find an overlap once more."""

    rows: ContactRows
    parts: Sequence[ContactPart]

    def overlap(self, row: StepContact) -> Contact:
        """All of an overlap, with its region; worked out now where it is not cached."""
        if row.known is not None and row.has_region:
            return row.known
        pair = self.rows.names.index((row.link, row.obstacle))
        found = (part.overlap(row.step, pair) for part in reversed(self.parts))
        return next(one for one in found if one is not None)


def joined_contacts(
    parts: Sequence[ContactPart], names: Sequence[tuple[str, str]], times: np.ndarray
) -> FoundContacts:
    """The contacts of all parts, steps first.

    Where two parts meet, a pair that both measure is there once, as the later part has it.

    Args:
        names: the two bodies of each pair of the run. times: (n,) [s] of its steps.
    """
    steps = np.concatenate([part.steps + part.first for part in parts])
    pairs = np.concatenate([part.places[part.pairs] for part in parts])
    owners = np.repeat(np.arange(len(parts)), [len(part.steps) for part in parts])
    order = np.lexsort((-owners, pairs, steps))
    changes = (np.diff(steps[order]) != 0) | (np.diff(pairs[order]) != 0)
    is_first = np.append(True, changes)[: len(order)]
    row_of = np.empty(len(order), dtype=np.int64)
    row_of[order] = np.cumsum(is_first) - 1
    first_rows = order[is_first]
    starts = np.cumsum([0, *(len(part.steps) for part in parts)])
    worked = np.concatenate([one.worked + start for one, start in zip(parts, starts, strict=False)])
    places = np.full(len(order), -1)
    places[worked] = np.arange(len(worked))
    by_part = np.lexsort((worked, owners[worked], steps[worked]))
    rows = ContactRows(
        names,
        times,
        steps[first_rows],
        pairs[first_rows],
        places[first_rows],
        np.column_stack([row_of[worked], places[worked]])[by_part],
        _joined_overlaps([part.known for part in parts]),
        any(part.finder.work_out != "none" for part in parts),
        tuple(dict.fromkeys(note for part in parts for note in part.finder.notes())),
    )
    return FoundContacts(rows, parts)


def _joined_overlaps(known: Sequence[KnownOverlaps]) -> KnownOverlaps:
    notes = tuple(dict.fromkeys(note for one in known for note in one.notes))
    figures = np.concatenate([one.figures for one in known])
    places = [[notes.index(note) for note in one.notes] for one in known]
    figures["notes"] = np.concatenate(
        [
            np.array(place, dtype=np.int32)[one.figures["notes"]]
            for place, one in zip(places, known, strict=True)
        ]
    )
    starts = np.cumsum([0, *(len(one.figures) for one in known)]).tolist()
    regions: dict[int, ClosedMesh] = {}
    for one, start in zip(known, starts, strict=False):
        regions |= {start + place: region for place, region in one.regions.items()}
    return KnownOverlaps(figures, regions, notes)
