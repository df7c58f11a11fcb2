"""Links that one joint joins, which are excused since most touch always: those that meet or come below their fail
limit, and are farther apart at home or at first. Links that an SRDF calls `Adjacent` count, whatever joins them.
So do those that it calls `Default`, which says that they touch at home, and that do not.

How two such links lie depends on the position of their joint alone. From a position at which they are separate the
joint goes on by their distance over the farthest point's arm, as often as they are farther apart than `GAP`. So no
position passed meets, and the way between samples counts too. A joint of several degrees of freedom, and several
joints, are checked at the steps only. Not for: pairs that are measured, and pairs that an SRDF excuses by another
reason.

Source of the advancement: Mirtich 1996.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from clearance.query.pair_query import Query
from clearance.tolerance import REACH
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.collision_matrix import ADJACENT, DEFAULT, PARENT
from clearance.world.cubic import Cubics, cubics_of, extremes_between
from clearance.world.extents import metres
from clearance.world.kinematic_chain import chain_between
from clearance.world.motion import Motion
from clearance.world.notice import Notice, Severity, listed
from clearance.world.pairs import BodyIndex, names_of
from clearance.world.phase import Phase
from clearance.world.robot import JointKind, Robot
from clearance.world.self_pairs import self_pairs

APART = 5e-3
"""[m] Links that are nearer than this at home and at first are joined there: they may touch as the joint turns."""

GAP = 1e-5
"""[m] Links that come as near are taken to touch."""

AT_ONCE = 4096
"""Positions whose frames are held together."""

REMEDY = (
    "such pairs are not measured; an SRDF that does not excuse them has them measured, "
    "and an `allow` row says that it is meant"
)


class Neighbours:
    """Two links that one joint joins, at any positions of it.

    Args:
        a, b: the one above and the one below. names: of both, as warnings have them.
        fail: [m] below which they fail their limit, were they measured. paddings: [m] of both.

    Attributes:
        joints: the names of what moves one against the other: one, or the parts of a joint of several degrees of
            freedom; a joint that follows another counts as the one that it follows.
        home: (k,) [rad or m] where the robot's own file has these, else 0, within their limits.
    """

    def __init__(
        self,
        robot: Robot,
        a: Body,
        b: Body,
        names: str = "",
        fail: float = 0.0,
        paddings: float = 0.0,
    ) -> None:
        self._names = names
        self.fail, self.paddings = fail, paddings
        self._chain = chain_between(robot, a.name, b.name)
        self._query = Query(a.shape, b.shape)
        self.joints = tuple(joint.name for joint in self._chain.masters)
        given = [robot.reference.get(name, 0.0) for name in self.joints]
        self.home = np.clip(given, *self._chain.ranges.T)
        self._corners = b.shape.box_corners

    def gaps(self, positions: np.ndarray) -> np.ndarray:
        """(n,) [m] the distances of the links at positions (n, k) of the joints [rad or m]."""
        parts = (
            self._query.distances(None, self._chain.frames(part)[:, -1]).distances
            for part in np.array_split(positions, 1 + len(positions) // AT_ONCE)
        )
        return np.concatenate([*parts])

    @property
    def is_by_one_joint(self) -> bool:
        """True if one joint of one degree of freedom moves one against the other."""
        return len(self._chain.joints) == 1

    @cached_property
    def gap_at_home(self) -> float:
        """[m]"""
        return float(self.gaps(self.home[None])[0])

    @property
    def is_apart_at_home(self) -> bool:
        """False for two that are joined there: they may touch as the joint turns."""
        return self.gap_at_home > APART

    def meets_at(self, positions: np.ndarray) -> Notice | None:
        """A warning if two that are apart at home meet at one of the positions (n, k) [rad or m]."""
        touching = np.flatnonzero(self.gaps(positions) <= GAP)
        if not len(touching):
            return None
        return self.notice(f"{self.at_home}, touch at {self.in_words(positions[touching[0]])}")

    def notice(self, text: str) -> Notice:
        """A warning of where they are apart and where they meet."""
        return Notice(Severity.WARNING, "neighbours", f"{self._names}, {text}: {REMEDY}")

    @property
    def at_home(self) -> str:
        """How far they are apart there, in words."""
        return f"{metres(self.gap_at_home)} m apart at home ({self.in_words(self.home)})"

    def in_words(self, positions: np.ndarray) -> str:
        """Positions (k,) of the joints."""
        kinds = [joint.kind for joint in self._chain.masters]
        units = ["m" if kind is JointKind.PRISMATIC else "rad" for kind in kinds]
        found = zip(self.joints, positions, units, strict=True)
        return listed([f"{name} = {value:.4g} {unit}" for name, value, unit in found], 6)

    def free_until(self, start: float, end: float, within: float = 0.0) -> float:
        """The position up to which the links of one joint stay farther apart than `within` [m], from start to end.

        Exactness: no position before it comes within. It is `end`, or the links are within, or farther apart by
        no more than `GAP`.
        """
        at, way, arm = start, math.copysign(1.0, end - start), self._arm()
        while (end - at) * way > 0.0:
            gap = float(self.gaps(np.array([[at]]))[0]) - within
            if gap <= GAP:
                return at
            at += way * min((gap - 0.5 * GAP) / arm, 2.0 * REACH)
        return end

    def free_range(self) -> tuple[float, float]:
        """From where to where one joint can go from home within its limits so that the links stay apart.

        It is infinite where nothing limits it, the links included.
        """
        (joint,) = self._chain.joints
        farthest = 2.0 * np.pi / max(abs(joint.factor), 1e-9) if joint.turns else REACH
        home, found = float(self.home[0]), []
        for limit, way in zip(self._chain.ranges[0].tolist(), (-1.0, 1.0), strict=True):
            end = limit if abs(limit - home) < farthest else home + way * farthest
            free = self.free_until(home, end)
            found.append(limit if free == end else free)
        return found[0], found[1]

    def _arm(self) -> float:
        """[m per rad, or -] How far no point of the second link goes at most for each unit of one joint."""
        (joint,) = self._chain.joints
        corners = self._corners @ self._chain.end[:3, :3].T + self._chain.end[:3, 3]
        away = np.linalg.norm(np.cross(corners, joint.axis), axis=1).max() if joint.turns else 1.0
        return max(abs(joint.factor) * float(away) * (1.0 + 1e-9), 1e-12)


def excused_neighbours(case: Case, i_robot: int) -> Iterator[Neighbours]:
    """The pairs of links that are excused as neighbours, or falsely as touching at home, and by nothing else."""
    placed = case.robots[i_robot]
    asked = placed.self_clearance
    number = {body.name: BodyIndex(i_robot, k) for k, body in enumerate(placed.robot.bodies)}
    for one in self_pairs(placed.robot, asked.matrix) if asked else ():
        pair = number[one.link_a], number[one.link_b]
        if one.excused not in (ADJACENT, DEFAULT, PARENT):
            continue
        if not {one.link_a, one.link_b}.isdisjoint(placed.exclude_links):
            continue
        names = [names_of(case, body) for body in pair]
        if not any(row.matches(*names) for row in case.allow if not row.when):
            a, b = (body.body_in(case) for body in pair)
            shown = " - ".join(body.name_in(case) for body in pair)
            paddings = sum(body.padding_in(case) for body in pair) + case.path_error
            default = one.excused == DEFAULT
            shown = f"links {shown}, excused as {DEFAULT}" if default else f"neighbours {shown}"
            found = Neighbours(placed.robot, a, b, shown, max(_fails(case, names)), paddings)
            if not default or found.is_apart_at_home:
                yield found


def _fails(case: Case, names: Sequence[tuple[str, ...]]) -> Iterator[float]:
    """[m] the fail limits that a pair has at some time."""
    for i, rule in reversed([*enumerate(case.limits.rules, start=1)]):
        if rule.matches(*names):
            yield case.limits.of_rule(i).fail
            if not rule.when:
                return
    yield case.limits.fail


def neighbours_that_meet(phases: Sequence[Phase]) -> Iterator[Notice]:
    """A warning on each pair of neighbours that meet in the run, or come below their fail limit, and are apart, or
    above it, at home or at the first step."""
    case = phases[0].case
    for i in range(len(case.robots)):
        motions = [phase.motions[i] for phase in phases if i not in phase.absent_robots]
        for pair in excused_neighbours(case, i) if motions else ():
            text = _meeting(pair, motions, 0.0, "touch")
            if not text and pair.fail > 0.0:
                come = f"come below their fail limit of {pair.fail * 1e3:g} mm"
                text = _meeting(pair, motions, pair.fail + pair.paddings, come)
            if text:
                yield pair.notice(text)


def _meeting(pair: Neighbours, motions: Sequence[Motion], within: float, come: str) -> str:
    """Where two neighbours are apart and come within [m], in words; empty if they are not, or do not."""
    first, apart_from = _positions(pair, motions[0])[0], max(within + GAP, APART)
    at_first = float(pair.gaps(first[None])[0])
    if max(at_first, pair.gap_at_home) <= apart_from:
        return ""
    apart = f"{metres(at_first)} m apart at first" if at_first > apart_from else pair.at_home
    if at_first <= within + GAP:
        return f"{apart}, {come} at the first step already, at {pair.in_words(first)}"
    found = _first_within(pair, motions, first, within)
    if found is None:
        return ""
    position, time, how = found
    return f"{apart}, {come}{how} at {pair.in_words(position)}, at {time:.3f} s"


def _positions(pair: Neighbours, motion: Motion) -> np.ndarray:
    """(n, k) of the joints between two neighbours at the steps."""
    return motion.positions[:, [motion.joint_names.index(name) for name in pair.joints]]


def _first_within(
    pair: Neighbours, motions: Sequence[Motion], first: np.ndarray, within: float
) -> tuple[np.ndarray, float, str] | None:
    """Where, when [s] and how well known two neighbours that are farther apart at first come within [m]."""
    if not pair.is_by_one_joint:
        for motion in motions:
            positions = _positions(pair, motion)
            touching = np.flatnonzero(pair.gaps(positions) <= within + GAP)
            if len(touching):
                return positions[touching[0]], float(motion.times[touching[0]]), " at a step,"
        return None
    i_joint = motions[0].joint_names.index(pair.joints[0])
    ends = [_ends_between(motion, i_joint) for motion in motions]
    low, high = min(one.min() for one, _ in ends), max(one.max() for _, one in ends)
    start = float(first[0])
    free = tuple(pair.free_until(start, float(end), within) for end in (low, high))
    for motion, (least, greatest) in zip(motions, ends, strict=True):
        leaves = np.flatnonzero((least < free[0]) | (greatest > free[1]))
        if len(leaves):
            time, position = _leaving(motion, i_joint, int(leaves[0]), (free[0], free[1]))
            return np.array([position]), time, f" (accuracy {GAP * 1e3:g} mm)"
    return None


def _ends_between(motion: Motion, i_joint: int) -> tuple[np.ndarray, np.ndarray]:
    """(n,) least and greatest position of a joint from each step to the next, and at the last."""
    column = motion.positions[:, i_joint : i_joint + 1]
    after = np.vstack([column[1:], column[-1:]])
    ends = np.minimum(column, after), np.maximum(column, after)
    if motion.velocities is not None and len(column) > 1:
        between = extremes_between(
            motion.times, column, motion.velocities[:, i_joint : i_joint + 1]
        )
        ends[0][:-1], ends[1][:-1] = between
    return ends[0][:, 0], ends[1][:, 0]


def _leaving(
    motion: Motion, i_joint: int, step: int, span: tuple[float, float]
) -> tuple[float, float]:
    """[s] and [rad or m] when and where a joint leaves a span at or after a step, before the next one."""
    position = float(motion.positions[step, i_joint])
    if not span[0] <= position <= span[1]:
        return float(motion.times[step]), position
    ends = slice(step, step + 2)
    times, positions = motion.times[ends], motion.positions[ends]
    cubics = Cubics(
        positions[:-1], np.diff(positions, axis=0), *np.zeros((2, 1, positions.shape[1]))
    )
    if motion.velocities is not None:
        cubics = cubics_of(times, positions, motion.velocities[ends])
    start, way, e0, e1 = (float(part[0, i_joint]) for part in cubics)
    found = []
    for level in span:
        roots = np.roots([e0 + e1, -2.0 * e0 - e1, way + e0, start - level])
        real = roots.real[np.abs(roots.imag) < 1e-6]
        found += [(share, level) for share in real.tolist() if 0.0 < share <= 1.0]
    share, level = min(found, default=(1.0, float(positions[1, i_joint])))
    return float(times[0] + share * (times[1] - times[0])), level
