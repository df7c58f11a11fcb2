"""Notices of links that may be inside an obstacle, or round one, whose surface is too open to tell.

The clearance of such a pair is that of its surfaces: it may be that of a robot that runs inside a solid. Not for:
pairs where a winding number decides (`kernels.search.containment`); those are in contact in the rows themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.query.distance import distance
from clearance.query.inside import Doubt, doubt_of
from clearance.simulate.names import pair_names
from clearance.simulate.sections import Section, SectionPlan
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.forest import link_poses_at
from clearance.world.notice import Notice, Severity
from clearance.world.pairs import BodyIndex, Pair

AT_ONCE = 1024
"""Steps whose poses are looked at together."""

FEWER = "close the mesh, or accept: [inside] in the case if it is hollow"


def notices(plan: SectionPlan) -> tuple[Notice, ...]:
    """One notice for each pair of which it is open at some step whether one body is inside the other."""
    found: dict[int, Notice] = {}
    for section in plan.sections:
        if section.other not in (None, section.phase):
            continue  # what is apart at one time, and at all pairs of times, is inside at none
        for place, notice in _of_section(section):
            found.setdefault(place, notice)
    return tuple(notice for _, notice in sorted(found.items()))


def _of_section(section: Section) -> Iterator[tuple[int, Notice]]:
    """The same of a section, each with the place of the pair in the run."""
    case, motions, pairs = section.phase.case, section.phase.motions, section.pairs
    names = pair_names(case, pairs)
    waiting = doubts_of(case, pairs)
    for start in range(0, section.phase.n_steps if waiting else 0, AT_ONCE):
        poses = BodyPoses(case, link_poses_at(case, motions, slice(start, start + AT_ONCE)))
        for i, doubt in list(waiting.items()):
            step = _first_in_doubt(case, pairs[i], doubt, poses)
            if step is not None:
                step += start
                when = float(section.phase.times[step])
                text = _text(names[0][i], names[1][i], step + section.phase.first, when)
                yield int(section.places[i]), Notice(Severity.SUSPECT, "inside", text)
                del waiting[i]


def doubts_of(case: Case, pairs: Sequence[Pair]) -> dict[int, Doubt]:
    """What can be in doubt, by the pairs of which something can be."""
    return dict(_doubts_of(case, tuple(pairs)))


@once_a_cell(16)
def _doubts_of(case: Case, pairs: tuple[Pair, ...]) -> dict[int, Doubt]:
    doubts = {i: doubt_of(*_shapes(case, pair)) for i, pair in enumerate(pairs)}
    return {i: doubt for i, doubt in doubts.items() if doubt is not None}


def is_in_doubt(case: Case, pair: Pair, doubt: Doubt, poses: np.ndarray) -> np.ndarray:
    """(n,) whether a pair is in doubt and not in contact, at `poses` (n, links, 4, 4) of all links."""
    found = np.zeros(len(poses), dtype=bool)
    for k in _in_doubt(case, pair, doubt, BodyPoses(case, poses)):
        found[k] = True
    return found


def _text(link: str, obstacle: str, step: int, time: float) -> str:
    return (
        f"link {link} may be inside obstacle {obstacle}, or round it, at {time:.3f} s (step {step}): the surface "
        "has holes, cracks or two sides, so that inside and outside cannot be told there, and the clearance is "
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


def _first_in_doubt(case: Case, pair: Pair, doubt: Doubt, poses: BodyPoses) -> int | None:
    """The first of the steps, of which `poses` are given, at which a pair is in doubt and not in contact."""
    return next(_in_doubt(case, pair, doubt, poses, along_a_way=True), None)


def _in_doubt(
    case: Case, pair: Pair, doubt: Doubt, poses: BodyPoses, along_a_way: bool = False
) -> Iterator[int]:
    of_one, of_other = poses.of(pair.a), poses.of(pair.b)
    open_at = doubt.at(of_one, of_other, along_a_way)
    if not open_at.any():
        return
    one, other = _shapes(case, pair)
    for k in np.flatnonzero(open_at):
        if not distance(one, other, pose_a=of_one[k], pose_b=of_other[k]).contact:
            yield int(k)
