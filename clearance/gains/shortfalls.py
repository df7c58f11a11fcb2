"""What a case falls short of, and how that changes with what may be changed: linear rows about where it is.

Not for: what may be changed (`shift`, `offsets`), nor by how much it then is (`search`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.findings.of_rule import code_of
from clearance.record.certificate import motion_codes
from clearance.record.record import Record
from clearance.record.status import STATUSES, Status
from clearance.run import Question, Run, answer
from clearance.simulate.answers.approaches import Approach, OfPair, approaches
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.knots import knots_of
from clearance.world.placed_robot import PlacedRobot
from clearance.world.rules import Rule
from clearance.world.timeline import Timeline

VIOLATED = STATUSES.index(Status.VIOLATED)

MORE = 4e-7
"""[m] What is wanted beyond, at least, where a motion is not proven: less would be at what counts as kept."""

TOUCHING = CERTIFY_GAP
"""[m] What is wanted beyond, at least, where bodies touch between two steps."""

Gradient = Callable[[Approach, Timeline | None], np.ndarray | None]
"""(k, m) [m] what the clearances of an approach grow by for each unit of the m variables; None for nothing.

With the run's timeline that of parts that change hands as well."""

SAME = 1e-9
"""[s] Times that are less apart are of one step."""

MOMENTS = 7
"""Of each interval that is looked into."""

OF_CASE = ("near", "_holds", "_extra")
"""What a state knows of its case alone, whatever its variables are."""

MOST_INTERVALS = 32
"""That are looked into at a time, those that fall short by most."""


class Rows(NamedTuple):
    """Clearances of pairs at steps, and what each grows by.

    Attributes:
        missing: (k,) [m] how far each is below what is wanted; negative above it.
        gradients: (k, m) [m per unit of a variable].
    """

    missing: np.ndarray
    gradients: np.ndarray


@dataclass(frozen=True)
class Requirement:
    """What a case is to keep.

    Attributes:
        margin: [m] above the fail limit of each rule. beyond: [m] that is to cover rounding.
        extra: (n,) [m] beyond that at each step, so that the motion between them keeps it too. times: (n,) [s] of
            these steps.
        moments: (k,) [s] times between them that are steps as well. more: (k,) [m] beyond at these.
    """

    margin: float
    beyond: float
    extra: np.ndarray
    times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    moments: np.ndarray = field(default_factory=lambda: np.zeros(0))
    more: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def extra_at(self, times: np.ndarray) -> np.ndarray:
        """(n,) [m] beyond what is wanted at steps (n,) [s]."""
        found = np.zeros(len(times))
        for own, extra in ((self.times, self.extra), (self.moments, self.more)):
            if len(own):
                place = np.clip(np.searchsorted(own, times - SAME), 0, len(own) - 1)
                found = np.where(np.abs(own[place] - times) <= SAME, extra[place], found)
        return found


@dataclass(frozen=True, eq=False)
class State:
    """A case as it was measured, with what comes near.

    Attributes:
        x: (m,) the variables that it is made of. beyond: [m] above what is wanted, what counts as near.
        other_rows: what is kept beside clearances; None for nothing.
        moved: the pairs that are looked at, those that the change may move; None for all.
        bounded: depths are bounded from below as well.
    """

    x: np.ndarray
    case: Case
    run: Run
    beyond: float
    wanted: Requirement
    other_rows: Rows | None = None
    moved: OfPair | None = None
    bounded: bool = False

    @property
    def record(self) -> Record:
        """What was measured."""
        return self.run.record

    @cached_property
    def near(self) -> Sequence[Approach]:
        """All that comes near, at the steps."""
        extra = float(self._extra.max(initial=0.0))
        within = self.margin + self.wanted.beyond + extra + self.beyond
        return [*approaches(self.run.session.rules, within, self.moved, bounded=self.bounded)]

    @property
    def touches(self) -> bool:
        """True if bodies are in contact at a step."""
        return self.record.nearest.touches

    @property
    def margin(self) -> float:
        """[m] Above the fail limit of each rule."""
        return self.wanted.margin

    @cached_property
    def worst(self) -> float:
        """[m] How far the worst pair, or what else is kept, is below what is wanted; 0 where none is."""
        found = [0.0]
        if not self._holds:
            found += [float(self.missing(one).max(initial=0.0)) for one in self.near]
        if self.other_rows is not None:
            found.append(float(self.other_rows.missing.max(initial=0.0)))
        return max(found)

    @cached_property
    def _holds(self) -> bool:
        """True if the nearest pair of each step has what is wanted, so that no other need be looked at."""
        wanted = self.wanted.margin + self.wanted.beyond + self._extra
        return not any(
            rule.limits.below(rule.measurement.clearance, rule.limits.fail + wanted).any()
            for rule in self.record.rules
        )

    def about(self, x: np.ndarray, other_rows: Rows | None) -> State:
        """The same case as it is, about other variables (m,), of which none changes it.

        Args:
            other_rows: what is kept beside clearances, of these variables.
        """
        again = replace(self, x=x, other_rows=other_rows)
        vars(again).update({name: one for name, one in vars(self).items() if name in OF_CASE})
        return again

    def seen_within(self, beyond: float) -> State:
        """The same with what comes near within `beyond` [m], where nothing has been looked at yet."""
        return self if "near" in vars(self) else replace(self, beyond=beyond)

    def missing(self, approach: Approach) -> np.ndarray:
        """(k,) [m] how far an approach is below what is wanted; negative above it."""
        level = approach.rule.limits.least_kept + self.wanted.margin + self.wanted.beyond
        return level + self._extra[approach.steps] - approach.clearances

    @cached_property
    def _extra(self) -> np.ndarray:
        return self.wanted.extra_at(self.record.motions[0].times)

    def rows(self, gradient: Gradient) -> Rows:
        """All that is near, and what it grows by; what nothing changes is left out where it is kept."""
        missing, gradients = [np.empty(0)], [np.empty((0, len(self.x)))]
        for approach in self.near:
            found = gradient(approach, self.record.timeline)
            own = self.missing(approach)
            if found is None:
                found = np.zeros((len(own), len(self.x)))
            counted = (own > self.wanted.beyond) | found.any(axis=1)
            missing.append(own[counted])
            gradients.append(found[counted])
        if self.other_rows is not None:
            missing.append(self.other_rows.missing)
            gradients.append(self.other_rows.gradients)
        return Rows(np.concatenate(missing), np.concatenate(gradients))


def measured(
    case: Case, x: np.ndarray, wanted: Requirement, beyond: float, moved: OfPair | None = None
) -> State:
    """A case with all that comes within `beyond` [m] of what is wanted, at its steps and the moments wanted.

    No verdict is read of it: whether bodies of open meshes may be inside others is told of what is proposed.

    Args:
        moved: the pairs that are looked at; None for all.
    """
    finer = with_moments(case, wanted.moments)
    run = answer(Question(finer, certify=False, contact="none", inside=False))
    return State(x, case, run, beyond, wanted, moved=moved)


def proven(case: Case, margin: float, gap: float = CERTIFY_GAP) -> Record:
    """The certified record of a case whose fail limits are raised by a margin [m].

    Args:
        gap: [m] how far a bound may be below a distance that occurs, where the limit is not kept.
    """
    raised = replace(case, limits=_raised(case.limits, margin))
    asked = Question(raised, certify=True, contact="none", certify_gap=gap, inside=False)
    return answer(asked).record


def keeps(record: Record) -> bool:
    """True if every rule is proven to hold at all times."""
    return all(code_of(rule) < VIOLATED for rule in record.rules)


def raised(
    wanted: Requirement, record: Record, spared: Sequence[int] | np.ndarray = ()
) -> Requirement:
    """What is wanted, with more at both ends of each motion that is not proven, and at the moments in it.

    Where bodies touch between two steps the certificate does not say how deep: three times as much is wanted.

    Args:
        spared: steps after which no more is wanted.
    """
    times = record.motions[0].times
    before = wanted.extra_at(times)
    short = short_of(record)
    again = np.maximum(2.0 * np.maximum(before, np.append(before[1:], 0.0)), TOUCHING)
    short = np.where(_touching(record), np.maximum(short, again), short)
    short = np.where(short > 0.0, np.maximum(short, MORE), 0.0)
    short[np.asarray(spared, dtype=np.int64)] = 0.0
    extra = before + np.maximum(short, np.append(0.0, short[:-1]))
    more = wanted.more + short[intervals(times, wanted.moments)]
    return replace(wanted, extra=extra, times=times, more=more)


def with_moments_within(wanted: Requirement, record: Record) -> Requirement:
    """What is wanted, at moments too in the motions that are farthest from being proven."""
    times, short = record.motions[0].times, short_of(record)
    short[intervals(times, wanted.moments)] = 0.0
    chosen = np.argsort(-short, kind="stable")[:MOST_INTERVALS]
    chosen = np.sort(chosen[(short[chosen] > 0.0) & (chosen < len(times) - 1)])
    shares = np.arange(1, MOMENTS + 1) / (MOMENTS + 1)
    new = (times[chosen, None] + np.diff(times)[chosen, None] * shares).ravel()
    return with_new_moments(wanted, new)


def with_new_moments(wanted: Requirement, new: np.ndarray) -> Requirement:
    """What is wanted, at more moments (k,) [s] too."""
    order = np.argsort(np.concatenate([wanted.moments, new]), kind="stable")
    moments = np.concatenate([wanted.moments, new])[order]
    more = np.concatenate([wanted.more, np.zeros(len(new))])[order]
    return replace(wanted, moments=moments, more=more)


def intervals(times: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """(k,) the step after which each moment is."""
    return np.asarray(np.searchsorted(times, moments, side="right") - 1)


def _unproven(record: Record) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Of each rule the steps after which the motion is not proven, what of it is [m], and the fail limit [m]."""
    for rule in record.rules:
        if rule.certificate is None:
            continue
        codes = motion_codes(rule.certificate, rule.limits, slice(None))
        steps = np.flatnonzero(codes >= VIOLATED)
        yield steps, rule.certificate.lower_bound[steps], rule.limits.fail


def short_of(record: Record) -> np.ndarray:
    """(n,) [m] how far the motion after each step is from being proven; 0 where it is."""
    short = np.zeros(len(record.motions[0].times))
    for steps, bound, fail in _unproven(record):
        np.maximum.at(short, steps, fail - bound + CERTIFY_GAP * 1e-3)
    return short


def _touching(record: Record) -> np.ndarray:
    """(n,) True where in the motion after a step contact is not ruled out."""
    touching = np.zeros(len(record.motions[0].times), dtype=bool)
    for steps, bound, _ in _unproven(record):
        touching[steps[bound <= 0.0]] = True
    return touching


def _raised(limits: Limits, margin: float) -> Limits:
    """Limits with fail levels that are higher by a margin [m], and warn levels that are not below them."""
    fail = limits.fail + margin
    rules = tuple(
        rule if rule.fail is None and rule.warn is None else _raised_rule(rule, margin, fail)
        for rule in limits.rules
    )
    return replace(limits, fail=fail, warn=max(limits.warn, fail), rules=rules)


def _raised_rule(rule: Rule, margin: float, fail: float) -> Rule:
    own = fail if rule.fail is None else rule.fail + margin
    warn = None if rule.warn is None else max(rule.warn, own)
    return replace(rule, fail=None if rule.fail is None else own, warn=warn)


def with_moments(case: Case, moments: np.ndarray) -> Case:
    """The case with steps at some times (k,) [s of the run] too, as far as the path of a robot reaches.

    Exactness: the new samples lie on the old lines and cubics within rounding.
    """
    if not len(moments):
        return case
    robots = list(case.robots)
    for i, placed in enumerate(robots):
        if (
            placed.trajectory is None
            or placed.given_trajectory.n_steps < 2
            or placed.timing.after == "loop"
        ):
            continue
        start, end = placed.timing.run_times(placed.given_trajectory.times)[[0, -1]]
        own = moments[(moments > start) & (moments < end)]
        robots[i] = _with_samples(placed, placed.timing.table_times(own))
        moments = np.setdiff1d(moments, own)
    return replace(case, robots=tuple(robots))


def _with_samples(placed: PlacedRobot, times: np.ndarray) -> PlacedRobot:
    """The robot with samples at some more times of its table [s]."""
    asked = placed.given_trajectory
    more = np.setdiff1d(times, asked.times)
    order = np.argsort(np.concatenate([asked.times, more]), kind="stable")
    knots, velocities = knots_of(asked.times, asked.positions, asked.velocities), None
    if asked.velocities is not None:
        velocities = np.concatenate([asked.velocities, knots.rates_at(more)])[order]
    finer = replace(
        asked,
        times=np.concatenate([asked.times, more])[order],
        positions=np.concatenate([asked.positions, knots.values_at(more)])[order],
        velocities=velocities,
    )
    return replace(placed, trajectory=finer)
