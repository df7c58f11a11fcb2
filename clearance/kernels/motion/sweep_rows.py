"""The results of a sweep: a row a step, and the least distance of each pair."""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.features.face_pair import nothing_yet, write_points


class StepRows(NamedTuple):
    """Results, one row a step.

    Attributes:
        clearance: (k,) [m] of the nearest pair, infinite where none is near enough.
        lower_bound: (k,) [m] a proven lower bound on the distance of all pairs.
        pair: (k,) the nearest pair, or -1.
        faces: (k, 2) joined face indices. points: (k, 2, 3) witness points in the world [m].
    """

    clearance: Floats
    lower_bound: Floats
    pair: Integers
    faces: Integers2
    points: Floats3


class PairRows(NamedTuple):
    """Results of every pair, where each has its own best.

    Attributes:
        every: (k, p) [m] clearance at each step, or (0, p) if only the least are wanted.
        clearance, step, points: (p,), (p,), (p, 2, 3) the least of each pair and its first step; infinite and -1
            without one.
    """

    every: Floats2
    clearance: Floats
    step: Integers
    points: Floats3


class SweepRows(NamedTuple):
    """All results of a sweep."""

    rows: StepRows
    pair_rows: PairRows


@inline
def write_step(row, pair, hit, lower_bound, rows):
    """Writes the nearest pair of a step and its points, -1 if none is known; `lower_bound` [m] is of all pairs."""
    rows.pair[row] = pair
    rows.clearance[row] = np.sqrt(hit.gap_sq) if pair >= 0 else np.inf
    rows.lower_bound[row] = min(lower_bound, rows.clearance[row])
    rows.faces[row, 0] = hit.face_a
    rows.faces[row, 1] = hit.face_b
    write_points(hit, rows.points[row])


@inline
def write_pair(row, step, pair, hit, pair_rows):
    """Writes the distance of a pair at a step, if asked for, and its least."""
    gap = np.sqrt(hit.gap_sq)
    if len(pair_rows.every) > 0:
        pair_rows.every[row, pair] = gap
    if gap < pair_rows.clearance[pair]:
        pair_rows.clearance[pair] = gap
        pair_rows.step[pair] = step
        write_points(hit, pair_rows.points[pair])


@inline(force=True)
def pass_over(n_pairs, row, lower_bound, rows, tally):
    """Writes a row without visits: none of so many pairs is nearer than `lower_bound` [m]."""
    write_step(row, -1, nothing_yet(np.inf), lower_bound, rows)
    tally[0] += n_pairs
    tally[4] += 1
