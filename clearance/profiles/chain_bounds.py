"""How far a body's points may leave the chords between two poses, and how far the view turns in the body.

Between two instants a point of a link follows x(s), |s| <= 1; with x'' = its acceleration at the middle plus at
most |s| M, the distance from the chord is at most |x''(0)| / 2 + M / 6 (the Green's function of e'' with
e(-1) = e(1) = 0). x''(0) is an affine map of the body and is evaluated exactly at the corners of its box, in the
plane; M bounds the third derivative link by link. Not for: choosing the instants (`chords`).
"""

from __future__ import annotations

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.motion.kinematics import BALL, SLIDING, TURNING
from clearance.profiles.chain import Chain, Course
from clearance.profiles.plane import Plane


class ChainBounds:
    """The joints above one link, root first, and the corners of the box of the body that it carries."""

    def __init__(self, chain: Chain, shape: Polyhedron, plane: Plane, solid: bool) -> None:
        self.chain = chain
        self.kinds = chain.links.kinds
        self.path = range(1, chain.n_links)  # the root stands
        low, high = shape.bounds
        pick = np.array([[k >> i & 1 for i in range(3)] for k in range(8)], bool)
        self.corners = np.column_stack([np.where(pick, high, low), np.ones(8)])
        self.rows = np.eye(3) if solid else plane.axes
        self.normal = plane.normal

    def of(self, low: np.ndarray, high: np.ndarray):
        """chord, turn, middle and moves, as in `BodyKnots`, of intervals from `low` to `high`."""
        course = self.chain.course(low, high)
        poses = self.chain.poses_at(0.5 * (low + high))
        bent = self._bend(course)
        # Newton's laws aside: x'' = T'' x is affine in x, so its length is greatest at a corner of the box.
        inward = np.einsum("rc,ncd,kd->nkr", self.rows, bent[:, :3], self.corners)
        first = np.sqrt((inward**2).sum(axis=2)).max(axis=1)
        third, turn = self._third(poses, course)
        moves = np.any(np.concatenate([part[:, 1:] for part in course[1:4]], axis=1), axis=1)
        chord = np.where(moves, (0.5 * first + third / 6.0) * (1.0 + 1e-9), 0.0)
        return chord, turn, poses[:, -1], moves

    def _bend(self, course: Course) -> np.ndarray:
        """(n, 4, 4) the second derivative of world_from_link in the middle, by half the interval."""
        n = len(course.position)
        pose = np.broadcast_to(course.fixed[0], (n, 4, 4))
        speed, bent = np.zeros((n, 4, 4)), np.zeros((n, 4, 4))
        for i in self.path:
            own, d_own, dd_own = self._joint(i, course)
            bent = bent @ own + 2.0 * speed @ d_own + pose @ dd_own
            speed = speed @ own + pose @ d_own
            pose = pose @ own
        return bent

    def _joint(self, i: int, course: Course):
        """The motion of one joint and its first two derivatives by half the interval, (n, 4, 4) each."""
        value, speed, bend = (part[:, i] for part in course[:3])
        own = np.zeros((3, len(value), 4, 4))
        own[0] = np.eye(4)
        if self.kinds[i] == SLIDING:
            for k, part in enumerate((value, speed, bend)):
                own[k, :, :3, 3] = part[:, None] * course.axes[i]
        elif self._turns(i):
            cross = _across(course.axes[i])
            sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
            square, speed, bend = cross @ cross, speed[:, None, None], bend[:, None, None]
            once, twice = cosine * cross + sine * square, cosine * square - sine * cross
            own[0, :, :3, :3] += sine * cross + (1.0 - cosine) * square
            own[1, :, :3, :3] = speed * once
            own[2, :, :3, :3] = speed**2 * twice + bend * once
        return course.fixed[i] @ own

    def _turns(self, i: int) -> bool:
        return self.kinds[i] in (TURNING, BALL)

    def _third(self, poses: np.ndarray, course: Course) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the third derivative of any point [m] and of the turn of the normal in the body [rad].

        From the link to the root: y = E(theta) z, and with bounds w, v, u of theta's first three derivatives
        |y'''| <= (w^3 + 3 w v + u) r + 3 (w^2 + v) |z'| + 3 w |z''| + |z'''|, where r is the greatest distance
        from the axis, in the middle plus how far the joints below move it.
        """
        n = len(poses)
        speed, bend, jerk = (np.abs(part) for part in course[1:4])
        angle = speed + 0.5 * bend + jerk / 6.0
        w, v, u = speed + bend + 0.5 * jerk, bend + jerk, jerk
        first, second, third, turn = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        world = self.corners @ poses[:, -1].transpose(0, 2, 1)
        above = sum((angle[:, i] for i in self.path if self._turns(i)), np.zeros(n))
        for i in reversed(self.path):
            a, b, c = w[:, i], v[:, i], u[:, i]
            if self.kinds[i] == SLIDING:
                first, second, third = first + a, second + b, third + c
            elif self._turns(i):
                above = above - angle[:, i]
                axis = _turned(poses[:, i, :3, :3], course.axes[i])
                off = np.cross(world[:, :, :3] - poses[:, None, i, :3, 3], axis[:, None])
                arm = np.sqrt((off**2).sum(axis=2)).max(axis=1) + first
                third = third + 3.0 * a * second + 3.0 * (a**2 + b) * first
                third = third + (a**3 + 3.0 * a * b + c) * arm
                second = second + 2.0 * a * first + (a**2 + b) * arm
                first = first + a * arm
                tilt = np.sqrt((np.cross(axis, self.normal) ** 2).sum(axis=1))
                turn = turn + angle[:, i] * np.minimum(1.0, tilt + np.maximum(above, 0.0))
        return third, turn


def _across(axis: np.ndarray) -> np.ndarray:
    """(..., 3, 3) the matrix that maps a vector to the cross product of an axis (..., 3) and it."""
    x, y, z = np.moveaxis(axis, -1, 0)
    none = np.zeros_like(x)
    rows = [[none, -z, y], [z, none, -x], [-y, x, none]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _turned(rotations: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """(n, 3) one axis (3,) turned by each rotation (n, 3, 3), or each of (n, 3) by its own."""
    return rotations @ axis if axis.ndim == 1 else (rotations @ axis[:, :, None])[:, :, 0]
