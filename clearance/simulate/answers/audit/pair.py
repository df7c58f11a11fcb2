"""Whether two links of one robot can ever meet within their joints' limits, by branch and bound.

Poses all over the joints' ranges are checked first, and the nearest followed downhill: most pairs that can
meet are seen to. Of the others, a box of positions that no bound proves disjoint is halved, across the joint that
moves most, until all are proven disjoint, or one is so small that the links come within `GAP` there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from clearance.progress import Progress
from clearance.query.pair_query import Query
from clearance.record.audit import ExcusedPair, PairFinding, PairStatus, ProposedPair
from clearance.simulate.answers.audit.joint_box import (
    BoxDistances,
    BoxMotion,
    JointBox,
    PositionBoxes,
)
from clearance.simulate.measure.neighbours import Neighbours
from clearance.world.collision_matrix import ADJACENT, NEVER, CollisionMatrix
from clearance.world.kinematic_chain import KinematicChain, chain_between
from clearance.world.robot import JointKind, Robot
from clearance.world.self_pairs import RIGID, SelfPair, self_pairs

GAP = 1e-4
"""[m] Links that come nearer than this without being seen to meet may stay undecided."""

ENOUGH = 0.5 * GAP
"""[m] A box is proven where the links keep this separation."""

SHARE = 0.25
"""Of the least distance seen: so much is proven of a pair that stays disjoint, as far as the boxes reach."""

MOST_BOXES = 400_000
"""Of one pair; what is then open stays undecided, and is said to be."""

AT_ONCE = 512
"""Boxes that are visited together."""

N_SAMPLES = 512
"""Poses that are checked first."""

N_STARTS = 8
"""Of the nearest of them, from which the search goes downhill."""

MOST_STEPS = 40
"""Of one way downhill."""


def audit_pair(robot: Robot, link_a: str, link_b: str, most_boxes: int = MOST_BOXES) -> PairFinding:
    """Whether two links with geometry can meet, at any positions of the joints between them.

    Joints that follow others are where these take them, all within their limits. Joints without limits are
    checked over a turn.
    """
    search = _Search(robot, link_a, link_b)
    status, lower_bound, why = search.answer(most_boxes)
    names = [joint.name for joint in search.chain.masters]
    positions = dict(zip(names, search.nearest_at.tolist(), strict=True))
    return PairFinding(
        link_a, link_b, status, lower_bound, search.least, positions, search.n_boxes, why
    )


class _Search:
    """One pair, and the nearest that was seen of it."""

    def __init__(self, robot: Robot, link_a: str, link_b: str) -> None:
        shapes = {body.name: body.shape for body in robot.bodies}
        self.chain = chain_between(robot, link_a, link_b)
        self._query = Query(shapes[link_a], shapes[link_b])
        self._box = JointBox.of(self.chain, shapes[link_a], shapes[link_b])
        self.least, self.nearest_at = math.inf, np.zeros(len(self.chain.masters))
        self.n_boxes = 0
        self._in_doubt = False

    def answer(self, most_boxes: int) -> tuple[PairStatus, float, str]:
        """What is known of the pair, [m] a proven lower bound, and why it is undecided."""
        ranges, why = _ranges(self.chain)
        if why:
            self._measure(np.zeros((1, len(ranges))))
            return PairStatus.UNDECIDED, 0.0, why
        whole = PositionBoxes(ranges.mean(axis=1)[None], 0.5 * np.ptp(ranges, axis=1)[None])
        self._measure_samples(whole)
        lower_bound, why = self._proven(whole, most_boxes) if self.least > 0.0 else (0.0, "")
        if self.least <= 0.0:
            return PairStatus.MEETS, 0.0, ""
        if self._in_doubt:
            why = "a surface is open, so inside and outside cannot be distinguished"
        if why:
            return PairStatus.UNDECIDED, 0.0, why
        return PairStatus.APART, float(min(lower_bound, self.least)), ""

    def _measure(self, positions: np.ndarray) -> BoxDistances:
        """Measures the pair at n positions (n, k)."""
        frames = self.chain.frames(positions)
        found = self._query.distances(None, frames[:, -1])
        self._in_doubt |= bool(found.undecided.any())
        i = int(np.argmin(found.distances))
        if found.distances[i] < self.least:
            self.least, self.nearest_at = float(found.distances[i]), positions[i].copy()
        return BoxDistances(found.distances, found.points, frames)

    def _measure_samples(self, whole: PositionBoxes) -> None:
        """Measures poses all over the box, and goes downhill from the nearest."""
        positions = _spread(whole, N_SAMPLES if self.chain.masters else 1)
        distances = self._measure(positions).distances
        for i in np.argsort(distances, kind="stable")[:N_STARTS]:
            if self.least > 0.0:
                self._go_downhill(positions[i], whole)

    def _go_downhill(self, at: np.ndarray, whole: PositionBoxes) -> None:
        """Follows the slope of the distance from one pose, within the box, as long as it falls."""
        low, high = whole.middle[0] - whole.half[0], whole.middle[0] + whole.half[0]
        seen, step = self._measure(at[None]), 1.0
        for _ in range(MOST_STEPS):
            distance = seen.distances[0]
            if distance <= 0.0 or step < 1e-3:
                return
            slope = self._box.slopes(seen)[0]
            slope[((at <= low) & (slope > 0.0)) | ((at >= high) & (slope < 0.0))] = 0.0
            if not slope.any():
                return
            there = np.clip(at - step * 1.5 * distance / (slope @ slope) * slope, low, high)
            seen_there = self._measure(there[None])
            if seen_there.distances[0] < distance:
                at, seen, step = there, seen_there, min(1.0, 2.0 * step)
            else:
                step *= 0.25

    def _proven(self, whole: PositionBoxes, most_boxes: int) -> tuple[float, str]:
        """[m] a lower bound over the box, and why there is none; given up where the links are seen to meet."""
        waiting, lower_bound = [whole], math.inf
        while waiting and self.least > 0.0:
            boxes = waiting.pop()
            if len(boxes.middle) > AT_ONCE:
                waiting.append(boxes.of(slice(AT_ONCE, None)))
                boxes = boxes.of(slice(AT_ONCE))
            bounds, motion = self._bounds(boxes)
            open_ones = bounds <= max(ENOUGH, SHARE * self.least)
            lower_bound = min(lower_bound, bounds[~open_ones].min(initial=math.inf))
            near = np.flatnonzero(open_ones & (motion.way <= ENOUGH))
            if len(near):
                self._go_downhill(boxes.middle[near[0]], whole)
                return 0.0, f"they come within {GAP * 1e3:g} mm of each other"
            if open_ones.any():
                waiting.append(boxes.of(open_ones).halved(motion.share[open_ones]))
            if waiting and self.n_boxes >= most_boxes:
                return 0.0, f"not settled by {self.n_boxes} boxes of joint positions"
        return lower_bound, ""

    def _bounds(self, boxes: PositionBoxes) -> tuple[np.ndarray, BoxMotion]:
        """(n,) [m] lower bounds on the distance over each box, and how far the second link moves there."""
        self.n_boxes += len(boxes.middle)
        seen = self._measure(boxes.middle)
        motion = self._box.motion(boxes.half, seen.frames)
        bounds = seen.distances - motion.way - self._box.slack
        wanted = max(ENOUGH, SHARE * self.least)
        maybe = np.flatnonzero((bounds <= wanted) & (seen.distances > motion.rest))
        if len(maybe):
            separation = self._box.first_order_separation(boxes.half[maybe], seen.of(maybe))
            bounds[maybe] = np.maximum(
                bounds[maybe], separation - motion.rest[maybe] - self._box.slack
            )
        return bounds, motion


def _ranges(chain: KinematicChain) -> tuple[np.ndarray, str]:
    """(k, 2) from where to where each free joint is checked, and why that is not known."""
    ranges = chain.ranges.copy()
    for column, joint in enumerate(chain.masters):
        low, high = ranges[column]
        if low > high:
            return (
                ranges,
                f"no position of {joint.name!r} keeps the limits of all joints that follow it",
            )
        if not math.isfinite(high - low):
            if not _is_round(chain, column):
                how = "slides" if joint.kind is JointKind.PRISMATIC else "moves others"
                return ranges, f"a joint between them {how} without limits"
            ranges[column] = -math.pi, math.pi
    return ranges, ""


def _is_round(chain: KinematicChain, column: int) -> bool:
    """True if all that a free joint moves is as it was after a turn of it."""
    own = [joint for joint in chain.joints if joint.column == column]
    return all(joint.turns and joint.factor == round(joint.factor) for joint in own)


def _spread(whole: PositionBoxes, n: int) -> np.ndarray:
    """(n, k) positions all over a box, the same each time; the first is its middle."""
    from scipy.stats import qmc

    k = whole.middle.shape[1]
    unit = qmc.Halton(k, scramble=False).random(n) if k else np.zeros((n, 0))
    unit[0] = 0.5
    return whole.middle + whole.half * (2.0 * unit - 1.0)


def audit(
    robot: Robot, matrix: CollisionMatrix, progress: Progress | None = None
) -> list[ExcusedPair]:
    """Every pair of links with geometry that the matrix excuses, and whether it can ever meet."""
    excused = [
        pair
        for pair in self_pairs(robot, matrix, trust_never=True)
        if pair.excused not in (None, RIGID)
    ]
    return [_excused(robot, pair) for pair in _each(excused, progress)]


def propose(robot: Robot, progress: Progress | None = None) -> list[ProposedPair]:
    """What can be excused of every pair that moves: neighbours that are joined, and what is proven never to meet.

    Neighbours that are apart at home, and are not proven to stay so, are to be measured.
    """
    pairs = [pair for pair in self_pairs(robot) if pair.excused != RIGID]
    return [_proposed(robot, pair) for pair in _each(pairs, progress)]


def _each(pairs: list[SelfPair], progress: Progress | None) -> Iterator[SelfPair]:
    """The pairs; progress is reported after each."""
    for i, pair in enumerate(pairs, start=1):
        yield pair
        if progress:
            progress(i, len(pairs))


def _is_apart_at_home(robot: Robot, pair: SelfPair) -> bool:
    bodies = {body.name: body for body in robot.bodies}
    return Neighbours(robot, bodies[pair.link_a], bodies[pair.link_b]).is_apart_at_home


def _excused(robot: Robot, pair: SelfPair) -> ExcusedPair:
    finding = audit_pair(robot, pair.link_a, pair.link_b)
    joined = pair.excused == ADJACENT and not _is_apart_at_home(robot, pair)
    return ExcusedPair(str(pair.excused), finding, joined)


def _proposed(robot: Robot, pair: SelfPair) -> ProposedPair:
    if pair.excused == ADJACENT and not _is_apart_at_home(robot, pair):
        return ProposedPair(pair, ADJACENT, None)
    finding = audit_pair(robot, pair.link_a, pair.link_b)
    if pair.excused == ADJACENT and finding.status is PairStatus.APART:
        return ProposedPair(pair, ADJACENT, None)
    return ProposedPair(pair, NEVER if finding.status is PairStatus.APART else None, finding)
