"""How close two motions come whose clocks nothing ties, or only to within a slack: at steps, and proven between.

Robots of two controllers start at unknown times, or drift: then every time of the one can occur with every time of
the other that is at most the slack away. For each step, and each interval, of the first clock this asks for the
least distance over all such times of the second. Not for: robots on one clock (`measure`, `certify`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from clearance.compile.kernel_table import call
from clearance.errors import BadInput, BadTime
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.certify import CertificateGoal
from clearance.kernels.motion.clock_rectangles import Band
from clearance.kernels.motion.clock_tree import (
    ClockTree,
    fill_intervals_tree,
    fill_steps_tree,
    new_clock_tree,
)
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.two_clocks import TwoClocks
from clearance.kernels.motion.unsynchronised import (
    StepsOfClock,
    TwoClockBounds,
    certify_unsynchronised,
)
from clearance.kernels.motion.unsynchronised_steps import (
    StepsFound,
    least_of_unsynchronised_steps,
)
from clearance.kernels.motion.world import World
from clearance.query.distance import distance
from clearance.simulate.certify import (
    _joint_path,
    _no_finer_than_rounding,
    _with_whole_faces,
)
from clearance.simulate.layout import lay_out
from clearance.simulate.names import pair_names
from clearance.simulate.parts import in_order, parts
from clearance.simulate.resources import DEFAULT_RESOURCES, Resources
from clearance.world.case import Case
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion
from clearance.world.notice import Notice
from clearance.world.pairs import Pair

COUNTERS = ("rectangles", "apart_by_boxes", "queries", "node_tests", "polygon_tests")

MOST_RECTANGLES = 2**22
"""Rectangles of one interval after which its gap is widened: about a minute. A step of an arm takes tens."""

TIME_ROUNDING = 2.0**-48
"""Rounding of a time in an interval, relative to the greatest time and the slack: a few operations, with room."""


@dataclass(frozen=True, eq=False)
class UnsynchronisedSteps:
    """The least clearance of each step of the first clock over all steps of the second in the band.

    Attributes:
        clearance: (n,) [m]; ties go to the least pair, then to the least step of the second clock.
        pair: (n,) which pair. step_b: (n,) the step of the second clock.
        points: (n, 2, 3) witness points in the world [m], each of its body at its own time.
    """

    clearance: np.ndarray
    pair: np.ndarray
    step_b: np.ndarray
    points: np.ndarray


@dataclass(frozen=True, eq=False)
class UnsynchronisedIntervals:
    """What is proven of each interval of the first clock over all times of the second in the band.

    Attributes:
        lower_bound: (n - 1,) [m] proven. upper_bound: (n - 1,) [m] the least distance seen.
        share_a: (n - 1,) where in the interval that was, 0 to 1.
        step_b, share_b: (n - 1,) the step of the second clock before it, and where in the interval after it.
        pair: (n - 1,) which pair.
    """

    lower_bound: np.ndarray
    upper_bound: np.ndarray
    share_a: np.ndarray
    step_b: np.ndarray
    share_b: np.ndarray
    pair: np.ndarray


@dataclass(frozen=True, eq=False)
class UnsynchronisedMoment:
    """A time of each clock, and the distance of a pair then.

    Attributes:
        time_a, time_b: [s] of the first and the second clock.
        clearance: [m] of the pair; 0 for a contact.
        link, other: the pair's bodies, of the first and of the second clock.
        points: (2, 3) witness points in the world [m].
        positions: of each robot's moving joints [rad] or [m], at the time of its clock.
    """

    time_a: float
    time_b: float
    clearance: float
    link: str
    other: str
    points: np.ndarray
    positions: tuple[np.ndarray, ...]


@dataclass(frozen=True, eq=False)
class UnsynchronisedAnswers:
    """What is known of two clocks' motions.

    Attributes:
        slack: [s]. gap: [m] how far lower bounds may be below the upper bounds.
        steps, intervals: of the first clock.
        tally: counters by name, of the steps and of the intervals.
        moment_of: the moment of an interval at which its upper bound was seen.
    """

    slack: float
    gap: float
    steps: UnsynchronisedSteps
    intervals: UnsynchronisedIntervals
    steps_tally: dict[str, int]
    intervals_tally: dict[str, int]
    moment_of: Callable[[int], UnsynchronisedMoment] = field(repr=False)
    notices: tuple[Notice, ...] = ()

    @property
    def worst(self) -> int:
        """The first interval of least upper bound."""
        return int(np.argmin(self.intervals.upper_bound))


def least_unsynchronised(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    slack: float,
    gap: float,
    resources: Resources = DEFAULT_RESOURCES,
) -> UnsynchronisedAnswers:
    """The least distances of `pairs` whose first bodies move by one clock and whose second bodies by another.

    Args:
        motions: one for each robot, with the same steps, each by its own clock.
        pairs: both bodies of each are links; no robot is on both sides.
        slack: [s] by which the clocks differ at most; infinite where nothing ties them.
        gap: [m] the lower bounds are within it of a distance that occurs.

    Raises:
        BadTime: a slack that is no time. BadInput: pairs that are not of two clocks.
    """
    if not slack >= 0.0:
        raise BadTime(f"a slack of {slack} s", valid="0 or more, or infinite")
    _require_two_clocks(pairs)
    gap, notices = _no_finer_than_rounding(case, motions, gap)
    work = _Work.of(case, motions, pairs, slack, resources)
    steps, steps_tally = work.steps()
    goal = CertificateGoal(gap, case.limits.fail, MOST_RECTANGLES)
    intervals, intervals_tally = work.intervals(steps, goal)
    moments = _Moments(case, motions, pairs, intervals)
    return UnsynchronisedAnswers(
        slack,
        gap,
        steps,
        intervals,
        steps_tally,
        intervals_tally,
        moments.of_interval,
        notices,
    )


def _require_two_clocks(pairs: Sequence[Pair]) -> None:
    first = {pair.a.i_robot for pair in pairs}
    second = {pair.b.i_robot for pair in pairs}
    if not pairs or first & second or any(pair.b.is_obstacle for pair in pairs):
        raise BadInput(
            "pairs that are not of two clocks",
            valid="links of some robots against links of other robots, one pair or more",
        )


@dataclass(frozen=True, eq=False)
class _Work:
    """What all parts share."""

    surface: Surface
    world: World
    path: JointPath
    band: Band
    bodies: tuple[np.ndarray, np.ndarray]
    columns: np.ndarray
    resources: Resources

    @staticmethod
    def of(
        case: Case,
        motions: Sequence[Motion],
        pairs: Sequence[Pair],
        slack: float,
        resources: Resources,
    ) -> _Work:
        layout = lay_out(case, pairs)
        world = layout.world
        bodies = np.unique(world.pairs[:, 0]), np.unique(world.pairs[:, 1])
        columns = np.zeros(len(world.frames), dtype=np.int64)
        for side in bodies:
            columns[side] = np.arange(len(side))
        path = _joint_path(world.links, motions, slice(0, motions[0].n_steps))
        rounding = TIME_ROUNDING * float(np.abs(path.times).max() + slack)
        band = Band(float(slack), rounding if math.isfinite(rounding) else 0.0)
        return _Work(layout.surface, world, path, band, bodies, columns, resources)

    @property
    def n_steps(self) -> int:
        return len(self.path.times)

    def steps(self) -> tuple[UnsynchronisedSteps, dict[str, int]]:
        """The least of each step."""
        n = self.n_steps
        found = StepsFound(
            np.empty(n),
            np.empty(n, np.int64),
            np.empty(n, np.int64),
            np.empty((n, 2, 3)),
            np.empty(n),
        )
        tree_b = self._tree(fill_steps_tree, slice(0, n), 1)

        def run_part(span: slice) -> tuple[int, np.ndarray]:
            counts = np.zeros(len(COUNTERS), dtype=np.int64)
            clocks = self._clocks(self._tree(fill_steps_tree, span, 0), tree_b)
            own = StepsFound(*(column[span] for column in found))
            call(least_of_unsynchronised_steps, self.surface, clocks, own, counts)
            return span.stop, counts

        tally = self._tally(in_order(run_part, parts(n), self.resources.n_threads), 0)
        return UnsynchronisedSteps(found.clearance, found.pair, found.step_b, found.points), tally

    def intervals(
        self, steps: UnsynchronisedSteps, goal: CertificateGoal
    ) -> tuple[UnsynchronisedIntervals, dict[str, int]]:
        """What is proven of each interval."""
        n = self.n_steps - 1
        numbers, places = np.empty((4, n)), np.empty((2, n), dtype=np.int64)
        bounds = TwoClockBounds(
            numbers[0], numbers[1], numbers[2], places[0], numbers[3], places[1]
        )
        if n > 0:
            surface = _with_whole_faces(self.surface)
            tree_b = self._tree(fill_intervals_tree, slice(0, n), 1)

            def run_part(span: slice) -> tuple[int, np.ndarray]:
                counts = np.zeros(len(COUNTERS), dtype=np.int64)
                clocks = self._clocks(self._tree(fill_intervals_tree, span, 0), tree_b)
                own = TwoClockBounds(*(column[span] for column in bounds))
                ends = slice(span.start, span.stop + 1)
                known = StepsOfClock(steps.clearance[ends], steps.step_b[ends], steps.pair[ends])
                call(certify_unsynchronised, surface, clocks, known, goal, own, counts)
                return span.stop, counts

            results = in_order(run_part, parts(n), self.resources.n_threads)
            tally = self._tally(results, self.n_steps)
        else:
            tally = dict.fromkeys(COUNTERS, 0)
        found = UnsynchronisedIntervals(
            bounds.lower, bounds.upper, bounds.share_a, bounds.step_b, bounds.share_b, bounds.pair
        )
        return found, tally

    def _tree(self, fill: Callable[..., None], span: slice, i_clock: int) -> ClockTree:
        bodies = self.bodies[i_clock]
        tree = new_clock_tree(span.start, span.stop - span.start, len(bodies))
        fill(self.surface, self.world, self.path, bodies, tree)
        return tree

    def _clocks(self, tree_a: ClockTree, tree_b: ClockTree) -> TwoClocks:
        return TwoClocks(self.world, self.path, tree_a, tree_b, self.columns, self.band)

    def _tally(self, results: Iterator[tuple[int, np.ndarray]], n_before: int) -> dict[str, int]:
        """The counters of all parts, while progress is reported."""
        tally = np.zeros(len(COUNTERS), dtype=np.int64)
        for done, counts in results:
            tally += counts
            if self.resources.progress:
                self.resources.progress(n_before + done, 2 * self.n_steps - 1)
        return dict(zip(COUNTERS, tally.tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class _Moments:
    """Measures the pair of an interval at the two times at which it was seen nearest."""

    case: Case
    motions: Sequence[Motion]
    pairs: Sequence[Pair]
    intervals: UnsynchronisedIntervals

    def of_interval(self, interval: int) -> UnsynchronisedMoment:
        """The moment at which the upper bound of an interval was seen."""
        found = self.intervals
        pair = self.pairs[int(found.pair[interval])]
        at_a = interval, float(found.share_a[interval])
        at_b = int(found.step_b[interval]), float(found.share_b[interval])
        second = {pair.b.i_robot for pair in self.pairs}
        positions = tuple(
            motion.positions_after(*(at_b if i in second else at_a))
            for i, motion in enumerate(self.motions)
        )
        poses = [
            link_poses(placed, at[None])
            for placed, at in zip(self.case.robots, positions, strict=True)
        ]
        near = distance(
            pair.a.shape_in(self.case),
            pair.b.shape_in(self.case),
            pose_a=pair.a.poses_in(self.case, poses)[0],
            pose_b=pair.b.poses_in(self.case, poses)[0],
        )
        touches = bool(found.upper_bound[interval] <= 0.0)
        links, others = pair_names(self.case, [pair])
        return UnsynchronisedMoment(
            time_a=self._time(*at_a),
            time_b=self._time(*at_b),
            clearance=0.0 if touches else near.distance,
            link=links[0],
            other=others[0],
            points=np.stack([near.point_b if touches else near.point_a, near.point_b]),
            positions=positions,
        )

    def _time(self, step: int, share: float) -> float:
        before, after = self.motions[0].times[step : step + 2]
        return float(before + share * (after - before))
