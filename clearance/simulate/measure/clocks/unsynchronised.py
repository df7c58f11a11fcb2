"""How close two motions come whose clocks nothing ties, or only to within a slack: at steps, and proven between.

Robots of two controllers start at unknown times, or drift: then every time of the one can occur with every time of
the other that is at most the slack away. For each step, and each interval, of the first clock this asks for the
least distance over all such times of the second. Not for: robots on one clock (`measure`, `certify`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from clearance.kernels.clocks.clock_rectangles import Band
from clearance.kernels.clocks.clock_tree import (
    ClockTree,
    fill_clock_tree,
    new_clock_tree,
)
from clearance.kernels.clocks.two_clocks import TwoClocks
from clearance.kernels.clocks.unsynchronised import (
    StepsOfClock,
    TwoClockBounds,
    certify_unsynchronised,
)
from clearance.kernels.clocks.unsynchronised_steps import (
    StepMinima,
    least_of_unsynchronised_steps,
)
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.twist import CertificateGoal
from clearance.kernels.motion.world import World
from clearance.ordered import ascending
from clearance.query.distance import distance
from clearance.record.moment import Moment
from clearance.record.names import pair_names
from clearance.simulate.measure.certify import (
    joint_path,
    no_finer_than_rounding,
    with_turning_balls,
)
from clearance.simulate.measure.clocks.pairs import ClockMotion, PairsOfTwoClocks, actor_of
from clearance.simulate.measure.layout import lay_out, with_whole_faces
from clearance.simulate.measure.moment_query import as_seen
from clearance.simulate.measure.refine import FINER
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources, in_order, parts
from clearance.tolerance import FINEST_CERTIFY_GAP
from clearance.world.forest import forest_of, positions_between
from clearance.world.notice import Notice
from clearance.world.pairs import BodyIndex
from clearance.world.reach import farthest_reach

COUNTERS = ("rectangles", "apart_by_boxes", "queries", "node_tests", "polygon_tests")

MOST_RECTANGLES = 2**22
"""Rectangles of one interval after which its gap is widened: about a minute. A step of an arm takes tens."""

MOST_AGAIN, MOST_DECIDING = 2**13, 2**18
"""Rectangles of one interval after which a finer gap is widened, and of all together: about five seconds."""

TIME_ROUNDING = 2.0**-48
"""Rounding of a time in an interval, relative to the greatest time and the slack: some operations, with margin."""


@dataclass(frozen=True, eq=False)
class UnsynchronisedAnswers:
    """What is known of two clocks' motions.

    Attributes:
        gap: [m] how far lower bounds may be below the upper bounds.
        steps: the least of each step of the first clock over all steps of the second in the band; ties go to the
            least pair, then to the least step of the second clock. Where there is none, the pair is -1.
        intervals: what is proven of each interval of the first clock over all times of the second in the band; not
            there where only the steps were checked.
        tally: counters by name, of the steps and of the intervals.
        moment_of: the moment of an interval at which its upper bound was seen.
    """

    gap: float
    steps: StepMinima
    intervals: TwoClockBounds | None
    steps_tally: dict[str, int]
    intervals_tally: dict[str, int]
    moment_of: Callable[[int], Moment] = field(repr=False)
    notices: tuple[Notice, ...] = ()


def least_unsynchronised(
    what: PairsOfTwoClocks, gap: float | None, resources: Resources = DEFAULT_RESOURCES
) -> UnsynchronisedAnswers:
    """The least distances of pairs of two clocks.

    Args:
        gap: [m] the lower bounds are within it of a distance that occurs; None to check the steps only.
    """
    work = _Work.of(what, resources)
    steps, steps_tally = work.steps()
    if gap is None:
        return UnsynchronisedAnswers(np.inf, steps, None, steps_tally, {}, _no_moment)
    finest = [no_finer_than_rounding(side.case, side.motions, gap) for side in (what.a, what.b)]
    gap = max(gap for gap, _ in finest)
    goal = CertificateGoal(gap, what.limits.fail, MOST_RECTANGLES)
    intervals, intervals_tally = work.intervals(steps, goal)
    work.decide(steps, intervals, gap)
    return UnsynchronisedAnswers(
        gap,
        steps,
        intervals,
        steps_tally,
        intervals_tally,
        _TwoClockQuery(what, intervals).of_interval,
        tuple(dict.fromkeys(notice for _, notices in finest for notice in notices)),
    )


def least_of_all_steps(what: PairsOfTwoClocks, resources: Resources) -> StepMinima:
    """The least of all steps of the first clock, in the first row of least clearance; others may be too much."""
    return _Work.of(what, resources).steps(least_only=True)[0]


def _no_moment(interval: int) -> Moment:
    raise AssertionError("nothing is proven of intervals")


@dataclass(frozen=True, eq=False)
class _Work:
    """What all parts share. Rows of the path are the steps of clock b, then those of clock a."""

    what: PairsOfTwoClocks
    surface: Surface
    world: World
    path: JointPath
    band: Band
    bodies: tuple[np.ndarray, np.ndarray]
    columns: np.ndarray
    resources: Resources

    @staticmethod
    def of(what: PairsOfTwoClocks, resources: Resources) -> _Work:
        sides = [[actor_of(body) in what.actors_of_b for body in pair] for pair in what.pairs]
        assert sides == [[False, True]] * len(what.pairs), "two clocks move the bodies of each pair"
        layout = lay_out(what.case, what.pairs)
        world = layout.world
        bodies = np.unique(world.pairs[:, 0]), np.unique(world.pairs[:, 1])
        columns = np.zeros(len(world.frames), dtype=np.int64)
        for side in bodies:
            columns[side] = np.arange(len(side))
        of_a, of_b = ascending(what.a.times), ascending(what.b.times)
        times = np.concatenate([of_b, of_a, of_a[-1:]])
        path = joint_path(world.links, times, *what.columns())
        rounding = TIME_ROUNDING * float(np.abs(times).max() + what.slack)
        band = Band(float(what.slack), rounding if math.isfinite(rounding) else 0.0)
        return _Work(what, layout.surface, world, path, band, bodies, columns, resources)

    @property
    def n_a(self) -> int:
        return len(self.what.a.times)

    @property
    def n_b(self) -> int:
        return len(self.what.b.times)

    def steps(self, *, least_only: bool = False) -> tuple[StepMinima, dict[str, int]]:
        """The least of each step, or what is right of the least of all only."""
        n = self.n_a
        found = StepMinima(
            np.empty(n),
            np.empty(n, np.int64),
            np.empty(n, np.int64),
            np.empty((n, 2, 3)),
            np.empty(n),
        )
        tree_b = self._tree(slice(0, self.n_b), 1, of_steps=True)

        def run_part(span: slice) -> tuple[int, np.ndarray]:
            counts = np.zeros(len(COUNTERS), dtype=np.int64)
            clocks = self._clocks(self._tree(self._of_a(span), 0, of_steps=True), tree_b)
            own = StepMinima(*(column[span] for column in found))
            least_of_unsynchronised_steps(self.surface, clocks, least_only, own, counts)
            return span.stop, counts

        tally = self._tally(in_order(run_part, parts(n), self.resources.n_threads), 0)
        none = found.step_b < 0  # no step of the other clock is in the band, or none is nearer
        found.pair[none], found.points[none] = -1, np.nan
        return found, tally

    def intervals(
        self, steps: StepMinima, goal: CertificateGoal
    ) -> tuple[TwoClockBounds, dict[str, int]]:
        """What is proven of each interval."""
        n = self.n_a - 1
        numbers, places = np.empty((4, n)), np.empty((2, n), dtype=np.int64)
        bounds = TwoClockBounds(
            numbers[0], numbers[1], numbers[2], places[0], numbers[3], places[1]
        )
        tally = dict.fromkeys(COUNTERS, 0)
        if n > 0 and self.n_b > 1:
            certify = self._certifying(steps)

            def run_part(span: slice) -> tuple[int, np.ndarray]:
                own = TwoClockBounds(*(column[span] for column in bounds))
                return span.stop, certify(span, goal, own)

            tally = self._tally(in_order(run_part, parts(n), self.resources.n_threads), self.n_a)
        return bounds, tally

    def _certifying(
        self, steps: StepMinima
    ) -> Callable[[slice, CertificateGoal, TwoClockBounds], np.ndarray]:
        """Fills the bounds of some intervals for a goal; counters."""
        surface = with_whole_faces(self.surface)
        tree_b = self._tree(slice(0, self.n_b - 1), 1, of_steps=False)

        def certify(span: slice, goal: CertificateGoal, own: TwoClockBounds) -> np.ndarray:
            counts = np.zeros(len(COUNTERS), dtype=np.int64)
            tree_a = self._tree(self._of_a(span), 0, of_steps=False)
            ends = slice(span.start, span.stop + 1)
            known = StepsOfClock(steps.clearance[ends], steps.step_b[ends], steps.pair[ends])
            certify_unsynchronised(surface, self._clocks(tree_a, tree_b), known, goal, own, counts)
            return counts

        return certify

    def decide(self, steps: StepMinima, bounds: TwoClockBounds, gap: float) -> None:
        """Proves again the intervals by which a limit is open, with ever smaller gaps, as far as that is quick."""
        certify, n_rectangles = None, 0
        for goal in self._finer_goals(gap):
            is_open = (bounds.lower < goal.fail) & (bounds.upper >= goal.fail)
            for row in np.flatnonzero(is_open).tolist():
                if n_rectangles > MOST_DECIDING:
                    return
                certify = certify or self._certifying(steps)
                own = TwoClockBounds(*(column[row : row + 1].copy() for column in bounds))
                n_rectangles += certify(slice(row, row + 1), goal, own)[0]
                bounds.lower[row] = max(bounds.lower[row], own.lower[0])
                if own.upper[0] < bounds.upper[row]:
                    for column, seen in zip(bounds[1:], own[1:], strict=True):
                        column[row] = seen[0]

    def _finer_goals(self, gap: float) -> Iterator[CertificateGoal]:
        """For each limit goals that are ever finer; a clearance that is less by rounding is at the limit."""
        limits = self.what.limits
        reach = max(farthest_reach(side.case, side.motions) for side in (self.what.a, self.what.b))
        finest = FINEST_CERTIFY_GAP * reach
        for level in sorted({limits.fail, limits.warn} - {0.0}):
            finer = gap
            while finer > finest:
                finer = max(finer * FINER, finest)
                yield CertificateGoal(finer, level - limits.rounding, MOST_AGAIN)

    def _of_a(self, span: slice) -> slice:
        """The rows of the path at some steps or intervals of clock a."""
        return slice(self.n_b + span.start, self.n_b + span.stop)

    def _tree(self, span: slice, i_clock: int, *, of_steps: bool) -> ClockTree:
        bodies = self.bodies[i_clock]
        tree = new_clock_tree(span.start, span.stop - span.start, len(bodies))
        world = with_turning_balls(self.world)
        fill_clock_tree(self.surface, world, self.path, bodies, of_steps, tree)
        return tree

    def _clocks(self, tree_a: ClockTree, tree_b: ClockTree) -> TwoClocks:
        return TwoClocks(
            with_turning_balls(self.world), self.path, tree_a, tree_b, self.columns, self.band
        )

    def _tally(self, results: Iterator[tuple[int, np.ndarray]], n_before: int) -> dict[str, int]:
        """The counters of all parts, while progress is reported."""
        tally = np.zeros(len(COUNTERS), dtype=np.int64)
        for done, counts in results:
            tally += counts
            if self.resources.progress:
                self.resources.progress(n_before + done, 2 * self.n_a - 1)
        return dict(zip(COUNTERS, tally.tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class _TwoClockQuery:
    """Measures the pair of an interval at the two times at which it was seen nearest."""

    what: PairsOfTwoClocks
    intervals: TwoClockBounds

    def of_interval(self, interval: int) -> Moment:
        """The moment at which the upper bound of an interval was seen."""
        found, what, case = self.intervals, self.what, self.what.case
        pair = what.pairs[int(found.pair[interval])]
        share = float(found.share_a[interval])
        at_a, at_b = (
            (interval, share),
            (int(found.step_b[interval]), float(found.share_b[interval])),
        )
        poses = self._poses(what.a, at_a), self._poses(what.b, at_b)
        near = distance(
            pair.a.shape_in(case),
            pair.b.shape_in(case),
            pose_a=pair.a.poses_in(what.a.case, poses[0])[0],
            pose_b=pair.b.poses_in(what.b.case, poses[1])[0],
        )
        names = pair_names(case, [pair])
        positions = tuple(
            what.b.motions[i].positions_after(*at_b)
            if BodyIndex(i, 0) in what.actors_of_b
            else motion.positions_after(*at_a)
            for i, motion in enumerate(what.a.motions)
        )
        return Moment(
            step=interval + int(share == 1.0),
            time=_time(what.a, *at_a),
            between=0.0 < share < 1.0,
            link=names[0][0],
            obstacle=names[1][0],
            positions=positions,
            share=share % 1.0,
            time_b=_time(what.b, *at_b),
            **as_seen(near, bool(found.upper[interval] <= 0.0)),
        )

    @staticmethod
    def _poses(side: ClockMotion, at: tuple[int, float]) -> np.ndarray:
        columns = positions_between(side.case, side.motions, *at)
        return forest_of(side.case).poses(columns[None])


def _time(side: ClockMotion, step: int, share: float) -> float:
    before, after = side.times[step : step + 2]
    return float(before + share * (after - before))
