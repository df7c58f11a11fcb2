"""Proves how close the continuous motion comes between the steps, joints moving as `Motion` says.

Not for: the clearance at the steps (`measure`), which it starts from.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.edges import rings_of
from clearance.kernel_table import call
from clearance.kernels.certify import Asked, certify
from clearance.kernels.drift import Chain
from clearance.kernels.joint_path import JointPath
from clearance.kernels.surface import Surface
from clearance.simulate.layout import lay_out
from clearance.simulate.measure import COUNTERS, Measurement, Progress
from clearance.simulate.parts import in_order, parts, usable_cores
from clearance.simulate.record import Certificate
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
) -> Certificate:
    """Lower bounds that are within `gap` [m] of a distance that really occurs.

    Args:
        jobs: threads; as many as the machine has to offer by default.

    Raises:
        BadDimension: `gap` is not a positive length.
    """
    if not 0.0 < gap < np.inf:
        raise BadDimension(f"a gap of {gap} m", where="certify", valid="a length above 0")
    n_steps = motions[0].n_steps
    lower = found.clearance.copy()
    upper = found.clearance.copy()
    tally = np.zeros(len(COUNTERS), dtype=np.int64)
    for i_robot, motion in enumerate(motions):
        chosen = [i for i, pair in enumerate(pairs) if pair.i_robot == i_robot]
        surface, chain, asked = _lay_out(case, [pairs[i] for i in chosen])
        order = np.maximum(np.searchsorted(chosen, found.pair), 0) % len(chosen)
        path = _joint_path(motion)
        robot_lower, robot_upper = lower.copy(), upper.copy()

        def run_part(
            span: slice, surface=surface, chain=chain, asked=asked, path=path, order=order,
            lower=robot_lower, upper=robot_upper,
        ) -> tuple[int, np.ndarray]:  # fmt: skip
            counts = np.zeros(len(COUNTERS), dtype=np.int64)
            call(
                certify, surface, chain, asked, path, order, span.start, span.stop, found.clearance,
                gap, case.limits.fail, lower, upper, counts,
            )  # fmt: skip
            return span.stop, counts

        for done, counts in in_order(run_part, parts(n_steps - 1), jobs or usable_cores()):
            tally += counts
            if progress:
                progress(done + 1, n_steps)
        lower, upper = np.minimum(lower, robot_lower), np.minimum(upper, robot_upper)
    return Certificate(lower, upper, gap, dict(zip(COUNTERS, tally.tolist(), strict=True)))


def _lay_out(case: Case, pairs: Sequence[Pair]) -> tuple[Surface, Chain, Asked]:
    """The surface with whole faces, the robot's chain, and the pairs; all of one robot."""
    layout = lay_out(case, pairs)
    placed = case.robots[pairs[0].i_robot]
    robot = placed.robot
    links = [robot.link_names.index(robot.bodies[pair.i_body].name) for pair in pairs]
    return (
        _with_whole_faces(layout.surface),
        Chain(np.ascontiguousarray(placed.world_from_base, dtype=np.float64), *chain_arrays(robot)),
        Asked(layout.pairs, np.array(links, dtype=np.int64), layout.standing),
    )


def _with_whole_faces(surface: Surface) -> Surface:
    """The surface in which every face owns all its corners and edges, not only those it answers for."""
    starts, corners = surface.face_starts, surface.face_vertices
    return surface._replace(
        vertex_starts=starts,
        owned_vertices=corners,
        edge_starts=starts,
        owned_edges=np.stack([corners, corners[rings_of(starts).ahead]], axis=1),
    )


def _joint_path(motion: Motion) -> JointPath:
    """The motion of the joints above all links."""
    robot = motion.placed.robot
    positions = positions_by_link(robot, motion.positions)
    velocities = np.empty((0, positions.shape[1]))
    if motion.velocities is not None:
        velocities = velocities_by_link(robot, motion.velocities)
    return JointPath(np.ascontiguousarray(motion.times, dtype=np.float64), positions, velocities)
