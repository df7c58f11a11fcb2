"""What is measured alike: the pairs of one phase that one rule judges, with one padding and one relation of
clocks.

A run without rules, padding and windows is one section. Not for: which pairs there are (`world.pairs`), and what
the sections' answers come to together (`judged`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.simulate.layout import PairsInMotion
from clearance.world.case import Case, Limits, Omission
from clearance.world.clocks import are_tied
from clearance.world.pairs import Pair, Selection, nothing_to_measure, selected_pairs
from clearance.world.timeline import Phase, Timeline


@dataclass(frozen=True, eq=False)
class Section:
    """Pairs that are measured together over a phase.

    Attributes:
        number: of the section, from 0.
        rule: what judges them, as `Limits.rule_names` counts. padding: [m] of both bodies of each.
        tied: False where the clocks of their two bodies are not those of one actor, and the case does not tie
            them.
        pairs: those of the section. places: (p,) of each in the pairs of the run.
    """

    number: int
    phase: Phase
    rule: int
    padding: float
    tied: bool
    pairs: tuple[Pair, ...]
    places: np.ndarray

    @cached_property
    def in_motion(self) -> PairsInMotion:
        """Its pairs and how they move; limits are those of the distances of the bodies without their padding."""
        limits = self.phase.case.limits.of_rule(self.rule)
        if self.padding:
            limits = Limits(limits.fail + self.padding, limits.warn + self.padding, limits.joints)
        return PairsInMotion(self.phase.case, self.phase.motions, self.pairs, limits)

    @property
    def steps(self) -> slice:
        """The steps of the run that it is of."""
        return slice(self.phase.first, self.phase.last + 1)


@dataclass(frozen=True, eq=False)
class SectionPlan:
    """A run in sections.

    Attributes:
        pairs: all that are measured at some time, each once.
        sections: by phase, then rule, then padding. unmeasured: what is left out in some phase, each once.
        empty: phases in which nothing is measured.
    """

    pairs: tuple[Pair, ...]
    sections: tuple[Section, ...]
    unmeasured: tuple[Omission, ...]
    empty: tuple[Phase, ...]

    def of_rule(self, rule: int) -> tuple[Section, ...]:
        """The sections that a rule judges."""
        return tuple(section for section in self.sections if section.rule == rule)

    @property
    def rules(self) -> tuple[int, ...]:
        """The rules that judge something, as `Limits.rule_names` counts."""
        return tuple(sorted({section.rule for section in self.sections}))


def section_plan(timeline: Timeline) -> SectionPlan:
    """The sections of a case over time.

    Raises:
        NothingToMeasure: no pair is left in any phase.
    """
    selections = [selected_pairs(phase) for phase in timeline.phases]
    places: dict[Pair, int] = {}
    for pair in (pair for selection in selections for pair in selection.pairs):
        places.setdefault(pair, len(places))
    if not places:
        raise nothing_to_measure()
    sections: list[Section] = []
    for phase, selection in zip(timeline.phases, selections, strict=True):
        for (rule, padding, tied), rows in sorted(_alike(phase.case, selection).items()):
            pairs = tuple(selection.pairs[i] for i in rows)
            own = np.array([places[pair] for pair in pairs], dtype=np.int64)
            sections.append(Section(len(sections), phase, rule, padding, tied, pairs, own))
    return SectionPlan(
        tuple(places),
        tuple(sections),
        _each_once(one for selection in selections for one in selection.unmeasured),
        tuple(
            phase
            for phase, selection in zip(timeline.phases, selections, strict=True)
            if not selection.pairs
        ),
    )


def _alike(case: Case, selection: Selection) -> dict[tuple[int, float, bool], list[int]]:
    """The pairs of a selection by rule, padding and whether their clocks are tied."""
    found: dict[tuple[int, float, bool], list[int]] = {}
    for i, pair in enumerate(selection.pairs):
        tied = are_tied(case, pair.a, pair.b)
        found.setdefault((selection.rules[i], selection.paddings[i], tied), []).append(i)
    return found


def _each_once(omissions: Iterable[Omission]) -> tuple[Omission, ...]:
    return tuple(dict.fromkeys(omissions))


def by_phase(sections: Sequence[Section]) -> dict[int, list[Section]]:
    """The sections of each phase, by its first step."""
    found: dict[int, list[Section]] = {}
    for section in sections:
        found.setdefault(section.phase.first, []).append(section)
    return found
