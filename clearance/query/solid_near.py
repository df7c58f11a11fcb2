"""The part of a large solid that another body can reach: its triangles alone give the same common region."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.geometry import boolean
from clearance.geometry.convex_parts import ConvexParts, solid_of
from clearance.geometry.polyhedron import Polyhedron

LARGE = 5000
"""Triangles from which on it is worth to cut a solid down: one boolean, 0.1 s at 490,000."""

MARGIN = 0.5
"""[-] Of the other body's diagonal, all round: it is moved a little when ways out are sought."""


@dataclass(frozen=True, eq=False)
class SolidNear:
    """A solid within a box (2, 3) [m] of its own frame."""

    solid: Any
    box: np.ndarray

    def contains(self, other: Polyhedron, own_from_other: np.ndarray) -> bool:
        """True if the other body lies in the box, so that all it shares with the solid is here."""
        low, high = box_at(other, own_from_other)
        return bool((low >= self.box[0]).all() and (high <= self.box[1]).all())


def solid_near(
    body: Polyhedron, parts: ConvexParts, other: Polyhedron, own_from_other: np.ndarray
) -> SolidNear | None:
    """The solid about where the other body is at poses (k, 4, 4); None where it is small or has no solid."""
    if parts.solid is None or body.n_triangles < LARGE:
        return None
    boxes = np.array([box_at(other, pose) for pose in own_from_other])
    margin = MARGIN * float(np.linalg.norm(np.ptp(other.bounds, axis=0)))
    box = np.array([boxes[:, 0].min(axis=0) - margin, boxes[:, 1].max(axis=0) + margin])
    return SolidNear(boolean.evaluated(parts.solid ^ boolean.block(box)), box)


def solid_for(
    parts: ConvexParts, near: SolidNear | None, other: Polyhedron, own_from_other: np.ndarray
) -> Any:
    """manifold3d's solid to share with the other body: the part near it, else the whole, else the convex part.

    Raises:
        ClearanceError: manifold3d refuses the convex part.
    """
    if near is not None and near.contains(other, own_from_other):
        return near.solid
    return parts.solid if parts.solid is not None else solid_of(parts.outer[0])


def box_at(body: Polyhedron, pose: np.ndarray) -> np.ndarray:
    """(2, 3) [m] a box about the body after a rigid motion (4, 4), a little wider than rounding."""
    middle = pose[:3, :3] @ body.bounds.mean(axis=0) + pose[:3, 3]
    half = np.abs(pose[:3, :3]) @ (0.5 * np.ptp(body.bounds, axis=0))
    half = half + 1e-12 * (np.abs(middle).max() + half.max())
    return np.array([middle - half, middle + half])
