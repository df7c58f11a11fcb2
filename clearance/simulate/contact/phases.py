"""The contacts of a run in phases, as one sequence. Not for: finding them (`contacts`), and keeping them
(`rows`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from clearance.progress import Progress
from clearance.simulate.contact.contacts import find_contacts
from clearance.simulate.contact.rows import ContactRows
from clearance.simulate.contact.sequence import ContactSequence, StepContact
from clearance.simulate.section_answer import SectionAnswer
from clearance.world.case import Case


def contacts_of(
    case: Case, answers: Sequence[SectionAnswer], times: np.ndarray, work_out: str
) -> ContactSequence | tuple[()]:
    """The contacts of a run, of what its sections have found; `work_out` is as in `find_contacts`."""
    parts = [
        _of_section(answer, work_out)
        for answer in answers
        if answer.section.tied
        and (answer.found.clearance <= 0.0).any()
        and not all(pair.has_cloud(case) for pair in answer.section.pairs)
    ]
    if not parts:  # only pairs whose clocks are not tied touch: no one time has them
        return ()
    if len(answers) == 1:
        return parts[0].rows
    return ContactsOfPhases(parts, times)


@dataclass(frozen=True, eq=False)
class _Part:
    """The contacts of a section; its steps begin at `first` of the run, and its pairs have `places` there."""

    rows: ContactRows
    first: int
    places: np.ndarray


def _of_section(answer: SectionAnswer, work_out: str) -> _Part:
    section, found = answer.section, answer.found
    rows = find_contacts(
        section.phase.case,
        section.phase.motions,
        section.pairs,
        found.clearance,
        found.pair,
        work_out,
    )
    return _Part(rows, section.phase.first, section.places)


@dataclass(eq=False)
class ContactsOfPhases(ContactSequence):
    """Every pair in contact at every step, steps first, over several sections.

    Where two phases meet, a pair that both measure is there once.
    """

    parts: Sequence[_Part]
    times: np.ndarray
    _told: dict[int, StepContact] = field(default_factory=dict)

    @cached_property
    def _order(self) -> tuple[np.ndarray, ...]:
        """(k,) steps, pairs, parts and rows there, in order."""
        steps = np.concatenate([part.rows.steps + part.first for part in self.parts])
        pairs = np.concatenate([part.places[part.rows.pairs] for part in self.parts])
        owners = np.repeat(np.arange(len(self.parts)), [len(part.rows) for part in self.parts])
        rows = np.concatenate([np.arange(len(part.rows)) for part in self.parts])
        order = np.lexsort((-owners, pairs, steps))
        steps, pairs, owners, rows = (column[order] for column in (steps, pairs, owners, rows))
        first = np.ones(len(steps), dtype=bool)
        first[1:] = (np.diff(steps) != 0) | (np.diff(pairs) != 0)
        return steps[first], pairs[first], owners[first], rows[first]

    @property
    def steps(self) -> np.ndarray:
        """(k,) the step of each, not decreasing."""
        return self._order[0]

    @property
    def pairs(self) -> np.ndarray:
        """(k,) the pair of each in the run."""
        return self._order[1]

    @property
    def are_asked(self) -> bool:
        """True unless the run asks for the depth of none."""
        return any(part.rows.are_asked for part in self.parts)

    def work_out(self, progress: Progress | None = None) -> None:
        """Works out what the run asks for, once."""
        for part in self.parts:
            part.rows.work_out(progress)

    @property
    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves; one line each."""
        return tuple(dict.fromkeys(note for part in self.parts for note in part.rows.notes))

    @property
    def worked_out(self) -> Sequence[StepContact]:
        """The rows that the run works out, steps first."""
        found = [self._placed(part, row) for part in self.parts for row in part.rows.worked_out]
        return tuple(sorted(found, key=lambda row: row.step))

    def numbers_between(self, start: int, stop: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """The steps of the rows from a step to before another, their depth and volume; NaN if not worked out."""
        low, high = np.searchsorted(self.steps, [start, stop])
        rows = [self[i].known for i in range(low, high)]
        numbers = {
            name: np.array([np.nan if row is None else getattr(row, name) for row in rows])
            for name in ("penetration", "volume")
        }
        return self.steps[low:high], numbers

    def _at(self, i: int) -> StepContact:
        if i not in self._told:
            _, _, owners, rows = self._order
            part = self.parts[int(owners[i])]
            self._told[i] = self._placed(part, part.rows[int(rows[i])])
        return self._told[i]

    def _placed(self, part: _Part, row: StepContact) -> StepContact:
        step = row.step + part.first
        return replace(row, step=step, time=float(self.times[step]))
