"""Parts that touch something as they are picked up or let go: hints, with the row that would excuse it.

A part stands on something before it is picked up, and fingers hold it before they carry it. That contact is real,
and it is meant. Not for: pairs that touch all the time (`standing`).
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadInput
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import inverse
from clearance.query.distance import distance
from clearance.record.record import Record
from clearance.simulate.measure.sections import Section, SectionPlan, section_plan
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.forest import (
    forest_of,
    link_poses_at,
    positions_along,
)
from clearance.world.pairs import Pair
from clearance.world.timing import time_text

TOUCHING = 1e-6
"""[m] What stands on something touches it, whichever way rounding goes."""

FAR = 1.0
"""[m] Balls with more than this between them need no search: no limit is so wide that it would matter here."""

MOST_STEPS = 2000
"""Most steps before and after that are checked for the end of a contact."""

FINE, MOST_SHARES = 2e-3, 128
"""[m] Between steps a contact is followed so finely, in at most so many parts of an interval."""

ALIKE = 1e-3
"""[m] Contact that is deeper by no more than this is the touching that is meant."""


@dataclass(frozen=True)
class HandlingHint:
    """A part that touches a body as it changes hands.

    Attributes:
        when: in words. start, end: [s] from when until when the pair is to be excused, so that no moment is left
            at which it touches or is below its fail limit; None for the run's own ends.
        is_deeper: in that contact they are, or may be, deeper in each other than then. No row excuses that.
    """

    part: str
    mate: str
    when: str
    start: float | None
    end: float | None
    is_deeper: bool = False

    @property
    def pair(self) -> frozenset[str]:
        """The names of the two."""
        return frozenset((self.part, self.mate))

    @property
    def row(self) -> str:
        """The row of `allow` that excuses it."""
        fields = [f"between: {json.dumps([self.part, self.mate], ensure_ascii=False)}"]
        fields += [] if self.start is None else [f"from: {self.start!r}"]
        fields += [] if self.end is None else [f"until: {self.end!r}"]
        return f"{{{', '.join(fields)}}}"

    def __str__(self) -> str:
        deeper = (
            ", but is or may be deeper in it before or after: check that" if self.is_deeper else ""
        )
        return f"{self.part} touches {self.mate} when it is {self.when}{deeper}"


def handling_hints(record: Record) -> list[HandlingHint]:
    """One hint for each stretch of contact of a part that it is picked up in or let go in, in order of time."""
    found: dict[tuple[frozenset[str], float | None], HandlingHint] = {}
    if not record.case.carries:
        return []
    plan = section_plan(record.timeline)
    for time, carry, what in _changes(record):
        step = int(np.searchsorted(record.timeline.times, time))
        for hint in _at_change(record, plan, carry, step, f"{what} at {time_text(time)} s"):
            found.setdefault((hint.pair, hint.start), hint)
    return list(found.values())


def _changes(record: Record) -> list[tuple[float, Carry, str]]:
    """When [s] a part is picked up or let go within the run."""
    times = record.timeline.times
    found = [
        (max(c.window.start, times[0]), c, f"picked up by {c.by}")  # from 0 s is from the beginning
        for c in record.case.carries
    ]
    found += [(c.window.end, c, f"let go by {c.by}") for c in record.case.carries]
    inside = [one for one in found if times[0] <= one[0] <= times[-1]]
    return sorted(inside, key=lambda one: one[0])


def _at_change(
    record: Record, plan: SectionPlan, carry: Carry, step: int, when: str
) -> Iterator[HandlingHint]:
    """What the part of a carry touches at a step."""
    case = record.case
    for pair in plan.pairs:
        names = pair.a.name_in(case), pair.b.name_in(case)
        if carry.part not in names:
            continue
        gaps = _PairGaps(record, plan, pair)
        if not gaps.touches_at(step):
            continue
        mate = names[0] if names[1] == carry.part else names[1]
        try:
            yield HandlingHint(carry.part, mate, when, *gaps.stretch(step))
        except _Deeper:
            time = float(record.timeline.times[step])
            yield HandlingHint(carry.part, mate, when, time, time, is_deeper=True)


@dataclass(frozen=True, eq=False)
class _PairGaps:
    """The distance of two bodies at the steps at which they are measured."""

    record: Record
    plan: SectionPlan
    pair: Pair

    @cached_property
    def sections(self) -> list[Section]:
        """Those that measure the pair, in order of time."""
        own = [section for section in self.plan.sections if self.pair in section.pairs]
        return sorted(own, key=lambda section: section.phase.first)

    def touches_at(self, step: int) -> bool:
        """True if they touch at a step at which they are measured."""
        around = [s for s in self.sections if s.phase.first <= step <= s.phase.last]
        return any(self._gap(section, step) <= TOUCHING for section in around)

    def stretch(self, step: int) -> tuple[float | None, float | None]:
        """[s] The nearest times around a step at which they are clear of each other, or are not measured.

        Raises:
            _Deeper: in between they are deeper in each other than at the step.
        """
        return self._walk(step, -1), self._walk(step, 1)

    def _walk(self, step: int, way: int) -> float | None:
        times = self.record.timeline.times
        end = 0 if way < 0 else len(times) - 1
        held: _Placed | None = None
        for _ in range(MOST_STEPS):
            section = self._towards(step, way)
            if step == end:
                return None
            if section is None:
                return float(times[step])
            own = step - section.phase.first
            held = (
                held or self._placed(section, min(own, own + way), np.array([1.0 * (way < 0)]))[0]
            )
            for share, placed in self._along(section, own, way):
                gap = placed.gap
                if gap > TOUCHING and not section.limits.below(gap, section.limits.fail):
                    return _time(times[step], times[step + way], share)
                if gap <= TOUCHING and placed.is_deeper_than(held):
                    raise _Deeper
            step += way
        return float(times[step])

    def _towards(self, step: int, way: int) -> Section | None:
        """The section that measures the pair from a step to the next one that way."""
        low, high = sorted((step, step + way))
        own = (s for s in self.sections if s.phase.first <= low and high <= s.phase.last)
        return next(own, None)

    def _along(self, section: Section, own: int, way: int) -> Iterator[tuple[float, _Placed]]:
        """The shares of the way from one of a section's steps to the next, and the bodies there."""
        low = min(own, own + way)
        ends = self._placed(section, low, np.array([0.0, 1.0]))
        n = int(np.clip(np.ceil(ends[0].moved_to(ends[1]) / FINE), 1, MOST_SHARES))
        shares = np.arange(1, n + 1) / n
        for share in shares:
            (placed,) = self._placed(section, low, np.array([share if way > 0 else 1.0 - share]))
            yield float(share), placed

    def _gap(self, section: Section, step: int) -> float:
        """[m] at one of a section's steps, without paddings."""
        case, own = section.phase.case, step - section.phase.first
        return self._at(case, link_poses_at(case, section.phase.motions, slice(own, own + 1)))[
            0
        ].gap

    def _placed(self, section: Section, own: int, shares: np.ndarray) -> list[_Placed]:
        """The bodies when shares of the interval after one of a section's steps have passed."""
        case = section.phase.case
        positions = positions_along(case, section.phase.motions, own, shares)
        return self._at(case, forest_of(case).poses(positions))

    def _at(self, case: Case, poses: np.ndarray) -> list[_Placed]:
        a, b = self.pair.a, self.pair.b
        placed = zip(a.poses_in(case, poses), b.poses_in(case, poses), strict=True)
        return [_Placed(a.shape_in(case), b.shape_in(case), *one) for one in placed]


class _Deeper(Exception):
    """A part is deeper in its mate than as it changes hands."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """Two bodies at one moment, with (4, 4) poses [m]."""

    a: Polyhedron
    b: Polyhedron
    world_from_a: np.ndarray
    world_from_b: np.ndarray

    @cached_property
    def gap(self) -> float:
        """[m] Without paddings."""
        return gap_between(self.a, self.world_from_a, self.b, self.world_from_b)

    def is_deeper_than(self, other: _Placed) -> bool:
        """True if they are deeper in each other than at another moment by more than `ALIKE`, or may be so.

        Proof: no body gets deeper than the corners of its box go, as seen from the other body.
        """
        return self.moved_to(other) > ALIKE and not self._depth <= other._depth + ALIKE

    def moved_to(self, other: _Placed) -> float:
        """[m] How far the corners of a's box go to another moment, as seen from b."""
        corners = np.array([*itertools.product(*self.a.bounds.T)])
        here, there = (inverse(one.world_from_b) @ one.world_from_a for one in (self, other))
        turn, shift = (there - here)[:3, :3], (there - here)[:3, 3]
        return float(np.linalg.norm(corners @ turn.T + shift, axis=1).max())

    @cached_property
    def _depth(self) -> float:
        return depth_between(self.a, self.world_from_a, self.b, self.world_from_b)


def _time(here: float, there: float, share: float) -> float:
    """[s] When a share of the way has passed; between the two, to the next microsecond."""
    if share == 1.0:
        return float(there)
    outwards = math.ceil if there > here else math.floor
    return outwards(round((here + share * (there - here)) * 1e6, 3)) / 1e6


def depth_between(
    a: Polyhedron, world_from_a: np.ndarray, b: Polyhedron, world_from_b: np.ndarray
) -> float:
    """[m] An upper bound of how deep two bodies are in each other; NaN for bodies without an inside."""
    from clearance.query.contact import contact

    try:
        found = contact(a, b, pose_a=world_from_a, pose_b=world_from_b, rough=True, bounded=False)
    except BadInput:
        return np.nan
    return 0.0 if found is None else found.penetration


def gap_between(
    a: Polyhedron,
    world_from_a: np.ndarray,
    b: Polyhedron,
    world_from_b: np.ndarray,
    far: float = FAR,
) -> float:
    """[m] The distance of two bodies, or less of it where balls about their boxes are farther than `far`."""
    centres = [pose[:3, :3] @ shape.bounds.mean(axis=0) + pose[:3, 3]
               for shape, pose in ((a, world_from_a), (b, world_from_b))]  # fmt: skip
    radii = [np.linalg.norm(np.ptp(shape.bounds, axis=0)) / 2.0 for shape in (a, b)]
    between_balls = float(np.linalg.norm(centres[0] - centres[1]) - 1.001 * sum(radii))
    if between_balls > far:
        return between_balls
    return distance(a, b, pose_a=world_from_a, pose_b=world_from_b).distance
