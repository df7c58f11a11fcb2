"""Measures a motion by the first paper's algorithm as published: every pair at every step, no bounds.

It is next to `measure` so that a whole run can be checked against it; its answers carry no guarantee.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from clearance.errors import NothingToMeasure
from clearance.progress import Progress
from clearance.query.paper import NO_TOLERANCE, distance_paper
from clearance.query.result import Nearest
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measured import MeasuredSteps, no_minima
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.pairs import Pair

CHUNK = 64
"""Steps whose poses are in memory at a time."""


def measure_paper(
    what: PairsInMotion,
    progress: Progress | None = None,
    tolerance: float = NO_TOLERANCE,
    first_step: int = 0,
) -> MeasuredSteps:
    """The paper's clearances of pairs in motion; those of pairs that its rules cut are infinite.

    Args:
        tolerance: [m] of rule 1. first_step: the step of the run that the motions begin with.

    Raises:
        NothingToMeasure: the rules cut every polygon pair of a step.
    """
    case, motions, pairs = what.case, what.motions, what.pairs
    n_steps = motions[0].n_steps
    clearance, points = np.full(n_steps, np.inf), np.full((n_steps, 2, 3), np.nan)
    winner = np.zeros(n_steps, dtype=np.int64)
    minima = no_minima(len(pairs))
    tally: Counter[str] = Counter()
    for step in range(n_steps):
        if step % CHUNK == 0:
            poses = link_poses_at(case, motions, slice(step, min(step + CHUNK, n_steps)))
        for i_pair, pair in enumerate(pairs):
            near = _measured(case, pair, poses[step % CHUNK][None], tolerance)
            tally.update(near.tally)
            witnesses = (near.point_a, near.point_b)
            if near.distance < clearance[step]:
                clearance[step], winner[step], points[step] = near.distance, i_pair, witnesses
            if near.distance < minima.clearance[i_pair]:
                minima.clearance[i_pair], minima.step[i_pair] = near.distance, step
                minima.points[i_pair] = witnesses
        if np.isinf(clearance[step]):
            raise _nothing_said(first_step + step, case, pairs, tolerance)
        if progress:
            progress(step + 1, n_steps)
    return MeasuredSteps(
        clearance,
        np.zeros(n_steps),
        winner,
        points,
        dict(tally),
        may_cut_pairs=True,
        measure_pair_minima=lambda most: minima,
    )


def _nothing_said(
    step: int, case: Case, pairs: Sequence[Pair], tolerance: float
) -> NothingToMeasure:
    """An infinite answer is no clearance: it says that nothing was measured, which overlap can cause."""
    larger = "" if tolerance == NO_TOLERANCE else f"a tolerance above {tolerance:g} m may do; "
    of = pairs[0].a.name_in(case), pairs[0].b.name_in(case)
    which = f" of {' and '.join(of)}" if len(pairs) == 1 else ""
    return NothingToMeasure(
        f"method 'paper' says nothing of step {step}: its rules cut every polygon pair{which}",
        valid=f"{larger}method 'exact' measures every step",
    )


def _measured(case: Case, pair: Pair, poses: np.ndarray, tolerance: float) -> Nearest:
    """The paper's distance of a pair, of the poses (1, links, 4, 4) of all links."""
    return distance_paper(
        pair.a.shape_in(case),
        pair.b.shape_in(case),
        pair.a.poses_in(case, poses)[0],
        pair.b.poses_in(case, poses)[0],
        tolerance=tolerance,
    )
