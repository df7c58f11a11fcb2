"""Proves how close the continuous motion comes between the steps, joints moving as `Motion` says.

Not for: the clearance at the steps (`measure`), which it starts from.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.ahead import usable_cores
from clearance.errors import BadDimension
from clearance.geometry.edges import rings_of
from clearance.kernel_table import call
from clearance.kernels.certify import Asked, certify
from clearance.kernels.drift import Chain
from clearance.kernels.joint_path import JointPath
from clearance.kernels.surface import ANYTHING, Surface
from clearance.simulate.layout import lay_out
from clearance.simulate.measure import COUNTERS, HELD, Measurement, Progress
from clearance.simulate.parts import in_order, parts
from clearance.simulate.record import Certificate
from clearance.simulate.spool import Rows
from clearance.world.case import Case
from clearance.world.kinematics import chain_arrays, positions_by_link, velocities_by_link
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


def certify_motion(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    found: Measurement,
    gap: float,
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
    kept: Rows | None = None,
) -> Certificate:
    """Lower bounds that are within `gap` [m] of a distance that really occurs.

    Args:
        jobs: threads; as many as the machine has to offer by default.
        kept: where the bounds are kept; in memory by default.

    Raises:
        BadDimension: `gap` is not a positive length.
    """
    if not 0.0 < gap < np.inf:
        raise BadDimension(f"a gap of {gap} m", where="certify", valid="a length above 0")
    kept, tally, bounds = kept or Rows(), _no_counts(), []
    for i_robot, motion in enumerate(motions):
        work = _Work.of(case, motion, pairs, i_robot, found, gap)
        log = _Log(kept, f"certify{i_robot}", motion.n_steps, found)
        results = in_order(work.certify(log), log.spans[log.done :], jobs or usable_cores())
        for i_part, (done, counts) in enumerate(results, start=log.done + 1):
            log.note(i_part, counts, last=i_part == len(log.spans))
            if progress:
                progress(done + 1, motion.n_steps)
        tally += log.tally
        bounds.append((log.lower, log.upper))
    for other in bounds[1:]:
        for mine, theirs in zip(bounds[0], other, strict=True):
            np.minimum(mine, theirs, out=mine)
    kept.let_go()
    return Certificate(*bounds[0], gap, dict(zip(COUNTERS, tally.tolist(), strict=True)))


class _Log:
    """The bounds of one robot, (n,) [m] each, and how many parts of them are proven."""

    def __init__(self, kept: Rows, name: str, n_steps: int, found: Measurement) -> None:
        self._kept = kept
        self.lower = kept.array(f"{name}.lower", (n_steps,))
        self.upper = kept.array(f"{name}.upper", (n_steps,))
        self.lower[-1] = self.upper[-1] = found.clearance[-1]
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
    chain: Chain
    asked: Asked
    motion: Motion
    chosen: list[int]
    found: Measurement
    gap: float
    fail: float

    @staticmethod
    def of(
        case: Case,
        motion: Motion,
        pairs: Sequence[Pair],
        i_robot: int,
        found: Measurement,
        gap: float,
    ) -> _Work:
        chosen = [i for i, pair in enumerate(pairs) if pair.i_robot == i_robot]
        laid = _lay_out(case, [pairs[i] for i in chosen])
        return _Work(*laid, motion, chosen, found, gap, case.limits.fail)

    def certify(self, log: _Log) -> Callable[[slice], tuple[int, np.ndarray]]:
        """Proves a part, into the bounds of `log`; returns where it ends, and counters."""

        def run_part(span: slice) -> tuple[int, np.ndarray]:
            counts = _no_counts()
            ends = slice(span.start, span.stop + 1)
            nearest = np.searchsorted(self.chosen, self.found.pair[span])
            call(
                certify, self.surface, self.chain, self.asked, _joint_path(self.motion, ends),
                np.maximum(nearest, 0) % len(self.chosen), 0, span.stop - span.start,
                self.found.clearance[ends], self.gap, self.fail, log.lower[span], log.upper[span], counts,
            )  # fmt: skip
            return span.stop, counts

        return run_part


def _no_counts() -> np.ndarray:
    return np.zeros(len(COUNTERS), dtype=np.int64)


def _lay_out(case: Case, pairs: Sequence[Pair]) -> tuple[Surface, Chain, Asked]:
    """The surface with whole faces, the robot's chain, and the pairs; all of one robot."""
    layout = lay_out(case, pairs)
    placed = case.robots[pairs[0].i_robot]
    robot = placed.robot
    links = [robot.link_names.index(robot.bodies[pair.i_body].name) for pair in pairs]
    return (
        _with_whole_faces(layout.surface),
        Chain(np.ascontiguousarray(placed.world_from_base, dtype=np.float64), *chain_arrays(robot)),
        Asked(layout.world.pairs, np.array(links, dtype=np.int64), layout.world.standing),
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
    return JointPath(np.ascontiguousarray(motion.times[steps], dtype=np.float64), positions, velocities)
