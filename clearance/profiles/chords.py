"""How far a body's points leave the chords between two poses, and the instants that keep them within a limit.

Joints move linearly from step to step. Between two instants a point of a link follows x(s), |s| <= 1; with
x'' = its acceleration at the middle plus at most |s| M, the distance from the chord is at most
|x''(0)| / 2 + M / 6 (the Green's function of e'' with e(-1) = e(1) = 0). x''(0) is an affine map of the body
and is taken exactly at the corners of its box, in the plane; M bounds the third derivative link by link.
Not for: clearances between the steps (`simulate.certify`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.kernels.kinematics import SLIDING, TURNING
from clearance.profiles.plane import Plane
from clearance.world.body import Body
from clearance.world.case import PlacedRobot
from clearance.world.kinematics import chain_arrays, link_poses, positions_by_link
from clearance.world.motion import Motion

MOST_PARTS = 4096
"""Parts of one step: a motion that needs more turns about more than a thousand times."""


@dataclass(frozen=True, eq=False)
class Knots:
    """The instants at which a body is projected.

    Attributes:
        instant: (k,) in steps, increasing; whole numbers are the steps themselves.
        poses: (k, 4, 4) world_from_link [m] there.
        moves: (k - 1,) whether the body moves from each to the next.
        chord: (k - 1,) [m] proven bound of the distance of its points from their chords, in the plane.
        turn: (k - 1,) [rad] how far the direction of view turns in the body either way from the middle.
        middle: (k - 1, 4, 4) poses in the middle of each interval.
    """

    instant: np.ndarray
    poses: np.ndarray
    moves: np.ndarray
    chord: np.ndarray
    turn: np.ndarray
    middle: np.ndarray


def knots_of(motion: Motion, body: Body, plane: Plane, limit: float, *, solid: bool) -> Knots:
    """The steps, and instants between them, so that no chord is left by more than `limit` [m].

    Args:
        solid: bound the distance in space, not in the plane.
    """
    chain = _Chain(motion.placed, body, plane, solid)
    instants = np.arange(motion.n_steps, dtype=float)
    low, high = instants[:-1], instants[1:]
    done: list[tuple[np.ndarray, ...]] = []
    while len(low):
        chord, turn, middle, moves = chain.bounds(motion, low, high)
        fine = (chord <= limit) | (high - low <= 1.0 / MOST_PARTS)
        done.append((low[fine], high[fine], chord[fine], turn[fine], middle[fine], moves[fine]))
        low, high = _split(low[~fine], high[~fine], chord[~fine], limit)
    if not done:
        return standing(motion.poses(0, 1)[0, chain.link])
    low, high, chord, turn, middle, moves = (
        np.concatenate(part) for part in zip(*done, strict=True)
    )
    order = np.argsort(low, kind="stable")
    instant = np.append(low[order], high[order[-1]])
    poses = link_poses(motion.placed, positions_at(motion, instant))[:, chain.link]
    return Knots(instant, poses, moves[order], chord[order], turn[order], middle[order])


def positions_at(motion: Motion, instant: np.ndarray) -> np.ndarray:
    """(k, joints) positions at instants (k,), in steps; joints move linearly between the steps."""
    step = np.clip(np.floor(instant).astype(int), 0, motion.n_steps - 1)
    ahead = np.minimum(step + 1, motion.n_steps - 1)
    share = (instant - step)[:, None]
    return motion.positions[step] * (1.0 - share) + motion.positions[ahead] * share


def standing(pose: np.ndarray) -> Knots:
    """The one instant of a body that never moves, at a (4, 4) pose [m]."""
    none = np.zeros(0)
    return Knots(np.zeros(1), pose[None], none.astype(bool), none, none, np.zeros((0, 4, 4)))


def _split(low: np.ndarray, high: np.ndarray, chord: np.ndarray, limit: float):
    """Each interval in as many equal parts as its bound asks for; the bound falls with the square."""
    parts = np.clip(np.ceil(np.sqrt(1.02 * chord / limit)), 2, 64).astype(int)
    rank = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    low, high, n = np.repeat(low, parts), np.repeat(high, parts), np.repeat(parts, parts)
    ends = low + (high - low) * (rank + 1) / n
    return low + (high - low) * rank / n, np.where(rank + 1 == n, high, ends)


class _Chain:
    """The joints above one link, root first, and the corners of the body's box."""

    def __init__(self, placed: PlacedRobot, body: Body, plane: Plane, solid: bool) -> None:
        self.placed = placed
        self.link = placed.robot.link_names.index(body.name)
        self.parents, self.kinds, self.fixed, self.axes = chain_arrays(placed.robot)
        self.path = [self.link] if self.link else []
        while self.path and self.parents[self.path[0]]:
            self.path.insert(0, int(self.parents[self.path[0]]))
        low, high = body.shape.bounds
        pick = np.array([[k >> i & 1 for i in range(3)] for k in range(8)], bool)
        self.corners = np.column_stack([np.where(pick, high, low), np.ones(8)])
        self.rows = np.eye(3) if solid else plane.axes
        self.normal = plane.normal

    def bounds(self, motion: Motion, low: np.ndarray, high: np.ndarray):
        """chord, turn, middle and moves, as in `Knots`, of intervals from `low` to `high`."""
        ends = [
            positions_by_link(self.placed.robot, positions_at(motion, at)) for at in (low, high)
        ]
        halves = 0.5 * (ends[1] - ends[0])
        middles = positions_at(motion, 0.5 * (low + high))
        poses = link_poses(self.placed, middles)
        bent = self._bend(positions_by_link(self.placed.robot, middles), halves)
        # Newton's laws aside: x'' = T'' x is affine in x, so its length is greatest at a corner of the box.
        inward = np.einsum("rc,ncd,kd->nkr", self.rows, bent[:, :3], self.corners)
        first = np.sqrt((inward**2).sum(axis=2)).max(axis=1)
        third, turn = self._third(poses, np.abs(halves))
        moves = np.any(halves[:, self.path] != 0.0, axis=1)
        chord = np.where(moves, (0.5 * first + third / 6.0) * (1.0 + 1e-9), 0.0)
        return chord, turn, poses[:, self.link], moves

    def _bend(self, values: np.ndarray, halves: np.ndarray) -> np.ndarray:
        """(n, 4, 4) the second derivative of world_from_link in the middle, by half the interval."""
        n = len(values)
        pose = np.broadcast_to(self.placed.world_from_base, (n, 4, 4))
        speed, bent = np.zeros((n, 4, 4)), np.zeros((n, 4, 4))
        for i in self.path:
            own, d_own, dd_own = self._joint(i, values[:, i], halves[:, i])
            bent = bent @ own + 2.0 * speed @ d_own + pose @ dd_own
            speed = speed @ own + pose @ d_own
            pose = pose @ own
        return bent

    def _joint(self, i: int, value: np.ndarray, half: np.ndarray):
        """The motion of one joint and its first two derivatives by half the interval, (n, 4, 4) each."""
        own = np.zeros((3, len(value), 4, 4))
        own[0] = np.eye(4)
        x, y, z = self.axes[i]
        if self.kinds[i] == SLIDING:
            own[0, :, :3, 3] = value[:, None] * self.axes[i]
            own[1, :, :3, 3] = half[:, None] * self.axes[i]
        elif self.kinds[i] == TURNING:
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
            square, half = cross @ cross, half[:, None, None]
            own[0, :, :3, :3] += sine * cross + (1.0 - cosine) * square
            own[1, :, :3, :3] = half * (cosine * cross + sine * square)
            own[2, :, :3, :3] = half**2 * (cosine * square - sine * cross)
        return self.fixed[i] @ own

    def _third(self, poses: np.ndarray, halves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the third derivative of any point [m] and of the turn of the normal in the body [rad].

        From the link to the root: y = E(theta) z, |y'''| <= d^3 r + 3 d^2 |z'| + 3 d |z''| + |z'''|, where r is
        the greatest distance from the axis, in the middle plus how far the joints below move it.
        """
        n = len(poses)
        first, second, third, turn = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        world = self.corners @ poses[:, self.link].transpose(0, 2, 1)
        above = sum((halves[:, i] for i in self.path if self.kinds[i] == TURNING), np.zeros(n))
        for i in reversed(self.path):
            half = halves[:, i]
            if self.kinds[i] == SLIDING:
                first = first + half
            elif self.kinds[i] == TURNING:
                above = above - half
                axis = poses[:, i, :3, :3] @ self.axes[i]
                off = np.cross(world[:, :, :3] - poses[:, None, i, :3, 3], axis[:, None])
                arm = np.sqrt((off**2).sum(axis=2)).max(axis=1) + first
                third = half**3 * arm + 3.0 * half**2 * first + 3.0 * half * second + third
                second = half**2 * arm + 2.0 * half * first + second
                first = half * arm + first
                tilt = np.sqrt((np.cross(axis, self.normal) ** 2).sum(axis=1))
                turn = turn + half * np.minimum(1.0, tilt + np.maximum(above, 0.0))
        return third, turn
