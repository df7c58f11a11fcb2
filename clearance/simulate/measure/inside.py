"""Notices of links that may be inside an obstacle, or round one, whose surface is too open to tell.

The clearance of such a pair is that of its surfaces: it may be that of a robot that runs inside a solid. Not for:
pairs where a winding number decides (`kernels.search.containment`); those are in contact in the rows themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.compile.calls import Written
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.motion.boxes_along_path import (
    CarriedBoxes,
    overlaps_at_positions,
    steps_together,
)
from clearance.kernels.motion.kinematics import Links
from clearance.query.distance import distance
from clearance.query.inside import PossibleContainment, doubt_of
from clearance.simulate.measure.sections import Section, SectionPlan
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.forest import forest_of, link_poses_at
from clearance.world.notice import Notice, Severity
from clearance.world.pairs import BodyIndex, Pair

AT_ONCE = 1024
"""Steps whose poses are checked together."""

FEWER = "close the mesh, or accept: [inside] in the case if it is hollow"


def notices(plan: SectionPlan) -> tuple[Notice, ...]:
    """One notice for each pair of which it is open at some step whether one body is inside the other."""
    found: dict[int, Notice] = {}
    for section in plan.sections:
        if section.other not in (None, section.phase):
            continue  # what is disjoint at one time, and at all pairs of times, is inside at none
        for place, notice in _of_section(section):
            found.setdefault(place, notice)
    return tuple(notice for _, notice in sorted(found.items()))


def _of_section(section: Section) -> Iterator[tuple[int, Notice]]:
    """The same of a section, each with the place of the pair in the run."""
    case, motions, pairs = section.phase.case, section.phase.motions, section.pairs
    open_pairs = _open_pairs(case, pairs)
    waiting = dict(enumerate(open_pairs.places))
    for start in range(0, section.phase.n_steps if waiting else 0, AT_ONCE):
        link_poses = link_poses_at(case, motions, slice(start, start + AT_ONCE))
        poses = BodyPoses(case, link_poses)
        for k, span in open_pairs.spans(link_poses):
            if k not in waiting:
                continue
            place = waiting[k]
            pair, doubt = pairs[place], open_pairs.doubts[k]
            step = next(_in_doubt(case, pair, doubt, poses, span, along_a_way=True), None)
            if step is not None:
                step += start
                when = float(section.phase.times[step])
                one, other = (body.name_in(case) for body in pair)
                text = _text(one, other, step + section.phase.first, when)
                yield int(section.places[place]), Notice(Severity.SUSPECT, "inside", text)
                del waiting[k]


@dataclass(frozen=True)
class _OpenPairs:
    """Pairs of which something can be in doubt.

    Attributes:
        places: of them among all pairs. doubts: of each, what can be.
        boxes: of their bodies. pairs: (k, 2) of these bodies.
    """

    places: tuple[int, ...]
    doubts: tuple[PossibleContainment, ...]
    boxes: CarriedBoxes
    pairs: np.ndarray

    def spans(self, link_poses: np.ndarray) -> Iterator[tuple[int, slice]]:
        """The pairs, by number, whose boxes may overlap at some step, and from which step to which.

        Args:
            link_poses: (n, links, 4, 4) `world_from_link` [m] of the case's forest.
        """
        spans = np.empty((len(self.pairs), 2), dtype=np.int64)
        steps_together(self.boxes, self.pairs, link_poses, spans)
        for k, (first, end) in enumerate(spans.tolist()):
            if end:
                yield k, slice(first, end)


def _open_pairs(case: Case, pairs: Sequence[Pair]) -> _OpenPairs:
    return _found_open(case, tuple(pairs))


@once_a_cell(16)
def _found_open(case: Case, pairs: tuple[Pair, ...]) -> _OpenPairs:
    all_doubts = {i: doubt_of(*_shapes(case, pair)) for i, pair in enumerate(pairs)}
    doubts = {i: doubt for i, doubt in all_doubts.items() if doubt is not None}
    bodies = sorted({body for i in doubts for body in pairs[i]})
    number = {body: k for k, body in enumerate(bodies)}
    standing = [
        case.obstacles[body.i_body].world_from_body if body.is_obstacle else np.eye(4)
        for body in bodies
    ]
    boxes = CarriedBoxes(
        np.array([body.shape_in(case).bounds for body in bodies]).reshape(-1, 2, 3),
        np.array([body.frame_in(case) for body in bodies], dtype=np.int64),
        np.array(standing).reshape(-1, 4, 4),
    )
    of_bodies = [[number[body] for body in pairs[i]] for i in doubts]
    numbered = np.array(of_bodies, dtype=np.int64).reshape(-1, 2)
    return _OpenPairs(tuple(doubts), tuple(doubts.values()), boxes, numbered)


class DoubtfulPairs:
    """The pairs of a case that can be in doubt, asked about at any positions of all that moves.

    A pair whose boxes do not overlap is in no doubt; only others are checked. For one thread at a time.
    """

    def __init__(self, case: Case, pairs: Sequence[Pair]) -> None:
        self._case, self._pairs, self._open = case, pairs, _open_pairs(case, pairs)
        self._inputs = forest_of(case).links, self._open.boxes, self._open.pairs
        self._written = Written(self._inputs[0], Links), Written(self._inputs[1], CarriedBoxes)
        self._for_one: tuple[np.ndarray, tuple[np.ndarray, np.ndarray], Callable] | None = None

    def at(self, positions: np.ndarray) -> Sequence[tuple[int, int]]:
        """The place of a pair and the row, wherever a pair is in doubt and not in contact.

        Args:
            positions: (n, columns) [rad or m] as `world.forest` has its columns.
        """
        if not self._open.places:
            return ()
        (poses, spans), count = self._asked(positions)
        if count() == 0:
            return ()
        return list(self._in_doubt(BodyPoses(self._case, poses), spans.tolist()))

    def _asked(
        self, positions: np.ndarray
    ) -> tuple[tuple[np.ndarray, np.ndarray], Callable[[], int]]:
        """The arrays that a question fills, and the question; that of one position is cached for its array."""
        if self._for_one is not None and self._for_one[0] is positions:
            return self._for_one[1:]
        arrays = self._new_arrays(len(positions))
        ask = overlaps_at_positions.prepared(*self._written, self._inputs[2], positions, *arrays)
        if len(positions) == 1:
            self._for_one = positions, arrays, ask
        return arrays, ask

    def _new_arrays(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Arrays for the poses of all links at n positions, and for a span of each pair."""
        links, _, pairs = self._inputs
        poses = np.empty((n, len(links.parents), 4, 4))
        return poses, np.empty((len(pairs), 2), dtype=np.int64)

    def _in_doubt(
        self, poses: BodyPoses, spans: Sequence[Sequence[int]]
    ) -> Iterator[tuple[int, int]]:
        of_pairs = zip(self._open.places, self._open.doubts, spans, strict=True)
        for place, doubt, (first, end) in of_pairs:
            if end:
                span = slice(first, end)
                for row in _in_doubt(self._case, self._pairs[place], doubt, poses, span):
                    yield place, row


def _text(link: str, obstacle: str, step: int, time: float) -> str:
    return (
        f"link {link} may be inside obstacle {obstacle}, or round it, at {time:.3f} s (step {step}): the surface "
        "has holes, cracks or two sides, so inside and outside cannot be distinguished there. The clearance is "
        f"that of the surfaces alone; {FEWER}"
    )


def _shapes(case: Case, pair: Pair) -> tuple[Polyhedron, Polyhedron]:
    return pair.a.shape_in(case), pair.b.shape_in(case)


class BodyPoses:
    """The poses of bodies at some steps, each worked out once.

    Args:
        link_poses: (n, links, 4, 4) `world_from_link` [m] of the case's forest.
    """

    def __init__(self, case: Case, link_poses: np.ndarray) -> None:
        self._case, self._link_poses = case, link_poses
        self._of: dict[BodyIndex, np.ndarray] = {}

    def of(self, body: BodyIndex) -> np.ndarray:
        """(n, 4, 4) `world_from_body` [m]."""
        if body not in self._of:
            self._of[body] = body.poses_in(self._case, self._link_poses)
        return self._of[body]


def _in_doubt(
    case: Case,
    pair: Pair,
    doubt: PossibleContainment,
    poses: BodyPoses,
    span: slice,
    along_a_way: bool = False,
) -> Iterator[int]:
    """The steps of some, of which `poses` are given, at which a pair is in doubt and not in contact."""
    of_one, of_other = poses.of(pair.a)[span], poses.of(pair.b)[span]
    open_at = doubt.at(of_one, of_other, along_a_way)
    if not open_at.any():
        return
    one, other = _shapes(case, pair)
    for k in np.flatnonzero(open_at):
        if not distance(one, other, pose_a=of_one[k], pose_b=of_other[k]).contact:
            yield int(k) + span.start
