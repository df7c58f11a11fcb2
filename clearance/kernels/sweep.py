"""The least clearance of every step, of every pair, or of all: bounds carried from step to step.

Between steps no point of a body moves farther than `displacement` says, so that a bound on a pair's
distance, less what both bodies have moved since, still holds; pairs whose carried bound exceeds the best
are not asked.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import borrowing, inlined, kernel, merged
from clearance.kernel_table import lend
from clearance.kernels.body_pair import NO_FACE, Asked, measure_pair
from clearance.kernels.bounds import displacement, lower_bound_boxes, rounding_slack
from clearance.kernels.descent import nothing_yet
from clearance.kernels.double_double import frames_of
from clearance.kernels.front import KEPT_DOWN, POOL, Fronts, forget, no_fronts
from clearance.kernels.scratch import Scratch, new_scratch
from clearance.kernels.surface import box_of
from clearance.kernels.vec3 import rigid

GROWTH = 1.0 + 1e-9
"""Covers the rounding of a sum of up to four million displacements."""


LOOK_AHEAD = 2.0
"""Steps of mean travel beyond the best within which a pair is still measured, so that its bound lasts."""

LITTLE = 0.1
"""Of the best: where bodies move more in a step, nothing is measured beyond it."""


NOT_LESS = 1.0 + 2.0**-50
"""Makes room for what is equally near after its square was rounded."""


class World(NamedTuple):
    """What moves where.

    Attributes:
        frames: (bodies,) column of `poses` that carries the body, or -1 for one that stands.
        standing: (bodies, 4, 4) poses of the bodies that stand [m].
        poses: (k, frames, 4, 4) `world_from_frame` [m] at the steps of the rows.
        pairs: (p, 2) bodies to measure against each other.
    """

    frames: np.ndarray
    standing: np.ndarray
    poses: np.ndarray
    pairs: np.ndarray


class Goal(NamedTuple):
    """What is asked of a sweep.

    Attributes:
        within: (p,) [m] each pair is measured only where it is not farther apart; the same for all pairs
            unless `each`.
        each: every pair has a best of its own; else all pairs of a step share one.
        lasting: a best holds for the later steps too: only what is nearer than all before is measured.
    """

    within: np.ndarray
    each: bool
    lasting: bool


class StepRows(NamedTuple):
    """Results, one row a step.

    Attributes:
        clearance: (k,) [m] of the nearest pair, infinite where none is within what was asked.
        floor: (k,) [m] a proven lower bound on the distance of all pairs.
        pair: (k,) the nearest pair, or -1.
        faces: (k, 2) joined face indices. points: (k, 2, 3) witness points in the world [m].
    """

    clearance: np.ndarray
    floor: np.ndarray
    pair: np.ndarray
    faces: np.ndarray
    points: np.ndarray


class PairRows(NamedTuple):
    """Results of every pair, where each has its own best.

    Attributes:
        every: (k, p) [m] clearance at each step, or (0, p) if only the least are wanted.
        clearance, step, points: (p,), (p,), (p, 2, 3) the least of each pair, infinite and -1 if there is
            none, and the first step that has it.
    """

    every: np.ndarray
    clearance: np.ndarray
    step: np.ndarray
    points: np.ndarray


@merged
def pose_of(world, body, row):
    """Where a body is at a row, as a `Rigid`."""
    if world.frames[body] < 0:
        return rigid(world.standing[body])
    return rigid(world.poses[row, world.frames[body]])


@merged
def pair_frames(world, pair, row):
    """Where both bodies of a pair are at a row."""
    a = pose_of(world, world.pairs[pair, 0], row)
    b = pose_of(world, world.pairs[pair, 1], row)
    return frames_of(a, b)


@merged
def root_bound(surface, world, pair, row):
    """[m] a lower bound on the distance of the boxes of a pair."""
    frames = pair_frames(world, pair, row)
    root_a = surface.roots[world.pairs[pair, 0]]
    root_b = surface.roots[world.pairs[pair, 1]]
    slack = rounding_slack(surface, root_a, surface, root_b, frames)
    bound = lower_bound_boxes(box_of(surface, root_a), box_of(surface, root_b), frames.m, slack)
    return max(0.0, bound - slack)


@merged
def _add_travel(surface, world, row, travel):
    """Adds to `travel` (bodies,) [m] what each body moves from the row before to this one."""
    for body in range(len(world.frames)):
        frame = world.frames[body]
        if frame >= 0:
            start, end = world.poses[row - 1, frame], world.poses[row, frame]
            travel[body] += displacement(surface, surface.roots[body], start, end) * GROWTH


@merged
def _floor_of(world, pair, travel, floors):
    """[m] the carried bound of a pair."""
    return floors[pair] - (travel[world.pairs[pair, 0]] + travel[world.pairs[pair, 1]])


@merged
def _bounded_again(surface, world, pair, row, travel, floors):
    """[m] the better of the carried bound of a pair and that of both bodies' boxes now; it is carried on."""
    floor = max(_floor_of(world, pair, travel, floors), root_bound(surface, world, pair, row))
    moved = travel[world.pairs[pair, 0]] + travel[world.pairs[pair, 1]]
    floors[pair] = (floor + moved) * KEPT_DOWN
    return floor


@merged
def _nearest_by_boxes(surface, world, row, travel, floors, winner):
    """The pair to ask first where the last winner has moved farther than it was apart."""
    nearest = np.inf
    for pair in range(len(world.pairs)):
        floor = _floor_of(world, pair, travel, floors)
        if floor < nearest:
            floor = _bounded_again(surface, world, pair, row, travel, floors)
            if floor < nearest:
                nearest = floor
                winner = pair
    return winner


@inlined
def _write_points(hit, points):
    for axis in range(3):
        points[0, axis] = hit.p[axis]
        points[1, axis] = hit.q[axis]


@inlined
def _write(row, pair, hit, floor, rows):
    rows.pair[row] = pair
    rows.clearance[row] = np.sqrt(hit.gap_sq) if pair >= 0 else np.inf
    rows.floor[row] = min(floor, rows.clearance[row])
    rows.faces[row, 0] = hit.face_a
    rows.faces[row, 1] = hit.face_b
    _write_points(hit, rows.points[row])


@inlined
def _write_pair(row, step, pair, hit, pair_rows):
    gap = np.sqrt(hit.gap_sq)
    if len(pair_rows.every) > 0:
        pair_rows.every[row, pair] = gap
    if gap < pair_rows.clearance[pair]:
        pair_rows.clearance[pair] = gap
        pair_rows.step[pair] = step
        _write_points(hit, pair_rows.points[pair])


class Known(NamedTuple):
    """What is carried from step to step, and room for the search.

    Attributes:
        travel: (bodies,) [m] what each body has moved.
        within: (p,) [m] as in `Goal`, less where that is found.
        floors: (p,) [m] a bound on each pair's distance plus the travel of both bodies when it was found.
        seeds: (p, 2) the faces that were nearest, or NO_FACE.
        fronts, scratch: of `descend`.
    """

    travel: np.ndarray
    within: np.ndarray
    floors: np.ndarray
    seeds: np.ndarray
    fronts: Fronts
    scratch: Scratch


@kernel
def sweep(surface, world, steps, goal, rows, pair_rows, tally, table):
    """Fills `rows` for `steps` (k,) and `tally`: pairs skipped, queries, nodes, faces.

    Ties go to the least pair. What is exact in the rows does not depend on where a sweep starts. Without
    `goal.each`, `pair_rows` is not touched.
    """
    n_pairs = len(world.pairs)
    known = Known(
        np.zeros(len(world.frames)), goal.within.copy(), np.empty(n_pairs), np.full((n_pairs, 2), NO_FACE),
        no_fronts(n_pairs, POOL), new_scratch(),
    )  # fmt: skip
    _sweep(surface, world, steps, goal, known, rows, pair_rows, tally, table)


@borrowing
def _sweep(surface, world, steps, goal, known, rows, pair_rows, tally, table):
    """`sweep`, with room for what is known."""
    travel, within, floors, seeds = known.travel, known.within, known.floors, known.seeds
    fronts, scratch = known.fronts, known.scratch
    n_pairs = len(world.pairs)
    for i in range(len(tally)):
        tally[i] = 0
    for pair in range(n_pairs):
        floors[pair] = root_bound(surface, world, pair, 0)
    winner = np.argmin(floors)
    lent = lend(surface)
    for row in range(len(steps)):
        if row > 0:
            _add_travel(surface, world, row, travel)
        best = nothing_yet(np.inf)
        best_pair = -1
        lowest = np.inf
        gap = within[0]
        if _floor_of(world, winner, travel, floors) <= 0.0:
            winner = _nearest_by_boxes(surface, world, row, travel, floors, winner)
        for turn in range(-1, n_pairs):
            pair = winner if turn < 0 else turn
            if turn == winner:
                continue
            body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
            moved = travel[body_a] + travel[body_b]
            floor = floors[pair] - moved
            if floor <= 0.0:
                floor = _bounded_again(surface, world, pair, row, travel, floors)
            if goal.each:
                gap = within[pair]
            if floor > gap:
                lowest = min(lowest, floor)
                tally[0] += 1
                continue
            ahead = moved / max(1, row)
            limit = gap + (LOOK_AHEAD * ahead if ahead < LITTLE * gap else 0.0)
            if floor <= 0.0:
                forget(fronts, pair)  # where bodies may meet, nearest first from the roots is best
            asked = Asked(limit, gap, seeds[pair, 0], seeds[pair, 1], floor > 0.0)
            measured = measure_pair(
                lent, body_a, lent, body_b, pair_frames(world, pair, row), asked,
                fronts, pair, moved, scratch, table,
            )  # fmt: skip
            lowest = min(lowest, measured.lower_bound)
            floors[pair] = (measured.lower_bound + moved) * KEPT_DOWN
            seeds[pair, 0], seeds[pair, 1] = measured.face_a, measured.face_b
            tally[1] += 1
            tally[2] += measured.tally.nodes
            tally[3] += measured.tally.faces
            hit = measured.hit
            if hit.face_a == 2**62:
                continue
            if hit.gap_sq < best.gap_sq or (hit.gap_sq == best.gap_sq and pair < best_pair):
                best = hit
                best_pair = pair
                if not goal.each:
                    gap = min(gap, np.sqrt(hit.gap_sq))
            if goal.each:
                _write_pair(row, steps[row], pair, hit, pair_rows)
                if goal.lasting:
                    within[pair] = min(gap, np.sqrt(hit.gap_sq) * NOT_LESS)
        if best_pair >= 0:
            winner = best_pair
            if goal.lasting and not goal.each:
                within[0] = min(within[0], np.sqrt(best.gap_sq) * NOT_LESS)
        _write(row, best_pair, best, lowest, rows)
