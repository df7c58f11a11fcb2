"""Proves how close the continuous motion comes between the steps, joints moving as `Motion` says.

Not for: the clearance at the steps (`measure`), which it starts from.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.compile.kernel_table import call
from clearance.errors import BadDimension
from clearance.geometry.edges import rings_of
from clearance.kernels.mesh.surface import ANYTHING, Surface
from clearance.kernels.motion.certify import (
    CertificateGoal,
    CertifiedMotion,
    CertifiedPairs,
    CertifiedSteps,
    IntervalBounds,
    certify,
)
from clearance.kernels.motion.joint_motion_bound import KinematicTree
from clearance.kernels.motion.joint_path import JointPath
from clearance.simulate.layout import lay_out
from clearance.simulate.measure import COUNTERS, HELD, Measurement
from clearance.simulate.moment import Moment, Moments
from clearance.simulate.parts import blocks, in_order, parts
from clearance.simulate.record import Certificate
from clearance.simulate.resources import DEFAULT_RESOURCES, Resources
from clearance.simulate.resumable_rows import MeasuredRows
from clearance.tolerance import FINEST_CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.kinematics import kinematic_tree_arrays, positions_by_link, velocities_by_link
from clearance.world.motion import Motion
from clearance.world.notice import Notice, Severity
from clearance.world.pairs import Pair
from clearance.world.reach import farthest_reach

BEYOND = 1.001
"""Gaps beyond the warn limit that are asked about where more is not known: a proof within the gap decides it."""

MOST_PARTS = 2**24
"""Parts of one interval that a pair is looked at in before its gap is widened: half a minute to two. A whole turn
takes 3,000 to a tenth of a millimetre."""


def certify_motion(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    found: Measurement,
    gap: float,
    need: str = "steps",
    resources: Resources = DEFAULT_RESOURCES,
) -> Certificate:
    """Lower bounds that are within `gap` [m] of a distance that really occurs.

    Args:
        need: what was measured. Where it leaves clearances unknown, it is only asked whether the motion stays
            above the warn limit ("limit"), or above the least of all steps, less the gap ("minimum").
        resources: threads, progress, and where the bounds are kept.

    Raises:
        BadDimension: `gap` is not a positive length.
    """
    if not (isinstance(gap, int | float | np.number) and 0.0 < gap < np.inf):
        raise BadDimension(f"a gap of {gap!r:.60} m", where="certify", valid="a length above 0")
    gap = float(gap)
    gap, notices = _no_finer_than_rounding(case, motions, gap)
    progress, tally, bounds = resources.progress, _no_counts(), []
    question = _Question.of(found, case.limits, need, gap)
    for i_robot in sorted(
        {pair.i_robot for pair in pairs}
    ):  # a robot may have nothing that is measured
        motion = motions[i_robot]
        work = _Work.of(case, motion, pairs, i_robot, question)
        log = _Log(resources.rows, f"certify{i_robot}", motion.n_steps, question)
        results = in_order(work.certify(log.bounds), log.spans[log.done :], resources.n_threads)
        for i_part, (done, counts) in enumerate(results, start=log.done + 1):
            log.note(i_part, counts, last=i_part == len(log.spans))
            if progress:
                progress(done + 1, motion.n_steps)
        tally += log.tally
        bounds.append(log.bounds)
    joined = _joined(bounds)
    resources.rows.let_go()
    return Certificate(
        *joined,
        gap,
        dict(zip(COUNTERS, tally.tolist(), strict=True)),
        _moment_of(Moments(case, motions, pairs), joined, found),
        notices,
    )


def _no_finer_than_rounding(
    case: Case, motions: Sequence[Motion], gap: float
) -> tuple[float, tuple[Notice, ...]]:
    """The gap that can be had, and a warning where that is not what was asked for."""
    size = farthest_reach(case, motions)
    finest = FINEST_CERTIFY_GAP * size
    if gap >= finest:
        return gap, ()
    text = (
        f"certified to {finest * 1000:.2g} mm, not to the {gap * 1000:.2g} mm asked for: no bound is finer than "
        f"2^-32 of the scene's size ({size:.3g} m from the origin), which is above rounding"
    )
    return finest, (Notice(Severity.WARNING, "certificate", text),)


def _joined(bounds: Sequence[IntervalBounds]) -> IntervalBounds:
    """The bounds of all robots together, in the arrays of the first."""
    first = bounds[0]
    for other in bounds[1:]:
        np.minimum(first.lower, other.lower, out=first.lower)
        nearer = other.upper < first.upper
        for mine, theirs in zip(first[1:], other[1:], strict=True):
            mine[nearer] = theirs[nearer]
    return first


def _moment_of(
    moments: Moments, bounds: IntervalBounds, found: Measurement
) -> Callable[[int], Moment]:
    """Measures the pair of an interval where it was seen nearest; at the nearer end where that is a step."""

    def moment_of(step: int) -> Moment:
        share, i_pair = float(bounds.share[step]), int(bounds.pair[step])
        if i_pair < 0:
            ends = found.clearance[step : step + 2]
            share = float(np.nanargmin(ends))
            i_pair = int(found.pair[step + int(share)])
        return moments.between(step, share, i_pair, touches=bool(bounds.upper[step] <= 0.0))

    return moment_of


@dataclass(frozen=True, eq=False)
class _Question:
    """Which distances are asked about: those of the steps, or where these are unknown what `need` wants to know.

    Attributes:
        unknown: [m] proven of every step that is not known.
        far: [m] what is asked about there: whether the motion stays so far, less the gap.
    """

    found: Measurement
    aim: CertificateGoal
    unknown: float
    far: float

    @staticmethod
    def of(found: Measurement, limits: Limits, need: str, gap: float) -> _Question:
        n_steps = len(found.clearance)
        least = min(_or_far(found.clearance[block], np.inf).min() for block in blocks(n_steps))
        unknown = far = least
        if need == "limit":
            unknown, far = max(least, limits.warn), max(least, limits.warn + BEYOND * gap)
        return _Question(found, CertificateGoal(gap, limits.fail, MOST_PARTS), unknown, far)

    def distances(self, steps: slice) -> np.ndarray:
        """(k,) [m]."""
        return _or_far(self.found.clearance[steps], self.far)


def _or_far(clearance: np.ndarray, far: float) -> np.ndarray:
    return np.where(np.isnan(clearance), far, clearance)


class _Log:
    """The bounds of one robot, (n,) each, and how many parts of them are proven."""

    def __init__(self, kept: MeasuredRows, name: str, n_steps: int, question: _Question) -> None:
        self._kept = kept
        self.bounds = IntervalBounds(
            kept.array(f"{name}.lower", (n_steps,)),
            kept.array(f"{name}.upper", (n_steps,)),
            kept.array(f"{name}.share", (n_steps,)),
            kept.array(f"{name}.pair", (n_steps,), np.int64),
        )
        last = _or_far(question.found.clearance[-1:], question.unknown)[0]
        for column, value in zip(self.bounds, (last, last, -1.0, -1), strict=True):
            column[-1] = value
        self.spans = parts(n_steps - 1)
        self._log = kept.log(name, self.spans)
        self.done, self.tally = self._log.done, self._log.gathered.get("tally", _no_counts())

    def note(self, done: int, counts: np.ndarray, *, last: bool) -> None:
        self.tally = self.tally + counts
        self._log.note(done, {"tally": self.tally}, last=last)
        if done % HELD == 0:
            self._kept.let_go()


@dataclass(frozen=True, eq=False)
class _Work:
    """What all parts of one robot's certificate share; `chosen` are its pairs among all."""

    surface: Surface
    tree: KinematicTree
    asked: CertifiedPairs
    motion: Motion
    chosen: np.ndarray
    question: _Question

    @staticmethod
    def of(
        case: Case, motion: Motion, pairs: Sequence[Pair], i_robot: int, question: _Question
    ) -> _Work:
        chosen = [i for i, pair in enumerate(pairs) if pair.i_robot == i_robot]
        laid = _lay_out(case, [pairs[i] for i in chosen])
        return _Work(*laid, motion, np.array(chosen), question)

    def certify(self, bounds: IntervalBounds) -> Callable[[slice], tuple[int, np.ndarray]]:
        """Proves a part, into `bounds`; returns where it ends, and counters."""

        def run_part(span: slice) -> tuple[int, np.ndarray]:
            counts = _no_counts()
            ends = slice(span.start, span.stop + 1)
            nearest = np.searchsorted(self.chosen, self.question.found.pair[span])
            own = IntervalBounds(*(column[span] for column in bounds))
            motion = CertifiedMotion(self.tree, _joint_path(self.motion, ends), self.asked)
            order = np.maximum(nearest, 0) % len(self.chosen)
            steps = CertifiedSteps(0, span.stop - span.start, order, self.question.distances(ends))
            call(certify, self.surface, motion, steps, self.question.aim, own, counts)
            seen = own.pair >= 0
            own.pair[seen] = self.chosen[own.pair[seen]]
            return span.stop, counts

        return run_part


def _no_counts() -> np.ndarray:
    return np.zeros(len(COUNTERS), dtype=np.int64)


def _lay_out(case: Case, pairs: Sequence[Pair]) -> tuple[Surface, KinematicTree, CertifiedPairs]:
    """The surface with whole faces, the robot's kinematic tree, and the pairs; all of one robot."""
    layout = lay_out(case, pairs)
    placed = case.robots[pairs[0].i_robot]
    robot = placed.robot
    links = [robot.link_names.index(robot.bodies[pair.i_body].name) for pair in pairs]
    return (
        _with_whole_faces(layout.surface),
        KinematicTree(_writable(placed.world_from_base), *kinematic_tree_arrays(robot)),
        CertifiedPairs(layout.world.pairs, np.array(links, dtype=np.int64), layout.world.standing),
    )


def _with_whole_faces(surface: Surface) -> Surface:
    """The surface in which every face owns all its corners and edges, not only those it answers for."""
    starts, corners = surface.face_starts, surface.face_vertices
    return surface._replace(
        vertex_starts=starts,
        owned_vertices=corners,
        edge_starts=starts,
        owns=np.full(len(starts) - 1, ANYTHING, dtype=np.uint16),
        owned_edges=np.stack([corners, corners[rings_of(starts).ahead]], axis=1),
    )


def _joint_path(motion: Motion, steps: slice) -> JointPath:
    """The motion of the joints above all links at `steps`."""
    robot = motion.placed.robot
    positions = positions_by_link(robot, motion.positions[steps])
    velocities = np.empty((0, positions.shape[1]))
    if motion.velocities is not None:
        velocities = velocities_by_link(robot, motion.velocities[steps])
    return JointPath(_writable(motion.times[steps]), _writable(positions), _writable(velocities))


def _writable(numbers: np.ndarray) -> np.ndarray:
    """As the kernel takes them: it is compiled once, for arrays that could be written to."""
    return np.require(numbers, np.float64, ["C", "W"])
