"""The least clearance of every step, of every pair, or of all: bounds carried from step to step.

Between steps no point of a body moves farther than `displacement` says, so that a bound on a pair's
distance, less what both bodies have moved since, still holds; pairs whose carried bound exceeds the best
are not asked. Where only what is near is asked for, steps at which nothing can be, by the positions of the
joints alone (`stride`), are passed over.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import borrowing, inlined, kernel, merged
from clearance.kernel_table import lend
from clearance.kernels.answers import (
    Answers,
    answer_of,
    has_moved,
    no_answers,
    note_answer,
    still_holds,
)
from clearance.kernels.body_boxes import BodyBoxes, bound_of_bodies, place_box, room_for_boxes
from clearance.kernels.body_pair import NO_FACE, Asked, measure_pair
from clearance.kernels.bounds import displacement
from clearance.kernels.descent import nothing_yet
from clearance.kernels.double_double import frames_of
from clearance.kernels.face_pair import write_points
from clearance.kernels.front import KEPT_DOWN, POOL, Fronts, forget, no_fronts
from clearance.kernels.kinematics import Links, place_links
from clearance.kernels.scratch import Scratch, new_scratch
from clearance.kernels.stride import fill_reach, least_spare
from clearance.kernels.vec3 import rigid

GROWTH = 1.0 + 1e-9
"""Covers the rounding of a sum of up to four million displacements."""


LOOK_AHEAD = 2.0
"""Mean travel between two looks, so many times: within this beyond the best a pair is still measured, so that
its bound lasts."""

LITTLE = 0.1
"""Of the best: where bodies move more in a step, nothing is measured beyond it."""


NOT_LESS = 1.0 + 2.0**-50
"""Makes room for what is equally near after its square was rounded."""


class World(NamedTuple):
    """What moves where.

    Attributes:
        frames: (bodies,) link that carries the body, or -1 for one that stands.
        standing: (bodies, 4, 4) poses of the bodies that stand [m].
        pairs: (p, 2) bodies to measure against each other.
        links: what moves the links.
    """

    frames: np.ndarray
    standing: np.ndarray
    pairs: np.ndarray
    links: Links


class Goal(NamedTuple):
    """What is asked of a sweep.

    Attributes:
        within: (p,) [m] each pair is measured only where it is not farther apart; the same for all pairs
            unless `each`.
        each: every pair has a best of its own; else all pairs of a step share one.
        lasting: a best holds for the later steps too: only what is nearer than all before is measured.
        effort: of `Asked`; what is found by less than `TO_THE_END` is an upper bound.
    """

    within: np.ndarray
    each: bool
    lasting: bool
    effort: int


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
def pose_of(world, body, poses):
    """Where a body is, as a `Rigid`; `poses` (links, 4, 4) are those of the links."""
    if world.frames[body] < 0:
        return rigid(world.standing[body])
    return rigid(poses[world.frames[body]])


@merged
def pair_frames(world, pair, poses):
    """Where both bodies of a pair are."""
    a = pose_of(world, world.pairs[pair, 0], poses)
    b = pose_of(world, world.pairs[pair, 1], poses)
    return frames_of(a, b)


@merged
def box_bound(surface, world, pair, poses, look, boxes, enough):
    """[m] a lower bound on the distance of a pair by the boxes of both bodies; one above `enough` will do.

    Args:
        look: rises whenever the links have moved.
    """
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    for body in (body_a, body_b):
        last = boxes.looks[body]
        if last < 0 or (last < look and world.frames[body] >= 0):
            place_box(surface, body, pose_of(world, body, poses), boxes)
            boxes.looks[body] = look
    return bound_of_bodies(boxes, body_a, body_b, enough)


@merged
def _add_travel(surface, world, before, after, travel, moves):
    """Adds to `travel` (bodies,) [m] what each body moves between two poses of the links, and 1 to its `moves`."""
    for body in range(len(world.frames)):
        frame = world.frames[body]
        if frame >= 0 and has_moved(before[frame], after[frame]):
            moves[body] += 1
            travel[body] += displacement(surface, surface.roots[body], before[frame], after[frame]) * GROWTH


@merged
def _floor_of(world, pair, travel, floors):
    """[m] the carried bound of a pair."""
    return floors[pair] - (travel[world.pairs[pair, 0]] + travel[world.pairs[pair, 1]])


@inlined
def _write(row, pair, hit, floor, rows):
    rows.pair[row] = pair
    rows.clearance[row] = np.sqrt(hit.gap_sq) if pair >= 0 else np.inf
    rows.floor[row] = min(floor, rows.clearance[row])
    rows.faces[row, 0] = hit.face_a
    rows.faces[row, 1] = hit.face_b
    write_points(hit, rows.points[row])


@inlined
def _write_pair(row, step, pair, hit, pair_rows):
    gap = np.sqrt(hit.gap_sq)
    if len(pair_rows.every) > 0:
        pair_rows.every[row, pair] = gap
    if gap < pair_rows.clearance[pair]:
        pair_rows.clearance[pair] = gap
        pair_rows.step[pair] = step
        write_points(hit, pair_rows.points[pair])


class Known(NamedTuple):
    """What is carried from step to step, and room for the search.

    Attributes:
        poses: (2, links, 4, 4) of the links at the last two steps that were looked at, in turn [m].
        travel: (bodies,) [m] what each body has moved.
        within: (p,) [m] as in `Goal`, less where that is found.
        floors: (p,) [m] a bound on each pair's distance plus the travel of both bodies when it was found.
        seeds: (p, 2) the faces that were nearest, or NO_FACE.
        reach, noise: of `fill_reach`, where steps can be passed over.
        spare: (bodies,) [m] how far each may move before something may come within what is asked.
        boxes: of the bodies at the last look that asked for them.
        answers: the last ones of the pairs.
        fronts, scratch: of `descend`.
    """

    poses: np.ndarray
    travel: np.ndarray
    within: np.ndarray
    floors: np.ndarray
    seeds: np.ndarray
    reach: np.ndarray
    noise: np.ndarray
    spare: np.ndarray
    boxes: BodyBoxes
    answers: Answers
    fronts: Fronts
    scratch: Scratch


@merged
def _bounded_again(surface, world, pair, poses, look, known, enough):
    """[m] the better of the carried bound of a pair and that of both bodies' boxes now; it is carried on."""
    travel, floors = known.travel, known.floors
    moved = travel[world.pairs[pair, 0]] + travel[world.pairs[pair, 1]]
    floor = max(floors[pair] - moved, box_bound(surface, world, pair, poses, look, known.boxes, enough))
    floors[pair] = (floor + moved) * KEPT_DOWN
    return floor


@merged
def _nearest_by_boxes(surface, world, poses, look, known, winner):
    """The pair to ask first where the last winner has moved farther than it was apart."""
    nearest = np.inf
    for pair in range(len(world.pairs)):
        floor = _floor_of(world, pair, known.travel, known.floors)
        if floor < nearest:
            floor = _bounded_again(surface, world, pair, poses, look, known, nearest)
            if floor < nearest:
                nearest = floor
                winner = pair
    return winner


@merged
def _spend(world, pair, spare_of_pair, spare):
    """Notes how far the bodies of a pair may move: each half as far where both do."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    if world.frames[body_a] >= 0 and world.frames[body_b] >= 0:
        spare_of_pair *= 0.5
    spare[body_a] = min(spare[body_a], spare_of_pair)
    spare[body_b] = min(spare[body_b], spare_of_pair)


@merged
def _pass_over(world, positions, row, within, known, rows, tally):
    """The next row to look at; writes those between, at which nothing comes `within` [m]."""
    after = row + 1
    while after < len(positions):
        left = least_spare(world.frames, positions, row, after, known.reach, known.noise, known.spare)
        if left <= 0.0:
            break
        _write(after, -1, nothing_yet(np.inf), within + left, rows)
        tally[0] += len(world.pairs)
        tally[4] += 1
        after += 1
    return after


@kernel
def sweep(surface, world, positions, steps, goal, rows, pair_rows, tally, table):
    """Fills `rows` for `steps` (k,) and `tally`: pairs skipped, queries, nodes, faces, steps passed over.

    Ties go to the least pair. What is exact in the rows does not depend on where a sweep starts. Without
    `goal.each`, `pair_rows` is not touched.

    Args:
        positions: (k, columns) of the joints at the steps [rad or m].
    """
    n_pairs, n_bodies = len(world.pairs), len(world.frames)
    known = Known(
        np.empty((2, len(world.links.parents), 4, 4)), np.zeros(n_bodies), goal.within.copy(),
        np.empty(n_pairs), np.full((n_pairs, 2), NO_FACE),
        np.empty((n_bodies, positions.shape[1])), np.empty(n_bodies), np.empty(n_bodies),
        room_for_boxes(n_bodies), no_answers(n_bodies, n_pairs), no_fronts(n_pairs, POOL), new_scratch(),
    )  # fmt: skip
    _sweep(surface, world, positions, steps, goal, known, rows, pair_rows, tally, table)


@borrowing
def _sweep(surface, world, positions, steps, goal, known, rows, pair_rows, tally, table):
    """`sweep`, with room for what is known."""
    travel, within, floors, seeds = known.travel, known.within, known.floors, known.seeds
    answers, fronts, scratch = known.answers, known.fronts, known.scratch
    n_pairs = len(world.pairs)
    for i in range(len(tally)):
        tally[i] = 0
    poses = known.poses[0]
    place_links(world.links, positions[0], poses)
    for pair in range(n_pairs):
        floors[pair] = box_bound(surface, world, pair, poses, 0, known.boxes, np.inf)
    winner = np.argmin(floors)
    near_only = within[0] < np.inf
    if near_only:
        fill_reach(surface, world.frames, world.links, positions, known.reach, known.noise)
    lent = lend(surface)
    row = 0
    looked_at = 0
    while row < len(steps):
        if row > 0:
            poses, before = known.poses[looked_at % 2], poses
            place_links(world.links, positions[row], poses)
            _add_travel(surface, world, before, poses, travel, answers.moves)
        looked_at += 1
        best = nothing_yet(np.inf)
        best_pair = -1
        lowest = np.inf
        asked_within = within[0]
        gap = asked_within
        for body in range(len(known.spare)):
            known.spare[body] = np.inf
        if _floor_of(world, winner, travel, floors) <= 0.0:
            winner = _nearest_by_boxes(surface, world, poses, looked_at, known, winner)
        for turn in range(-1, n_pairs):
            pair = winner if turn < 0 else turn
            if turn == winner:
                continue
            body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
            moved = travel[body_a] + travel[body_b]
            floor = floors[pair] - moved
            if goal.each:
                asked_within = within[pair]
                gap = asked_within
            if floor <= 0.0:
                floor = _bounded_again(surface, world, pair, poses, looked_at, known, gap)
            if floor > gap:
                lowest = min(lowest, floor)
                if near_only:
                    _spend(world, pair, floor - asked_within, known.spare)
                tally[0] += 1
                continue
            if still_holds(answers, pair, body_a, body_b, gap):
                hit, floor = answer_of(answers, pair)
                tally[0] += 1
            else:
                ahead = moved / max(1, looked_at - 1)
                limit = gap + (LOOK_AHEAD * ahead if ahead < LITTLE * gap else 0.0)
                if floor <= 0.0:
                    forget(fronts, pair)  # where bodies may meet, nearest first from the roots is best
                asked = Asked(limit, gap, seeds[pair, 0], seeds[pair, 1], floor > 0.0, goal.effort)
                measured = measure_pair(
                    lent, body_a, lent, body_b, pair_frames(world, pair, poses), asked,
                    fronts, pair, moved, scratch, table,
                )  # fmt: skip
                hit, floor = measured.hit, measured.lower_bound
                note_answer(answers, pair, body_a, body_b, hit, floor)
                floors[pair] = (floor + moved) * KEPT_DOWN
                seeds[pair, 0], seeds[pair, 1] = measured.face_a, measured.face_b
                tally[1] += 1
                tally[2] += measured.tally.nodes
                tally[3] += measured.tally.faces
            lowest = min(lowest, floor)
            if near_only:
                _spend(world, pair, floor - asked_within, known.spare)
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
        if near_only:
            row = _pass_over(world, positions, row, asked_within, known, rows, tally)
        else:
            row += 1
