"""What no change can reach: the least size below which no change of a kind brings all pairs far enough apart.

A translation by t changes no distance by more than t; to part bodies that overlap and bring them d apart takes
the depth and d. Joints that are off by w_k move no point of a body farther than the sum of w_k r_k, r_k the
farthest that it gets from joint k in any pose (`kernels.motion.interval_motion_bound`). Not for: what can be
reached (`search`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.gains.offsets import JointOffsets
from clearance.gains.path_change import PathChange
from clearance.gains.shift import Shift
from clearance.gains.shortfalls import State
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING
from clearance.simulate.answers.approaches import Approach
from clearance.world.case import Case
from clearance.world.forest import WORLD, carried_by, forest_of
from clearance.world.joint_positions import JointCourse, extremes_of, joint_courses
from clearance.world.mimics import followers
from clearance.world.pairs import BodyIndex
from clearance.world.placed_robot import PlacedRobot

INWARD = 1.0 - 2.0**-16
"""Covers the rounding of what is summed here."""


def least_shift(shift: Shift, state: State, margin: float) -> float:
    """[m] No smaller shift, with its turn, makes the rules hold by a margin, whatever its direction."""
    least = 0.0
    for approach in state.near:
        moves = shift.gradient(approach) is not None and not shift.transfers.has(approach)
        if moves and shift.is_of_place(approach):
            sizes = way_needed(approach, margin) / shift.factors(approach)
            least = max(least, float(sizes.max(initial=0.0)))
    return INWARD * least


def least_offset(offsets: PathChange, state: State, margin: float) -> float:
    """[rad] In no smaller change the rules hold by a margin, however the joints move together."""
    least = 0.0
    for approach in state.near:
        way = sum(_way_of_unit(part, approach) for part in offsets.parts)
        if way > 0.0 and not offsets.transfers.has(approach):
            least = max(least, float(way_needed(approach, margin).max(initial=0.0)) / way)
    return INWARD * least


def way_needed(approach: Approach, margin: float) -> np.ndarray:
    """(k,) [m] how far the bodies must at least be moved against each other."""
    depths, padding = approach.depths_at_least, approach.section.padding
    clearances = np.where(depths > 0.0, 0.0, approach.clearances + padding)
    return approach.rule.limits.least_kept + margin + padding - clearances + depths


def _way_of_unit(offsets: JointOffsets, approach: Approach) -> float:
    """[m] How far both bodies move against each other at most where every joint is off by one unit."""
    radii = sum(motion_radii(approach.case, body)[offsets.columns] for body in approach.pair)
    return float((radii / offsets.weights).sum())


def motion_radii(case: Case, body: BodyIndex, *, as_they_are: bool = False) -> np.ndarray:
    """(columns,) how far the unit of each column can move a point of a body [m per rad or m].

    In any pose that the limits of the joints allow and any that they are in, or only in those that they are in.
    """
    forest = forest_of(case)
    links = forest.links
    radii = np.zeros(int(links.columns.max(initial=-1)) + 1)
    frame = body.frame_in(case)
    if frame == WORLD:
        return radii
    beyond = float(np.linalg.norm(np.abs(body.shape_in(case).bounds).max(axis=0)))
    for link in carried_by(forest, frame):
        if links.parents[link] == NO_PARENT:
            break
        kind, column = links.kinds[link], links.columns[link]
        if kind in (TURNING, SLIDING):
            arm = beyond if kind == TURNING else 1.0
            radii[column] += abs(links.factors[link]) * arm
        beyond += float(np.linalg.norm(links.parent_from_joint[link][:3, 3]))
        if kind == SLIDING:
            beyond += _longest_slide(case, link, as_they_are=as_they_are)
    return radii


def _longest_slide(case: Case, link: int, *, as_they_are: bool) -> float:
    """[m] How far the joint above a link of a robot slides at most; infinite for what a table of poses moves."""
    forest = forest_of(case)
    starts: Sequence[int] = forest.robot_starts
    for placed, start in zip(case.robots, starts, strict=True):
        if start <= link < start + len(placed.robot.link_names):
            child = placed.robot.link_names[link - start]
            course = next(one for one in joint_courses(placed) if one.joint.child == child)
            ends = [course.at_samples, *(extremes_of(course, placed.trajectory) or ())]
            far = max(float(np.abs(one).max()) for one in ends)
            return far if as_they_are else max(far, _longest_in_range(placed, course))
    return float("inf")


def _longest_in_range(placed: PlacedRobot, course: JointCourse) -> float:
    """[m] How far a slide is out where the joint that moves it is anywhere within its limits."""
    moved = next(one for one in followers(placed.robot) if one.joint.name == course.joint.name)
    joint = next(one for one in placed.robot.joints if one.name == moved.master)
    if moved.factor == 0.0:
        return abs(moved.offset)
    return max(abs(moved.factor * end + moved.offset) for end in (joint.lower, joint.upper))
