"""The least clearance of every step: one best over all pairs, bounds carried from step to step.

Between steps no point of a body moves farther than `displacement` says, so that a bound on a pair's
distance, less what both bodies have moved since, still holds; pairs whose carried bound exceeds the best of
the step are not asked.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.body_pair import NO_FACE, Asked, measure_pair
from clearance.kernels.bounds import displacement, lower_bound_boxes, rounding_slack
from clearance.kernels.descent import new_scratch, nothing_yet
from clearance.kernels.double_double import frames_of
from clearance.kernels.front import KEPT_DOWN, POOL, no_fronts
from clearance.kernels.surface import box_of
from clearance.kernels.vec3 import rigid

GROWTH = 1.0 + 1e-9
"""Covers the rounding of a sum of up to four million displacements."""


LOOK_AHEAD = 4.0
"""Steps of mean travel beyond the best within which a pair is still measured, so that its bound lasts."""


class World(NamedTuple):
    """What moves where.

    Attributes:
        frames: (bodies,) column of `poses` that carries the body, or -1 for one that stands.
        standing: (bodies, 4, 4) poses of the bodies that stand [m].
        poses: (steps, frames, 4, 4) `world_from_frame` [m].
        pairs: (p, 2) bodies to measure against each other.
    """

    frames: np.ndarray
    standing: np.ndarray
    poses: np.ndarray
    pairs: np.ndarray


class StepRows(NamedTuple):
    """Results, one row a step: clearance [m], pair index, joined face indices, world witness points [m]."""

    clearance: np.ndarray
    pair: np.ndarray
    faces: np.ndarray
    points: np.ndarray  # (n, 2, 3)


@inlined
def pose_of(world, body, step):
    """The (4, 4) pose of a body at a step."""
    if world.frames[body] < 0:
        return world.standing[body]
    return world.poses[step, world.frames[body]]


@inlined
def pair_frames(world, pair, step):
    """Where both bodies of a pair are at a step."""
    a = rigid(pose_of(world, world.pairs[pair, 0], step))
    b = rigid(pose_of(world, world.pairs[pair, 1], step))
    return frames_of(a, b)


@inlined
def root_bound(surface, world, pair, step):
    """[m] a lower bound on the distance of the boxes of a pair."""
    frames = pair_frames(world, pair, step)
    root_a = surface.roots[world.pairs[pair, 0]]
    root_b = surface.roots[world.pairs[pair, 1]]
    slack = rounding_slack(surface, root_a, surface, root_b, frames)
    bound = lower_bound_boxes(box_of(surface, root_a), box_of(surface, root_b), frames.m, slack)
    return max(0.0, bound - slack)


@inlined
def add_travel(surface, world, step, travel):
    """Adds to `travel` (bodies,) [m] what each body moves between `step - 1` and `step`."""
    for body in range(len(world.frames)):
        frame = world.frames[body]
        if frame >= 0:
            before = world.poses[step - 1, frame]
            after = world.poses[step, frame]
            travel[body] += displacement(surface, surface.roots[body], before, after) * GROWTH


@inlined
def _write(step, pair, hit, rows):
    rows.clearance[step] = np.sqrt(hit.gap_sq)
    rows.pair[step] = pair
    rows.faces[step, 0] = hit.face_a
    rows.faces[step, 1] = hit.face_b
    for axis in range(3):
        rows.points[step, 0, axis] = hit.p[axis]
        rows.points[step, 1, axis] = hit.q[axis]


@kernel
def sweep(surface, world, first, last, rows, tally):
    """Fills `rows` for the steps `first` to `last` - 1 and adds to `tally`: skipped, queries, nodes, faces.

    Ties go to the least pair. The rows do not depend on where a sweep starts.
    """
    n_pairs = len(world.pairs)
    travel = np.zeros(len(world.frames))
    floors = np.empty(n_pairs)  # carried bound plus the travel of both bodies when it was found
    seeds = np.full((n_pairs, 2), NO_FACE)
    for pair in range(n_pairs):
        floors[pair] = root_bound(surface, world, pair, first)
    winner = np.argmin(floors)
    scratch = new_scratch()
    fronts = no_fronts(n_pairs, POOL)
    for step in range(first, last):
        if step > first:
            add_travel(surface, world, step, travel)
        best_pair = -1
        best = nothing_yet(np.inf)
        for turn in range(-1, n_pairs):
            pair = winner if turn < 0 else turn
            if turn == winner:
                continue
            body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
            moved = travel[body_a] + travel[body_b]
            floor = floors[pair] - moved
            best_gap = np.sqrt(best.gap_sq)
            if floor > best_gap:
                tally[0] += 1
                continue
            limit = best_gap + LOOK_AHEAD * (travel[body_a] + travel[body_b]) / max(1, step - first)
            asked = Asked(limit, best_gap, seeds[pair, 0], seeds[pair, 1], floor > 0.0)
            measured = measure_pair(
                surface, body_a, surface, body_b, pair_frames(world, pair, step), asked,
                fronts, pair, moved, scratch,
            )  # fmt: skip
            floors[pair] = (measured.lower_bound + moved) * KEPT_DOWN
            seeds[pair, 0], seeds[pair, 1] = measured.face_a, measured.face_b
            tally[1] += 1
            tally[2] += measured.tally.nodes
            tally[3] += measured.tally.faces
            hit = measured.hit
            if hit.face_a < 2**62:
                if hit.gap_sq < best.gap_sq or (hit.gap_sq == best.gap_sq and pair < best_pair):
                    best = hit
                    best_pair = pair
        winner = best_pair
        _write(step, best_pair, best, rows)
