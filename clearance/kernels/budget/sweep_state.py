"""The state of a sweep from one moment to the next, and the starts of its searches.

Not for: one pair, and choosing moments and intervals (`sweep`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2, Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    gap_sq,
    move,
    move_back,
    row,
    turn_back,
)
from clearance.kernels.budget.along_rows import new_along_rows
from clearance.kernels.budget.error_rows import SeenErrors
from clearance.kernels.budget.errors import (
    REACH,
    RESIDUAL,
    REST,
    REST_AT_REST,
    Errors,
    new_body_rows,
)
from clearance.kernels.budget.levers import (
    UNMOVED,
    Levers,
    excess_of_motion,
    fill_steps,
    moved_from_step,
    moved_in_part,
    new_levers,
)
from clearance.kernels.budget.middle import WANTED, Middle, begin_middle, new_middle_of
from clearance.kernels.budget.rows import fill_rows, fill_rows_of_standing
from clearance.kernels.features.bounds import displacement
from clearance.kernels.mesh.surface import Surface, box_of
from clearance.kernels.motion.body_boxes import (
    BodyBoxes,
    bound_of_bodies,
    new_body_boxes,
    place_box,
)
from clearance.kernels.motion.halving import DEPTH
from clearance.kernels.motion.joint_motion_bound import orientation_rounding
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.kinematics import copy_pose
from clearance.kernels.motion.world import World, pose_of
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.carried import Carried, nothing_carried
from clearance.kernels.search.front import POOL
from clearance.kernels.search.proof import CHAIN_SLACK, Proof, ProofStart
from clearance.kernels.search.scratch import Scratch, new_scratch


class BudgetSweepState(NamedTuple):
    """State that lasts from moment to moment, and scratch.

    Attributes:
        middle: the poses of all links. boxes: of the bodies there.
        directions: (p, 3) of the last nearest points of each pair, from its first body; 0 before the first search.
        levers: bounds on the motion of bodies. late: True if a clock may be wrong; then levers do not apply.
        filled, placed: (bodies,) the number of the part for which the rows and the box of each were made.
        poses: (links, 4, 4) at the last step. n_moves: (bodies,) how often each has moved.
        carried: of all pairs.
        answers: (p, 6) the last answer of each pair at a moment. `MOVES`: the moves of its bodies by then, or -1.
            `TARGET` [m] of its search. `LOWER_BOUND`, `LEAST`, `ENOUGH` [m] as in `Proof`. `TWICE`: 1 if the
            search before was the same.
        waiting: (DEPTH, 2) parts of an interval.
        seen: the rows of all bodies. scratch: of a search.
    """

    middle: Middle
    boxes: BodyBoxes
    directions: Floats2
    levers: Levers
    late: bool
    filled: Integers
    placed: Integers
    poses: Floats3
    n_moves: Integers
    carried: Carried
    answers: Floats2
    waiting: Floats2
    seen: SeenErrors
    scratch: Scratch


class BudgetScene(NamedTuple):
    """The bodies, motion and errors of a sweep, and its state; it is scene.

    Attributes:
        surface: every face owns all its features. world, path: as of a certificate. errors: `Errors`.
    """

    surface: Surface
    world: World
    path: JointPath
    errors: Errors
    state: BudgetSweepState


MOVES, TARGET, LOWER_BOUND, LEAST, ENOUGH, TWICE = range(6)
"""Columns of `BudgetSweepState.answers`."""

ROUNDED = 2.0**-40
"""Rounding of poses of a chain, relative to their distance from the origin, with a margin."""

LITTLE = 0.02
"""[m] A bound by boxes is tightened up to this much more than is enough, so that it lasts."""


@inline
def new_state(world, errors):
    """An empty state."""
    n_links, n_bodies, n_pairs = len(world.links.parents), len(world.frames), len(world.pairs)
    seen = SeenErrors(
        new_body_rows(n_bodies, errors.most_rows), new_along_rows(errors.most_rows),
        new_along_rows(errors.most_rows),
    )  # fmt: skip
    return BudgetSweepState(
        new_middle_of(n_links), new_body_boxes(n_bodies), np.zeros((n_pairs, 3)),
        new_levers(n_bodies, n_links), errors.delay.max() > 0.0 if n_links > 0 else False,
        np.full(n_bodies, -1), np.full(n_bodies, -1), np.zeros((n_links, 4, 4)),
        np.zeros(n_bodies, dtype=np.int64), nothing_carried(n_bodies, n_pairs, POOL),
        np.full((n_pairs, 6), -1.0), np.empty((DEPTH, 2)), seen, new_scratch(),
    )  # fmt: skip


@inline
def begin_anew(world, state):
    """Resets the state, so that the next sweep is like the first."""
    begin_middle(world, state.middle)
    state.directions[:] = 0.0
    state.filled[:] = -1
    state.placed[:] = -1
    state.carried.moved[:] = 0.0
    state.n_moves[:] = 0
    state.carried.lower_bounds[:] = -math.inf
    state.answers[:, MOVES] = -1.0
    state.carried.fronts.spans[:] = 0
    state.carried.fronts.used[0] = 0


@inline
def fill_body(scene, body, half, number):
    """Writes the rows of a body about the middle, once for each number of a part."""
    surface, world, errors, state = scene.surface, scene.world, scene.errors, scene.state
    frame = world.frames[body]
    if state.filled[body] == number or (frame < 0 and state.filled[body] >= 0):
        return
    state.filled[body] = number
    found, middle, balls = state.seen.found, state.middle, scene.path.balls
    if frame < 0:
        fill_rows_of_standing(surface, world, body, errors, found)
        return
    fill_rows(surface, world, body, errors, middle, half, found)
    if len(balls.links) > 0:
        box = box_of(surface, surface.roots[world.solids[body]])
        rounding = orientation_rounding(box, world.links, frame, balls, middle.state)
        for column in (REST, REST_AT_REST, REACH):
            found.sums[body, column] += rounding
        if found.sums[body, RESIDUAL] >= 0.0:
            found.sums[body, RESIDUAL] += rounding


@inline(force=True)
def _place_body(surface, world, body, number, state):
    """Places the box of a body at its pose, once for each number of a part."""
    if state.placed[body] == number or (world.frames[body] < 0 and state.placed[body] >= 0):
        return
    state.placed[body] = number
    root = surface.roots[world.solids[body]]
    place_box(surface, root, body, pose_of(world, body, state.middle.state.poses), state.boxes)


@inline(force=True)
def skin_of(scene, pair):
    """[m] the skin of a pair: radii of balls and errors of surfaces of both bodies."""
    surface, world, errors = scene.surface, scene.world, scene.errors
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    radii = radii_of(surface, world.solids[body_a], surface, world.solids[body_b])
    return radii.both + errors.surface[body_a] + errors.surface[body_b]


@inline(force=True)
def _reach(scene, body, half, number):
    """[m] the greatest motion of any point of a body from the middle, by errors and joints."""
    state = scene.state
    if state.late:
        fill_body(scene, body, half, number)
        return state.seen.found.sums[body, REACH]
    moved = 0.0
    if half > 0.0:
        moved = moved_in_part(scene.world, state.middle.state, body, state.levers)
    return state.levers.reach[body] + moved


@inline
def bound_by_boxes(scene, pair, half, number, enough):
    """[m] a bound on the distance of a pair under errors by both bodies' boxes; one above `enough` will do."""
    surface, world, state = scene.surface, scene.world, scene.state
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    loss = skin_of(scene, pair)
    for body in (body_a, body_b):
        _place_body(surface, world, body, number, state)
        loss += _reach(scene, body, half, number)
    separation = bound_of_bodies(state.boxes, body_a, body_b, enough + loss + LITTLE)
    slacks = state.boxes.slacks[body_a] + state.boxes.slacks[body_b]
    return separation - CHAIN_SLACK * slacks - loss


@inline
def start_at(scene, pair, points):
    """A start at the nearest points of a pair, (2, 3) [m] at the poses of the links."""
    pose = pose_of(scene.world, scene.world.pairs[pair, 0], scene.state.middle.state.poses)
    p, q = row(points, 0), row(points, 1)
    return ProofStart(move_back(pose, p), move_back(pose, q), math.sqrt(gap_sq(p, q)), -1, -1)


@inline
def start_before(scene, pair):
    """A start along the last direction of a pair, from centre to centre without one."""
    surface, world, state = scene.surface, scene.world, scene.state
    seen = row(state.directions, pair)
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    poses = state.middle.state.poses
    pose_a, pose_b = pose_of(world, body_a, poses), pose_of(world, body_b, poses)
    here = Vec3(0.0, 0.0, 0.0)
    if seen.x != 0.0 or seen.y != 0.0 or seen.z != 0.0:
        return ProofStart(here, turn_back(pose_a, seen), math.inf, -1, -1)
    p = box_of(surface, surface.roots[world.solids[body_a]]).centre
    q = box_of(surface, surface.roots[world.solids[body_b]]).centre
    return ProofStart(p, move_back(pose_a, move(pose_b, q)), math.inf, -1, -1)


@inline
def go_on(scene, before, step):
    """Adds the motion of bodies from one step to a later one; infinite where unknown."""
    world, state = scene.world, scene.state
    for body in range(len(world.frames)):
        if world.frames[body] < 0:
            continue
        if state.late or step < before:
            state.carried.moved[body] = math.inf
        else:
            for between in range(before, step):
                state.carried.moved[body] += moved_from_step(
                    world, scene.path, between, body, state.levers
                )


@inline(force=True)
def _far(pose):
    return abs(pose[0, 3]) + abs(pose[1, 3]) + abs(pose[2, 3])


@inline
def go_on_to_step(scene, before, step):
    """Adds the motion of bodies from one step to a later one, the current one; infinite where unknown.

    Args:
        before: the step of the last call, or -1.
    """
    surface, world, state = scene.surface, scene.world, scene.state
    poses, levers = state.middle.state.poses, state.levers
    goes_on = before >= 0 and not state.late and step >= before
    if goes_on:
        fill_steps(world, scene.path, before, step, levers)
    for body in range(len(world.frames)):
        frame = world.frames[body]
        if frame < 0 or before < 0:
            continue
        if goes_on and levers.steps[frame, UNMOVED] > 0.0:
            continue
        moved = math.inf
        if goes_on:
            root = surface.roots[world.solids[body]]
            moved = displacement(surface, root, state.poses[frame], poses[frame])
            moved += excess_of_motion(world, scene.path, before, step, body, levers)
            moved += ROUNDED * (levers.sizes[body] + _far(poses[frame]))
        state.carried.moved[body] += moved
        state.n_moves[body] += 1
    for link in range(len(poses)):
        if state.middle.marks[link, WANTED]:
            copy_pose(poses[link], state.poses[link])


@inline(force=True)
def _moves_of_pair(scene, pair):
    """The number of moves of both bodies of a pair."""
    pairs, moves = scene.world.pairs, scene.state.n_moves
    return np.float64(moves[pairs[pair, 0]] + moves[pairs[pair, 1]])


@inline(force=True)
def note_answer(scene, pair, target, proof):
    """Stores the answer of a pair for a target [m]."""
    answer, moves = scene.state.answers[pair], _moves_of_pair(scene, pair)
    again = answer[MOVES] == moves and answer[TARGET] == target
    answer[MOVES], answer[TARGET], answer[TWICE] = moves, target, 1.0 if again else 0.0
    answer[LOWER_BOUND], answer[LEAST] = proof.lower_bound, proof.least
    answer[ENOUGH] = proof.enough


@inline(force=True)
def is_answered(scene, pair, target):
    """True if no body of a pair has moved since two searches with the same target [m].

    The second begins at the front of the first and may prove more; a third would repeat its result.
    """
    answer = scene.state.answers[pair]
    is_same = answer[MOVES] == _moves_of_pair(scene, pair) and answer[TARGET] == target
    return is_same and answer[TWICE] == 1.0


@inline(force=True)
def answer_of(scene, pair):
    """The last answer of a pair."""
    answer = scene.state.answers[pair]
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Proof(
        answer[LOWER_BOUND], answer[LEAST], answer[ENOUGH], True, False, nowhere, -1, -1, 0, 0, 0
    )
