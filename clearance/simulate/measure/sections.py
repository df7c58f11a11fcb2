"""What is measured alike: the pairs of one phase that one rule judges, with one padding and one relation of
clocks.

A run without rules, padding and windows is one section.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.simulate.measure.clocks.pairs import ClockMotion, PairsOfTwoClocks
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion
from clearance.tolerance import AT_LEVEL
from clearance.world.case import Case, Limits, Omission
from clearance.world.clocks import actors_of_clock, clock_pair, clocks_of
from clearance.world.pairs import Pair, Selection, nothing_to_measure, selected_pairs
from clearance.world.phase import Phase
from clearance.world.reach import farthest_reach
from clearance.world.timeline import Timeline


@dataclass(frozen=True, eq=False)
class Section:
    """Pairs that are measured together over a phase.

    Attributes:
        number: of the section, from 0.
        rule: what judges them, as `Limits.rule_names` counts. padding: [m] of both bodies of each.
        pairs: those of the section. places: (p,) of each in the pairs of the run.
        other: the phase that the second bodies are in, where their clock is not tied to that of the first; else
            None.
        levels: [m] of clearance that are to be decided as well as the limits, as a waiver's.
    """

    number: int
    phase: Phase
    rule: int
    padding: float
    pairs: tuple[Pair, ...]
    places: np.ndarray
    other: Phase | None = None
    levels: tuple[float, ...] = ()

    @property
    def tied(self) -> bool:
        """True if both bodies of each pair are where they are at one time."""
        return self.other is None

    @cached_property
    def limits(self) -> Limits:
        """Those of the distances of the bodies without their padding."""
        limits = self.phase.case.limits.of_rule(self.rule)
        phases = (self.phase,) if self.other is None else (self.phase, self.other)
        reach = max(farthest_reach(phase.case, phase.motions) for phase in phases)
        return replace(
            limits,
            fail=limits.fail + self.padding,
            warn=limits.warn + self.padding,
            rounding=AT_LEVEL * reach,
        )

    @cached_property
    def in_motion(self) -> PairsInMotion:
        """Its pairs and how they move."""
        return PairsInMotion(self.phase.case, self.phase.motions, self.pairs, self.limits)

    @cached_property
    def of_two_clocks(self) -> PairsOfTwoClocks:
        """The same of pairs whose clocks are not tied: the first bodies in this phase, the second in the other."""
        assert self.other is not None
        a = ClockMotion(self.phase.case, self.phase.motions)
        b = ClockMotion(self.other.case, self.other.motions)
        case, second = self.phase.case, self.pairs[0].b
        actors = actors_of_clock(case, second)
        return PairsOfTwoClocks(a, b, actors, self.pairs, self.limits, case.clock.slack)

    @property
    def steps(self) -> slice:
        """The steps of the run that it is of."""
        return slice(self.phase.first, self.phase.last + 1)


def rule_limits(case: Case, rule: int, sections: Sequence[Section]) -> Limits:
    """The limits of a rule, as `Limits.rule_names` counts, with the rounding of its sections."""
    rounding = max(section.limits.rounding for section in sections)
    return replace(case.limits.of_rule(rule), rounding=rounding)


@dataclass(frozen=True, eq=False)
class SectionPlan:
    """A run in sections.

    Attributes:
        pairs: all that are measured at some time, each once.
        sections: by phase, then rule, then padding. unmeasured: what is not measured in some phase, each once.
        empty: phases in which nothing is measured.
    """

    pairs: tuple[Pair, ...]
    sections: tuple[Section, ...]
    unmeasured: tuple[Omission, ...]
    empty: tuple[Phase, ...]

    @property
    def rules(self) -> tuple[int, ...]:
        """The rules that judge something, as `Limits.rule_names` counts."""
        return tuple(sorted({section.rule for section in self.sections}))


def section_plan(timeline: Timeline) -> SectionPlan:
    """The sections of a case over time.

    Raises:
        NothingToMeasure: no pair remains in any phase.
    """
    phases = timeline.phases
    selections = [selected_pairs(phase) for phase in phases]
    found: list[Section] = []
    places: dict[Pair, int] = {}
    for phase, selection in zip(phases, selections, strict=True):
        _add(found, places, phase, selection, None)
    if phases[0].case.clock.slack > 0.0:
        for one, other in itertools.product(phases, repeat=2):
            for clocks in _clock_pairs(one.case, selections):
                _add(
                    found, places, one, selected_pairs(_mixed(one, other, clocks[1])), other, clocks
                )
    if not places:
        raise nothing_to_measure()
    measured = {section.phase.first for section in found}
    return SectionPlan(
        tuple(places),
        tuple(found),
        tuple(dict.fromkeys(one for selection in selections for one in selection.unmeasured)),
        tuple(phase for phase in phases if phase.first not in measured),
    )


def _add(
    found: list[Section],
    places: dict[Pair, int],
    phase: Phase,
    selection: Selection,
    other: Phase | None,
    clocks: tuple[int, int] | None = None,
) -> None:
    """Adds the sections of a selection whose pairs are tied, or are of two clocks that are not."""
    if other is not None and _time_gap(phase, other) > phase.case.clock.slack:
        return
    for (rule, padding), alike in selection.alike.items():
        pairs = _of_clocks(phase.case, alike, clocks)
        if not pairs:
            continue
        numbered = len(found), phase, rule, padding, pairs
        found.append(Section(*numbered, _places_of(pairs, places), other))


def _places_of(pairs: tuple[Pair, ...], places: dict[Pair, int]) -> np.ndarray:
    """(p,) the place of each of some pairs; those that have none yet get the next ones."""
    if not places:
        places.update(zip(pairs, range(len(pairs)), strict=True))
        return np.arange(len(pairs))
    own = [places.setdefault(pair, len(places)) for pair in pairs]
    return np.array(own, dtype=np.int64)


def _of_clocks(
    case: Case, pairs: tuple[Pair, ...], clocks: tuple[int, int] | None
) -> tuple[Pair, ...]:
    """Those of some pairs that are of two clocks, or that are tied where none are given."""
    if case.clock.slack == 0.0:
        return pairs if clocks is None else ()
    return tuple(pair for pair in pairs if clock_pair(case, pair.a, pair.b) == clocks)


def _time_gap(phase: Phase, other: Phase) -> float:
    """[s] The gap between the times of two phases; 0 where they overlap."""
    return max(phase.span[0] - other.span[1], other.span[0] - phase.span[1], 0.0)


def _clock_pairs(case: Case, selections: Sequence[Selection]) -> list[tuple[int, int]]:
    """The two clocks of pairs that are not tied, each once."""
    every = (clock_pair(case, pair.a, pair.b) for one in selections for pair in one.pairs)
    return sorted({clocks for clocks in every if clocks is not None})


def _mixed(phase: Phase, other: Phase, clock: int) -> Phase:
    """A phase in which all that moves by one clock is as it is in another."""
    if other is phase:
        return phase
    things = {thing for thing, own in clocks_of(phase.case).items() if own == clock}
    names = {phase.case.obstacles[i].name for is_obstacle, i in things if is_obstacle}
    obstacles = tuple(
        theirs if here.name in names else here
        for here, theirs in zip(phase.case.obstacles, other.case.obstacles, strict=True)
    )
    robots = tuple(
        theirs if (False, i) in things else here
        for i, (here, theirs) in enumerate(zip(phase.case.robots, other.case.robots, strict=True))
    )
    carried = {part: c for part, c in phase.carried.items() if part not in names}
    carried |= {part: c for part, c in other.carried.items() if part in names}
    return replace(
        phase,
        case=replace(phase.case, robots=robots, obstacles=obstacles),
        carried=carried,
        absent_robots=_absent(phase.absent_robots, other.absent_robots, things, of_obstacles=False),
        absent_obstacles=_absent(
            phase.absent_obstacles, other.absent_obstacles, things, of_obstacles=True
        ),
    )


def _absent(
    here: frozenset[int],
    there: frozenset[int],
    things: set[tuple[bool, int]],
    *,
    of_obstacles: bool,
) -> frozenset[int]:
    own = {i for is_obstacle, i in things if is_obstacle is of_obstacles}
    return frozenset((here - own) | (there & own))


@dataclass(frozen=True, eq=False)
class SectionAnswer:
    """What was found of a section; pairs and steps are the section's own, distances without padding."""

    section: Section
    found: MeasuredSteps
    certificate: ProvenMotion | None
