"""The poses in the middle of a part of an interval, and the motion of joints about it with wrong clocks.

Let the clock of a joint be wrong by up to d. At any time of the part from t0 to t1 the joint is where its path is
at some time from t0 - d to t1 + d. Before its path begins and after it ends it stands. Not for: the errors
(`rows`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags2, Floats
from clearance.compile.decorators import inline
from clearance.kernels.budget.levers import bow_of
from clearance.kernels.motion.interval_middle import IntervalMiddle
from clearance.kernels.motion.joint_path import ANGLE, OUTWARD, part_of, part_of_arc
from clearance.kernels.motion.kinematics import NO_PARENT, place_by_joint


class Middle(NamedTuple):
    """A state of the links, and their motion about it.

    Attributes:
        state: positions, swings, bends and poses of all links.
        turned: (links,) [rad] the turn of ball joints by wrong clocks.
        marks: (links, 2) by `WANTED` True for links that carry a body, all others are ignored; by `MOVES` True for
            links whose pose differs from the last state.
    """

    state: IntervalMiddle
    turned: Floats
    marks: Flags2


WANTED, MOVES = 0, 1


@inline
def new_middle_of(n_links):
    """A state without poses yet."""
    return Middle(
        IntervalMiddle(
            np.zeros(n_links), np.zeros(n_links), np.zeros(n_links), np.zeros((n_links, 4, 4))
        ),
        np.zeros(n_links), np.zeros((n_links, 2), dtype=np.bool_),
    )  # fmt: skip


@inline
def begin_middle(world, middle):
    """Marks the links that carry the bodies of a world; none has a pose yet."""
    middle.marks[:, WANTED] = False
    middle.state.positions[:] = math.nan
    for body in range(len(world.frames)):
        link = world.frames[body]
        while link >= 0 and not middle.marks[link, WANTED]:
            middle.marks[link, WANTED] = True
            link = world.links.parents[link]


@inline
def _position(path, step, link, share):
    """The position of a joint, and the greatest deviation of its path from linear motion in the interval."""
    return part_of(path, step, link, share, share).middle, bow_of(path, step, link)


@inline
def _interval_at(path, step, time):
    """The interval that a time is in, or the path's first or last one, sought from `step`."""
    last = len(path.times) - 2
    while step > 0 and path.times[step] > time:
        step -= 1
    while step < last and path.times[step + 1] <= time:
        step += 1
    return step


@inline
def _share_at(path, step, time):
    length = path.times[step + 1] - path.times[step]
    return min(1.0, max(0.0, (time - path.times[step]) / length)) if length > 0.0 else 0.0


@inline
def _widen(path, step, low, high, link, delay, state):
    """The swing and bend of one joint over the part, and `delay` [s] before and after it."""
    start = path.times[step]
    length = path.times[step + 1] - start
    begin, end = start + low * length - delay, start + high * length + delay
    at = 0.5 * (begin + end)
    half = 0.5 * (end - begin)
    first, last = _interval_at(path, step, begin), _interval_at(path, step, end)
    before, _ = _position(path, first, link, _share_at(path, first, begin))
    after, _ = _position(path, last, link, _share_at(path, last, end))
    middle = state.positions[link]
    swing = 0.5 * (after - before)
    bend = max(abs(before + swing - middle), abs(after - swing - middle))
    for k in range(first, last + 1):
        for side in range(2):
            time = max(begin, path.times[k]) if side == 0 else min(end, path.times[k + 1])
            here, bow = _position(path, k, link, _share_at(path, k, time))
            s = (time - at) / half
            bend = max(bend, abs(here - middle - s * swing) + 2.0 * bow)
    state.swing[link] = swing * OUTWARD
    state.bend[link] = bend * OUTWARD + 2.0**-48 * (abs(before) + abs(after) + abs(middle))


@inline
def _turned_by_arcs(path, step, low, high, ball, delay):
    """[rad] the turn of a ball joint in the time of its clock's error, before or after the part."""
    start = path.times[step]
    length = path.times[step + 1] - start
    most = 0.0
    for side in range(2):
        end = start + low * length if side == 0 else start + high * length + delay
        begin = end - delay
        angle = 0.0
        for k in range(_interval_at(path, step, begin), _interval_at(path, step, end) + 1):
            share = _share_at(path, k, end) - _share_at(path, k, begin)
            angle += share * path.balls.arcs[k, ball, ANGLE]
        most = max(most, angle)
    return most * OUTWARD + 2.0**-45


@inline
def _place(links, path, step, low, high, middle):
    """Writes the motion of the joints of wanted links, and the poses of links that have moved."""
    state, marks = middle.state, middle.marks
    for link in range(len(links.parents)):
        if marks[link, WANTED]:
            part = part_of(path, step, link, low, high)
            marks[link, MOVES] = state.positions[link] != part.middle
            state.positions[link], state.swing[link] = part.middle, part.swing
            state.bend[link] = part.bend
    for ball in range(len(path.balls.links)):
        link = path.balls.links[ball]
        arc = part_of_arc(path.balls, step, ball, low, high)
        state.positions[link], state.swing[link] = arc.middle, arc.swing
        marks[link, MOVES] = True  # its axis may be another
    for link in range(len(links.parents)):
        if marks[link, WANTED]:
            parent = links.parents[link]
            above = parent != NO_PARENT and marks[parent, MOVES]
            marks[link, MOVES] = marks[link, MOVES] or above
            if marks[link, MOVES]:
                place_by_joint(links, link, state.positions, state.poses)


@inline
def go_to_part(links, path, errors, step, low, high, middle):
    """Puts `middle` in the middle of the part `low` to `high` (0 to 1) of the interval after `step`."""
    state = middle.state
    _place(links, path, step, low, high, middle)
    for link in range(len(links.parents)):
        if errors.delay[link] > 0.0 and links.columns[link] >= 0:
            _widen(path, step, low, high, link, errors.delay[link], state)
    for ball in range(len(path.balls.links)):
        link = path.balls.links[ball]
        if errors.delay[link] > 0.0:
            part = 0.5 * (high - low) * path.balls.arcs[step, ball, ANGLE]
            state.swing[link], state.bend[link] = part * OUTWARD, 0.0
            middle.turned[link] = _turned_by_arcs(path, step, low, high, ball, errors.delay[link])


@inline
def half_of(path, step, low, high):
    """[s] half of a part of the interval after a step."""
    return 0.5 * (high - low) * (path.times[step + 1] - path.times[step])
