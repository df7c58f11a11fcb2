"""The least clearance of every pair over a whole motion, asking only at steps where it could be.

Over an interval of steps whose ends are known, the distance cannot fall below the mean of both ends less
half of what the bodies move in between (Piyavskii 1972, Shubert 1972); intervals whose bound exceeds the
best are dropped, the others halved.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.body_pair import NO_FACE, Asked, measure_pair
from clearance.kernels.descent import Scratch, new_scratch
from clearance.kernels.front import Fronts, forget, no_fronts
from clearance.kernels.sweep import add_travel, pair_frames, root_bound

DEPTH = 128
"""Intervals that can wait: halving 2**63 steps leaves one a level."""


MARGIN = 0.25
"""How far beyond the best a pair is measured, as a share of what moves in the interval: a greater share
makes queries dearer and intervals fewer; 0.1 to 0.5 differ by less than a third on the shared cases."""


class Probe(NamedTuple):
    """The state of the search for one pair: its best step so far and what it reuses."""

    gap: np.ndarray  # (1,) [m]
    step: np.ndarray  # (1,)
    faces: np.ndarray  # (2,)
    points: np.ndarray  # (2, 3) world [m]
    scratch: Scratch
    fronts: Fronts


@kernel
def travelled(surface, world):
    """(steps, bodies) [m] how far at most a point of each body has moved since step 0."""
    travel = np.zeros((len(world.poses), len(world.frames)))
    for step in range(1, len(world.poses)):
        travel[step] = travel[step - 1]
        add_travel(surface, world, step, travel[step])
    return travel


@inlined
def _ask(surface, world, pair, step, margin, probe, tally):
    """[m] a lower bound on the distance of the pair at a step; `probe` takes it if it is the best."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    limit = probe.gap[0] + margin
    asked = Asked(limit, probe.gap[0], probe.faces[0], probe.faces[1], False)
    frames = pair_frames(world, pair, step)
    forget(probe.fronts, pair)
    measured = measure_pair(
        surface, body_a, surface, body_b, frames, asked, probe.fronts, pair, 0.0, probe.scratch
    )
    tally[1] += 1
    tally[2] += measured.tally.nodes
    tally[3] += measured.tally.faces
    hit = measured.hit
    if hit.face_a == 2**62:
        return measured.lower_bound
    gap = np.sqrt(hit.gap_sq)
    if gap < probe.gap[0] or (gap == probe.gap[0] and step < probe.step[0]):
        probe.gap[0] = gap
        probe.step[0] = step
        probe.faces[0], probe.faces[1] = hit.face_a, hit.face_b
        for axis in range(3):
            probe.points[0, axis] = hit.p[axis]
            probe.points[1, axis] = hit.q[axis]
    return measured.lower_bound


@inlined
def _likely_step(surface, world, pair):
    """The step at which the boxes of a pair are nearest."""
    least = np.inf
    likely = 0
    for step in range(len(world.poses)):
        bound = root_bound(surface, world, pair, step)
        if bound < least:
            least = bound
            likely = step
    return likely


@inlined
def _search(surface, world, pair, travel, probe, tally):
    """Leaves in `probe` the least clearance of one pair over all steps, the first step that has it."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    last = len(world.poses) - 1
    steps = np.empty((DEPTH, 2), dtype=np.int64)
    ends = np.empty((DEPTH, 2))
    way = (travel[last, body_a] + travel[last, body_b]) - (travel[0, body_a] + travel[0, body_b])
    steps[0, 0], steps[0, 1] = 0, last
    _ask(surface, world, pair, _likely_step(surface, world, pair), 0.0, probe, tally)
    ends[0, 0] = _ask(surface, world, pair, 0, MARGIN * way, probe, tally)
    ends[0, 1] = _ask(surface, world, pair, last, MARGIN * way, probe, tally) if last > 0 else ends[0, 0]
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        left, right = steps[n_waiting, 0], steps[n_waiting, 1]
        low, high = ends[n_waiting, 0], ends[n_waiting, 1]
        way = (travel[right, body_a] + travel[right, body_b]) - (
            travel[left, body_a] + travel[left, body_b]
        )
        if right - left < 2:
            continue
        if 0.5 * (low + high - way) > probe.gap[0]:
            tally[0] += right - left - 1
            continue
        middle = (left + right) // 2
        at_middle = _ask(surface, world, pair, middle, MARGIN * way, probe, tally)
        near_first = low < high  # the half with the nearer end is searched first: it sets the best
        for half in range(2):
            is_left = (half == 1) == near_first
            steps[n_waiting, 0] = left if is_left else middle
            steps[n_waiting, 1] = middle if is_left else right
            ends[n_waiting, 0] = low if is_left else at_middle
            ends[n_waiting, 1] = at_middle if is_left else high
            n_waiting += 1


@kernel
def pair_minima(surface, world, travel, gaps, steps, faces, points, tally):
    """Fills for each pair its least clearance [m] over all steps, the first such step, faces and points."""
    scratch = new_scratch()
    fronts = no_fronts(len(world.pairs), 0)
    for pair in range(len(world.pairs)):
        probe = Probe(gaps[pair : pair + 1], steps[pair : pair + 1], faces[pair], points[pair], scratch, fronts)
        probe.gap[0] = np.inf
        probe.step[0] = len(world.poses)
        probe.faces[:] = NO_FACE
        _search(surface, world, pair, travel, probe, tally)
