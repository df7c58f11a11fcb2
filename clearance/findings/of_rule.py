"""The findings of one rule: pair by pair, and what of its limits is not proven.

A pair that breaks the rule has a finding for each occurrence, one that is only below the warn limit has one; where
nothing is below that, the nearest pair has one. Not for: profiles and joints (`of_record`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from clearance.findings.finding import CLEARANCE, UNPROVEN, Finding, FindingName
from clearance.findings.occurrences import NearCourse, release_level
from clearance.record.certificate import Certificate, contact_is_open, motion_codes
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.rule_answer import NearRows, RuleAnswer
from clearance.record.session import Session
from clearance.record.status import STATUSES, Status, status_of
from clearance.world.case import Case, Limits


@dataclass(frozen=True, eq=False)
class RuleFindings:
    """The findings of a rule of a run; `alone` where the rule is told of one pair only."""

    session: Session
    rule: RuleAnswer
    alone: bool = False

    def __iter__(self) -> Iterator[Finding]:
        of_pairs = list(self._of_pairs()) if self._anything_near else []
        unproven = self._unproven(of_pairs)
        yield from of_pairs
        if unproven is not None:
            yield unproven
        elif not of_pairs:
            yield self._kept()

    @property
    def _anything_near(self) -> bool:
        """True if a pair is seen below the warn limit."""
        limits, worst = self.rule.limits, self.rule.worst
        if worst is None:
            return False
        return limits.below(worst.clearance, limits.warn) or worst.clearance <= 0.0

    def _of_pairs(self) -> Iterator[Finding]:
        """Those of pairs; each by itself where that can be proven, so that none is hidden by another."""
        level = release_level(self.rule.limits)
        answers = None if self.alone else self.session.alone(self.rule, level)
        if answers is None:
            yield from self._of_known_pairs()
            return
        for answer in answers:
            yield from RuleFindings(self.session, answer, alone=True)._of_known_pairs()

    def _of_known_pairs(self) -> Iterator[Finding]:
        limits = self.rule.limits
        for pair in sorted({*self._rows.pairs.tolist(), *self._seen_pairs.tolist()}):
            course = self._course(pair)
            stretches = course.broken(limits)
            if not stretches and limits.below(course.clearances, limits.warn).any():
                stretches = [course.nearest_stretch]
            for occurrence, part in enumerate(stretches):
                yield self._of_stretch(pair, course, part, occurrence)

    @cached_property
    def _rows(self) -> NearRows:
        """All pairs below the release level at each step."""
        return self.session.near(self.rule, release_level(self.rule.limits))

    @cached_property
    def _bridges(self) -> np.ndarray:
        """The positions of steps of which only the nearest pair is known."""
        return 2 * np.unique(self._rows.steps[self._rows.nearest_only])

    @cached_property
    def _between(self) -> np.ndarray:
        """(k,) the intervals in which a pair is seen below the release level nearer than at their ends."""
        certificate = self.rule.certificate
        if certificate is None:
            return np.empty(0, dtype=np.int64)
        near = certificate.upper_bound < release_level(self.rule.limits)
        return np.flatnonzero((certificate.pair >= 0) & near)

    @property
    def _seen_pairs(self) -> np.ndarray:
        certificate = self.rule.certificate
        return np.empty(0, np.int64) if certificate is None else certificate.pair[self._between]

    def _course(self, pair: int) -> NearCourse:
        rows, certificate = self._rows, self.rule.certificate
        own, intervals = rows.pairs == pair, self._between
        parts = [(2 * rows.steps[own], rows.clearances[own], rows.touching[own])]
        if certificate is not None:
            intervals = intervals[certificate.pair[intervals] == pair]
            upper = certificate.upper_bound[intervals]
            touching = certificate.touches(slice(None))[intervals]
            parts.append((2 * intervals + 1, upper, touching))
        if len(parts) == 1:  # in order as they are
            return NearCourse(*parts[0], self._bridges)
        positions, clearances, touching = (
            np.concatenate(column) for column in zip(*parts, strict=True)
        )
        order = np.argsort(positions)
        return NearCourse(positions[order], clearances[order], touching[order], self._bridges)

    def _of_stretch(self, pair: int, course: NearCourse, rows: slice, occurrence: int) -> Finding:
        place = course.worst(rows)
        moment = self._moment(pair, int(course.positions[place]))
        first, last = (int(p) for p in course.positions[[rows.start, rows.stop - 1]])
        return self._at(moment, first, last, occurrence)

    def _moment(self, pair: int, position: int) -> Moment:
        step = position // 2
        if position % 2:
            return self.session.moment_between(self.rule, step)
        return self.session.moment(self.rule, step, pair)

    def _at(self, moment: Moment, first: int, last: int, occurrence: int = 0) -> Finding:
        """A finding with its worst moment and its stretch, from one position to another."""
        start, end = self._span(moment.time, first, last)
        return self._named(
            CLEARANCE,
            (moment.link, moment.obstacle),
            occurrence,
            status=status_of(moment.clearance, self.rule.limits, moment.touches),
            proven=self._proven(slice(max(0, first // 2 - 1), last // 2 + 1)),
            start=start,
            end=end,
            first_step=first // 2,
            last_step=last // 2,
            **fields_at(self.session.record, moment),
        )

    def _span(self, time: float, first: int, last: int) -> tuple[float, float]:
        """[s] The stretch about a time: of the motion where that is proven, else from a position to another."""
        if self.alone:
            for start, end in self._released.tolist():
                if start <= time <= end:
                    return start, end
        times = self.session.record.motions[0].times
        return float(times[first // 2]), float(times[min(last // 2 + last % 2, len(times) - 1)])

    @cached_property
    def _released(self) -> np.ndarray:
        """(k, 2) [s] The stretches below the level at which an occurrence ends."""
        return self.session.spans_below(self.rule, release_level(self.rule.limits))

    def _proven(self, intervals: slice) -> float | None:
        """[m] What is proven of all pairs of the rule over some intervals."""
        certificate = self.rule.certificate
        return None if certificate is None else _least(certificate.lower_bound[intervals])

    def _unproven(self, of_pairs: list[Finding]) -> Finding | None:
        """The limit that is not proven between some steps, though nothing near there is seen below it."""
        certificate = self.rule.certificate
        if certificate is None:
            return None
        limits = self.rule.limits
        open_at = _not_reached(certificate, limits, limits.fail)
        for one in of_pairs:
            if one.broken and one.first_step is not None and one.last_step is not None:
                open_at[max(0, one.first_step - 1) : one.last_step + 1] = False
        if open_at.any():
            return self._of_open(certificate, np.flatnonzero(open_at), "violated")
        open_at = _not_reached(certificate, limits, limits.warn)
        if of_pairs or not open_at.any():
            return None
        return self._of_open(certificate, np.flatnonzero(open_at), "near")

    def _of_open(self, certificate: Certificate, open_at: np.ndarray, status: str) -> Finding:
        worst = int(open_at[np.argmin(certificate.lower_bound[open_at])])
        times = self.session.record.motions[0].times
        seen = certificate.upper_bound[worst]
        return self._named(
            UNPROVEN,
            status=status,
            clearance=_finite(seen),
            proven=_finite(certificate.lower_bound[worst]),
            time=float(times[worst]),
            step=worst,
            between=True,
            start=float(times[open_at[0]]),
            end=float(times[min(open_at[-1] + 1, len(times) - 1)]),
            first_step=int(open_at[0]),
            last_step=int(open_at[-1]),
            text=why_undecided(self.session.record.case),
        )

    def _kept(self) -> Finding:
        """The nearest pair of a rule that is kept, or no pair where nothing nearer was asked for."""
        moment = self.rule.worst
        if moment is None:
            return self._named(CLEARANCE, proven=self._all_proven)
        position = 2 * moment.step + int(moment.between)
        return replace(self._at(moment, position, position), proven=self._all_proven)

    @property
    def _all_proven(self) -> float | None:
        if self.rule.certificate is not None:
            return _least(self.rule.certificate.lower_bound)
        known = np.isnan(self.rule.measurement.clearance)
        return None if not known.all() else _least(self.rule.measurement.lower_bound)

    def _named(
        self, kind: str, bodies: tuple[str, ...] = (), occurrence: int = 0, **known: Any
    ) -> Finding:
        """A finding of the rule; where nothing is `known` of it, it is kept."""
        limits, record = self.rule.limits, self.session.record
        name = FindingName(record.case.name, kind, self.rule.name, bodies, occurrence)
        found = name.finding(fail=limits.fail, warn=limits.warn, **known)
        return found.with_moves(record.moves)


def fields_at(record: Record, moment: Moment) -> dict[str, Any]:
    """What a finding says of its worst moment: when and where that is, how near, and how the joints stand."""
    return {
        "clearance": float(moment.clearance),
        "time": float(moment.time),
        "time_b": moment.time_b,
        "step": int(moment.step),
        "between": moment.between,
        "point_a": _point(moment.point_link),
        "point_b": _point(moment.point_obstacle),
        "joints": _joints(record, moment),
    }


def _joints(record: Record, moment: Moment) -> dict[str, float]:
    """The positions [rad] or [m] of all moving joints at a moment; a robot's name before each where there are
    several."""
    found: dict[str, float] = {}
    for motion, positions in zip(record.motions, moment.positions, strict=True):
        before = record.case.prefix_of(motion.placed)
        names = [joint.name for joint in motion.placed.robot.moving_joints]
        found |= {f"{before}{name}": float(p) for name, p in zip(names, positions, strict=True)}
    return found


def _not_reached(certificate: Certificate, limits: Limits, level: float) -> np.ndarray:
    """(n,) True where the motion to the next step is not proven above a level [m] and not seen below it."""
    if level <= 0.0:
        return contact_is_open(certificate, limits)
    seen = limits.below(certificate.upper_bound, level)
    return limits.below(certificate.lower_bound, level) & ~seen


def _point(point: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in point)
    return x, y, z


def _least(bounds: np.ndarray) -> float | None:
    return _finite(bounds.min()) if len(bounds) else None


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def code_of(answer: RuleAnswer) -> int:
    """The index into `STATUSES` of the worst of a rule, at a step or, as far as proven, between two."""
    codes = [STATUSES.index(Status(answer.status))]
    if answer.certificate is not None:
        codes.append(int(motion_codes(answer.certificate, answer.limits, slice(None)).max()))
    return max(codes)


def why_undecided(case: Case) -> str:
    """Why a level is neither proven nor seen to be passed, and what helps."""
    if case.clock.slack > 0.0:
        return "a finer proof takes a smaller --certify-mm"
    return "undecided: the motion stays too close to the limit for the searches allowed"
