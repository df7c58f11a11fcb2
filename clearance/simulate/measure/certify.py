"""Proves how close the continuous motion comes between the steps, joints moving as `Motion` says.

Not for: the clearance at the steps (`measure`), which it starts from.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.certify import (
    CertificateGoal,
    CertifiedMotion,
    CertifiedSteps,
    IntervalBounds,
    certify,
)
from clearance.kernels.motion.joint_path import NO_BALLS, BallPath, JointPath
from clearance.kernels.motion.kinematics import BALL, TURNING, Links
from clearance.kernels.motion.world import World
from clearance.ordered import ascending
from clearance.record.measurement import COUNTERS, Measurement
from clearance.record.moment import Moment
from clearance.record.rows.blocks import blocks
from clearance.record.rows.resumable import MeasuredRows
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import PARTS_IN_MEMORY
from clearance.simulate.measure.measured import ProvenMotion
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.simulate.measure.refine import LEAST_GAP, Refinement
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources, in_order, parts
from clearance.tolerance import FINEST_CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.forest import joined_positions, positions_along
from clearance.world.kinematics import rates_by_link, values_by_link
from clearance.world.motion import Motion
from clearance.world.notice import Notice, Severity
from clearance.world.reach import farthest_reach
from clearance.world.slerp import arcs_between

BEYOND = 1.001
"""Gaps beyond the warn limit that are asked about where more is not known: a proof within the gap decides it."""

MOST_PARTS = 2**24
"""Parts of one interval that a pair is checked in before its gap is widened: half a minute to two. A whole turn
takes 3,000 to a tenth of a millimetre."""


def certify_motion(
    what: PairsInMotion,
    found: Measurement,
    gap: float,
    need: str = "steps",
    resources: Resources = DEFAULT_RESOURCES,
    levels: Sequence[float] = (),
) -> ProvenMotion:
    """Lower bounds that are within `gap` [m] of a distance that really occurs, nearer where a limit is open.

    Args:
        need: what was measured. Where it leaves clearances unknown, it is only asked whether the motion stays
            above the warn limit ("limit"), or above the least of all steps, less the gap ("minimum").
        resources: threads, progress, and where the bounds are stored.
        levels: [m] that are to be decided as well as the limits.
    """
    gap, notices = no_finer_than_rounding(what.case, what.motions, gap)
    work = _Work(what, _Question.of(found, what.limits, need, gap))
    n_steps = what.motions[0].n_steps
    log = _Log(resources.rows, f"{resources.prefix}certify", n_steps, work.question)
    results = in_order(work.certify(log.bounds), log.spans[log.done :], resources.n_threads)
    for i_part, (done, counts) in enumerate(results, start=log.done + 1):
        log.note(i_part, counts, last=i_part == len(log.spans))
        if resources.progress:
            resources.progress(done + 1, n_steps)
    resources.rows.let_go()
    limits = what.limits
    bounds, counts = work.refinement(gap).decided(log.bounds, (limits.fail, limits.warn, *levels))
    return _proven(what, found, bounds, gap, log.tally + counts, notices)


def with_least_proven(
    what: PairsInMotion,
    found: Measurement,
    proven: ProvenMotion,
    least: float,
    resources: Resources = DEFAULT_RESOURCES,
) -> ProvenMotion:
    """The same proof, finer where it is more than `LEAST_GAP` below the least clearance [m] of the run."""
    before = IntervalBounds(proven.lower_bound, proven.upper_bound, proven.share, proven.pair)
    steps = np.flatnonzero(before.lower[:-1] < least - LEAST_GAP)
    if least <= what.limits.rounding or len(steps) == 0:
        return proven
    own = IntervalBounds(*(column[steps] for column in before))
    work = _Work(what, _Question.of(found, what.limits, "steps", proven.gap))
    counts = work.refinement(proven.gap).raise_to(own, steps, least)
    after = IntervalBounds(*map(partial(_copied, resources), before._fields, before))
    for column, finer in zip(after, own, strict=True):
        column[steps] = finer
    tally = np.array([proven.tally[name] for name in COUNTERS]) + counts
    return _proven(what, found, after, proven.gap, tally, proven.notices)


def _copied(resources: Resources, name: str, column: np.ndarray) -> np.ndarray:
    """A copy of a column, stored where the rows of the run are."""
    kind = column.dtype.type
    copy = resources.rows.array(f"{resources.prefix}least.{name}", column.shape, kind)
    copy[:] = column
    return copy


def _proven(
    what: PairsInMotion,
    found: Measurement,
    bounds: IntervalBounds,
    gap: float,
    counts: np.ndarray,
    notices: tuple[Notice, ...],
) -> ProvenMotion:
    return ProvenMotion(
        *bounds,
        gap,
        dict(zip(COUNTERS, counts.tolist(), strict=True)),
        notices,
        moment_of=_moment_of(MomentQuery(what.case, what.motions, what.pairs), bounds, found),
    )


def no_finer_than_rounding(
    case: Case, motions: Sequence[Motion], gap: float
) -> tuple[float, tuple[Notice, ...]]:
    """The gap that can be had, and a warning where that is not what was asked for."""
    size = farthest_reach(case, tuple(motions))
    finest = FINEST_CERTIFY_GAP * size
    if gap >= finest:
        return gap, ()
    text = (
        f"certified to {finest * 1000:.4g} mm, not to the {gap * 1000:.4g} mm asked for: no bound is finer than "
        f"2^-32 of the scene's size ({size:.3g} m from the origin), which is above rounding"
    )
    return finest, (Notice(Severity.WARNING, "certificate", text),)


def _moment_of(
    moments: MomentQuery, bounds: IntervalBounds, found: Measurement
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
    """The bounds, (n,) each, and how many parts of them are proven."""

    def __init__(self, rows: MeasuredRows, name: str, n_steps: int, question: _Question) -> None:
        self._rows = rows
        self.bounds = IntervalBounds(
            rows.array(f"{name}.lower", (n_steps,)),
            rows.array(f"{name}.upper", (n_steps,)),
            rows.array(f"{name}.share", (n_steps,)),
            rows.array(f"{name}.pair", (n_steps,), np.int64),
        )
        last = _or_far(question.found.clearance[-1:], question.unknown)[0]
        for column, value in zip(self.bounds, (last, last, -1.0, -1), strict=True):
            column[-1] = value
        self.spans = parts(n_steps - 1)
        self._log = rows.log(name, self.spans)
        self.done, self.tally = self._log.done, self._log.gathered.get("tally", _no_counts())

    def note(self, done: int, counts: np.ndarray, *, last: bool) -> None:
        self.tally = self.tally + counts
        self._log.note(done, {"tally": self.tally}, last=last)
        if done % PARTS_IN_MEMORY == 0:
            self._rows.let_go()


@dataclass(frozen=True, eq=False)
class _Work:
    """What all parts of a certificate share."""

    what: PairsInMotion
    question: _Question

    def refinement(self, gap: float) -> Refinement:
        """Proves intervals of these pairs again."""
        finest = FINEST_CERTIFY_GAP * farthest_reach(self.what.case, tuple(self.what.motions))
        return Refinement(self.prove, gap, finest, self.what.limits.rounding)

    def certify(self, bounds: IntervalBounds) -> Callable[[slice], tuple[int, np.ndarray]]:
        """Proves a part, into `bounds`; returns where it ends, and counters."""
        layout = self.what.layout
        world, surface = layout.world, layout.whole_faces

        def run_part(span: slice) -> tuple[int, np.ndarray]:
            counts = _no_counts()
            ends = slice(span.start, span.stop + 1)
            own = IntervalBounds(*(column[span] for column in bounds))
            path = path_of(world.links, self.what.case, self.what.motions, ends)
            order = np.maximum(self.question.found.pair[span], 0)
            steps = CertifiedSteps(0, span.stop - span.start, order, self.question.distances(ends))
            motion = CertifiedMotion(with_turning_balls(world), path)  # no two threads share it
            certify(surface, motion, steps, self.question.aim, own, counts)
            return span.stop, counts

        return run_part

    def prove(
        self, step: int, asked: np.ndarray, aim: CertificateGoal
    ) -> tuple[IntervalBounds, np.ndarray]:
        """Proves the intervals after a step again, asked about (k + 1,) [m] at their ends."""
        ends = slice(step, step + len(asked))
        path = path_of(self.what.layout.world.links, self.what.case, self.what.motions, ends)
        order = np.maximum(self.question.found.pair[ends][:-1], 0)
        layout, steps = self.what.layout, CertifiedSteps(0, len(order), order, asked)
        return prove_path(layout.whole_faces, layout.world, path, steps, aim)


def prove_path(
    surface: Surface, world: World, path: JointPath, steps: CertifiedSteps, aim: CertificateGoal
) -> tuple[IntervalBounds, np.ndarray]:
    """What is proven of all pairs of a world along a path, and counters as `COUNTERS`."""
    n, counts = len(path.times) - 1, _no_counts()
    bounds = IntervalBounds(np.empty(n), np.empty(n), np.empty(n), np.empty(n, dtype=np.int64))
    motion = CertifiedMotion(with_turning_balls(world), path)  # no two threads share it
    certify(surface, motion, steps, aim, bounds, counts)
    return bounds, counts


def _no_counts() -> np.ndarray:
    return np.zeros(len(COUNTERS), dtype=np.int64)


def path_of(links: Links, case: Case, motions: Sequence[Motion], steps: slice) -> JointPath:
    """The motion of the joints above all links at `steps`."""
    positions = joined_positions(case, motions, steps)
    cubic = cubic_columns(motions, positions.shape[1])
    rates = np.zeros_like(positions)
    if cubic.any():
        own = np.concatenate([_rates(m, steps) for m in motions], 1)
        rates[:, : own.shape[1]] = own
    return joint_path(links, ascending(motions[0].times[steps]), positions, rates, cubic)


def finer_path(what: PairsInMotion, step: int, n_parts: int) -> JointPath:
    """The motion of the joints from a step to the next, in parts that are equally long.

    Exactness: where parts meet joints are rounded, by far less than what bounds leave for rounding.
    """
    shares = np.arange(n_parts + 1) / n_parts
    positions, rates = columns_along(what.case, what.motions, step, shares)
    start, end = what.motions[0].times[step : step + 2]
    times, cubic = start + shares * (end - start), cubic_columns(what.motions, positions.shape[1])
    return joint_path(what.layout.world.links, times, positions, rates, cubic)


def columns_along(
    case: Case, motions: Sequence[Motion], step: int, shares: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(k, columns) positions and rates of all columns when shares (k,) of the interval after a step have passed;
    rates are 0 where no cubic is followed."""
    positions = positions_along(case, motions, step, shares)
    rates = np.zeros_like(positions)
    if cubic_columns(motions, positions.shape[1]).any():
        own = [[motion.velocities_after(step, share) for share in shares] for motion in motions]
        rates[:, : sum(motion.positions.shape[1] for motion in motions)] = np.concatenate(own, 1)
    return positions, rates


def cubic_columns(motions: Sequence[Motion], n_columns: int) -> np.ndarray:
    """(columns,) True for joints on cubics; what obstacles move by is at constant speed."""
    cubic = np.zeros(n_columns, dtype=bool)
    own = np.concatenate([np.full(m.positions.shape[1], m.velocities is not None) for m in motions])
    cubic[: len(own)] = own
    return cubic


def joint_path(
    links: Links, times: np.ndarray, positions: np.ndarray, rates: np.ndarray, cubic: np.ndarray
) -> JointPath:
    """The motion of the joints above all links.

    Args:
        times: (n,) [s]. positions, rates: (n, columns). cubic: (columns,) True where the rates are followed.
    """
    velocities = rates_by_link(links, rates) if cubic.any() else np.empty((0, len(links.parents)))
    return JointPath(
        _writable(times),
        _writable(values_by_link(links, positions)),
        _writable(velocities),
        np.append(cubic, False)[links.columns],  # the last stands for no column
        _ball_path(links, positions),
    )


def with_turning_balls(world: World) -> World:
    """The world as the kernel takes it: ball joints are joints that turn, fixed parts and axes its own."""
    links = world.links
    if not (links.kinds == BALL).any():
        return world
    own = links._replace(
        kinds=np.where(links.kinds == BALL, TURNING, links.kinds),
        axes=links.axes.copy(),
        parent_from_joint=links.parent_from_joint.copy(),
    )
    return world._replace(links=own)


def _ball_path(links: Links, positions: np.ndarray) -> BallPath:
    """The motion of the ball joints among all links, of positions (n, columns)."""
    balls = np.flatnonzero(links.kinds == BALL)
    if len(balls) == 0:
        return NO_BALLS
    turned = positions[:, links.columns[balls, None] + np.arange(4)]
    arcs = np.concatenate([turned[:-1], arcs_between(turned[:-1], turned[1:])], axis=2)
    return BallPath(balls, links.parent_from_joint[balls], _writable(arcs))


def _rates(motion: Motion, steps: slice) -> np.ndarray:
    if motion.velocities is None:
        return np.zeros_like(motion.positions[steps])
    return motion.velocities[steps]


def _writable(numbers: np.ndarray) -> np.ndarray:
    """As the kernel takes them: it is compiled once, for arrays that could be written to."""
    return np.require(numbers, np.float64, ["C", "W"])
