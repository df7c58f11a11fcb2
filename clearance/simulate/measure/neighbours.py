"""Links that one joint joins, apart at first, that meet later: they are excused, since most touch all the time.

Not for: pairs that are measured, and pairs that an SRDF excuses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.query.pair_query import Query
from clearance.world.case import PlacedRobot
from clearance.world.extents import metres
from clearance.world.forest import link_poses_at
from clearance.world.notice import Notice, Severity
from clearance.world.pairs import BodyIndex
from clearance.world.phase import Phase
from clearance.world.self_pairs import neighbours

APART = 5e-3
"""[m] Links that are nearer than this at first are joined there: they may touch as the joint turns."""


def neighbours_that_meet(phases: Sequence[Phase]) -> Iterator[Notice]:
    """A warning on each pair of neighbours that are apart at the first step, and touch at a later one."""
    for i, placed in enumerate(phases[0].case.robots):
        for a, b in _excused(placed):
            pair = BodyIndex(i, a), BodyIndex(i, b)
            first = float(_distances(phases[0], pair, slice(0, 1))[0])
            time = _first_contact(phases, pair) if first > APART else None
            if time is not None:
                names = " - ".join(body.name_in(phases[0].case) for body in pair)
                text = (
                    f"neighbours {names}, {metres(first)} m apart at first, touch at {time:.3f} s: such pairs are "
                    "not measured; an SRDF that does not excuse them has them measured"
                )
                yield Notice(Severity.WARNING, "neighbours", text)


def _excused(placed: PlacedRobot) -> Iterator[tuple[int, int]]:
    """The pairs of bodies that are excused as neighbours, and by nothing else."""
    asked = placed.self_clearance
    if asked is None or asked.matrix is not None or placed.robot.own_matrix is not None:
        return
    number = {body.name: k for k, body in enumerate(placed.robot.bodies)}
    for pair in neighbours(placed.robot):
        if pair.isdisjoint(placed.exclude_links):
            a, b = sorted(number[name] for name in pair)
            yield a, b


def _distances(phase: Phase, pair: tuple[BodyIndex, BodyIndex], steps: slice) -> np.ndarray:
    """(n,) [m] at steps of a phase."""
    poses = link_poses_at(phase.case, phase.motions, steps)
    a, b = (np.array(body.poses_in(phase.case, poses)) for body in pair)
    query = Query(*(body.shape_in(phase.case) for body in pair))
    return np.asarray(query.distances(a, b).distances)


def _first_contact(phases: Sequence[Phase], pair: tuple[BodyIndex, BodyIndex]) -> float | None:
    """[s] The first step at which a pair touches."""
    for phase in phases:
        touching = np.flatnonzero(_distances(phase, pair, slice(0, phase.n_steps)) <= 0.0)
        if len(touching):
            return float(phase.times[touching[0]])
    return None
