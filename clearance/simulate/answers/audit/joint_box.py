"""How near two links of one robot can come while the joints between them are anywhere in a box of positions.

Two lower bounds, in the frame of the first link. No point of the second link moves farther than

    sum over joints k of half_k arm_k,

arm_k how far the link gets from the axis of joint k (Lipschitz bound). Where both links are separate along the
direction u of their nearest points, sliding past each other costs nothing in the first order: a point x of the
second link stays beyond u.x - sum |half_k u.v_k(x)| - rest, with v_k the velocity by joint k. It is concave in x,
so the corners of the link's hull decide; rest is of second order (source: `kernels.motion.joint_motion_bound`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope_hull import hull_corners
from clearance.world.kinematic_chain import KinematicChain

SLACK = 1e-9
"""Rounding of poses and bounds, relative to the sizes of bodies and chain: some hundred products of 2^-52."""

MOST_CORNERS = 1024
"""Most corners of a hull that are all checked; a larger hull is replaced by the corners of its box."""


class PositionBoxes(NamedTuple):
    """(n, k) middles and half widths of boxes of positions [rad or m]."""

    middle: np.ndarray
    half: np.ndarray

    def of(self, which: np.ndarray | slice) -> PositionBoxes:
        """Some of them."""
        return PositionBoxes(self.middle[which], self.half[which])

    def halved(self, share: np.ndarray) -> PositionBoxes:
        """(2n) the halves, cut across the joint of the greatest of `share` (n, k)."""
        rows, cut = np.arange(len(share)), np.argmax(share, axis=1)
        half = self.half.copy()
        half[rows, cut] *= 0.5
        step = np.zeros_like(half)
        step[rows, cut] = half[rows, cut]
        middles = np.stack([self.middle - step, self.middle + step], axis=1)
        return PositionBoxes(middles.reshape(-1, half.shape[1]), np.repeat(half, 2, axis=0))


class BoxDistances(NamedTuple):
    """What a search found in the middle of n boxes, in the frame of the first link.

    Attributes:
        distances: (n,) [m]. points: (n, 2, 3) the nearest points [m].
        frames: (n, joints + 1, 4, 4) of `KinematicChain.frames`.
    """

    distances: np.ndarray
    points: np.ndarray
    frames: np.ndarray

    def of(self, which: np.ndarray) -> BoxDistances:
        """Some of them."""
        return BoxDistances(*(column[which] for column in self))

    @property
    def directions(self) -> np.ndarray:
        """(n, 3) unit vectors from the first link to the second."""
        return (self.points[:, 1] - self.points[:, 0]) / self.distances[:, None]


class BoxMotion(NamedTuple):
    """How far the second link moves over boxes.

    Attributes:
        share: (n, k) [m] by each free joint. rest: (n,) [m] what of it is not of first order.
    """

    share: np.ndarray
    rest: np.ndarray

    @property
    def way(self) -> np.ndarray:
        """(n,) [m] in all."""
        return self.share.sum(axis=1)


@dataclass(frozen=True, eq=False)
class JointBox:
    """Two links, the joints between them, and what the bounds need of their shapes.

    Attributes:
        corners_a, corners_b: (n, 3) of polytopes that contain them. box_b: (8, 3) of a box that contains b.
        slack: [m] what rounding can do to a bound.
    """

    chain: KinematicChain
    corners_a: np.ndarray
    corners_b: np.ndarray
    box_b: np.ndarray
    slack: float

    @classmethod
    def of(cls, chain: KinematicChain, shape_a: Polyhedron, shape_b: Polyhedron) -> JointBox:
        """Of the shapes of both links."""
        poses = [*(joint.before for joint in chain.joints), chain.end]
        size = sum(float(np.linalg.norm(pose[:3, 3])) for pose in poses)
        size += sum(float(np.abs(shape.bounds).sum()) for shape in (shape_a, shape_b))
        size += chain.longest_slides
        corners = _hull_corners(shape_a), _hull_corners(shape_b)
        return cls(chain, *corners, shape_b.box_corners, SLACK * size)

    def motion(self, half: np.ndarray, frames: np.ndarray) -> BoxMotion:
        """How far the second link moves over boxes of half widths (n, k) about `frames`."""
        share, rest, moved = np.zeros(half.shape), np.zeros(len(half)), np.zeros(len(half))
        joints = self.chain.joints
        sizes = [abs(joint.factor) * half[:, joint.column] for joint in joints]
        turned = sum((size for size, joint in zip(sizes, joints, strict=True) if joint.turns), 0.0)
        corners = _moved(frames[:, -1], self.box_b)
        for i in reversed(range(len(joints))):  # those nearest to the second link first
            way = sizes[i]
            if joints[i].turns:
                turned = np.maximum(0.0, turned - sizes[i])
                away = np.cross(corners - frames[:, i, None, :3, 3], self._axes(frames, i)[:, None])
                arm = np.sqrt(np.einsum("nvi,nvi->nv", away, away).max(axis=1)) + moved
                way = sizes[i] * arm
                rest += 0.5 * way * (sizes[i] + 2.0 * turned)
            else:
                rest += way * turned
            share[:, joints[i].column] += way
            moved = moved + way
        return BoxMotion(share, rest)

    def first_order_separation(self, half: np.ndarray, seen: BoxDistances) -> np.ndarray:
        """(n,) [m] their least separation along `directions` over boxes of half widths (n, k), but for `rest`."""
        u = seen.directions
        corners = _moved(seen.frames[:, -1], self.corners_b)
        velocities = np.zeros((half.shape[1], *corners.shape[:2]))
        for i, joint in enumerate(self.chain.joints):
            axes = self._axes(seen.frames, i)
            if joint.turns:
                lever = np.cross(u, axes)
                along = np.einsum("nvi,ni->nv", corners, lever)
                along -= np.einsum("ni,ni->n", seen.frames[:, i, :3, 3], lever)[:, None]
            else:
                along = np.einsum("ni,ni->n", u, axes)[:, None]
            velocities[joint.column] += joint.factor * along
        lowest = np.einsum("nvi,ni->nv", corners, u)
        lowest -= np.einsum("knv,nk->nv", np.abs(velocities), half)
        return lowest.min(axis=1) - (u @ self.corners_a.T).max(axis=1)

    def slopes(self, seen: BoxDistances) -> np.ndarray:
        """(n, k) the derivatives of the distances by each free joint [m per rad or m]."""
        slopes = np.zeros((len(seen.distances), len(self.chain.masters)))
        for i, joint in enumerate(self.chain.joints):
            moved = self._axes(seen.frames, i)
            if joint.turns:
                moved = np.cross(moved, seen.points[:, 1] - seen.frames[:, i, :3, 3])
            slopes[:, joint.column] += joint.factor * np.einsum("ni,ni->n", seen.directions, moved)
        return slopes

    def _axes(self, frames: np.ndarray, i: int) -> np.ndarray:
        """(n, 3) the axis of a joint."""
        return frames[:, i, :3, :3] @ self.chain.joints[i].axis


def _moved(poses: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n, m, 3) points (m, 3) at poses (n, 4, 4)."""
    return np.einsum("nij,mj->nmi", poses[:, :3, :3], points) + poses[:, None, :3, 3]


def _hull_corners(shape: Polyhedron) -> np.ndarray:
    """(n, 3) the corners of the hull of a shape, or of its box where that has too many."""
    corners = hull_corners(shape.vertices)
    return corners if len(corners) <= MOST_CORNERS else shape.box_corners
