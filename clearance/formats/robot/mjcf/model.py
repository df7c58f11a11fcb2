"""A compiled MJCF model in plain numbers. Not for: making one (`mujoco_adapter`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class MjcfMesh(NamedTuple):
    """A mesh as it is written: points p of its file become scale * (turned^-1 (p - moved)).

    Attributes:
        file: as it is written; empty where the surface stands in the document or is made by MuJoCo.
        scale, moved: (3,). turned: (3, 3).
        points, corners: (n, 3) [m] and (m, 3) of a mesh without a file; no corners for the hull of its points.
    """

    file: str
    scale: np.ndarray
    moved: np.ndarray
    turned: np.ndarray
    points: np.ndarray
    corners: np.ndarray

    @property
    def lies_as_in_its_file(self) -> bool:
        """True for one that is at most scaled."""
        return not self.moved.any() and np.array_equal(self.turned, np.eye(3))


class MjcfGeom(NamedTuple):
    """A shape on a body.

    Attributes:
        kind: "box", "sphere", "capsule", "cylinder", "ellipsoid", "plane", "hfield", "mesh" or "sdf".
        size: (3,) half sizes, radius and half length, or semi-axes [m], as MuJoCo has them.
        pose: (4, 4) of the shape, of a mesh as `MjcfMesh` makes it, in the body [m]. mesh: its name.
        contype, conaffinity: bits; two geoms may collide where the first of one meets the second of the other.
        collides: it takes part in contacts. shown: it is of a group that MuJoCo's viewer shows from the start.
    """

    name: str
    kind: str
    body: int
    size: np.ndarray
    pose: np.ndarray
    mesh: str
    contype: int
    conaffinity: int
    collides: bool
    shown: bool


class MjcfJoint(NamedTuple):
    """A joint between a body and its parent; those of one body act in their order.

    Attributes:
        kind: "free", "ball", "slide" or "hinge". place, axis: (3,) in the body.
        reference: the value at which the body is as written [rad or m].
        limits: lower and upper [rad or m]; None without limits.
    """

    name: str
    kind: str
    body: int
    place: np.ndarray
    axis: np.ndarray
    reference: float
    limits: tuple[float, float] | None


class MjcfBody(NamedTuple):
    """A body.

    Attributes:
        parent: the place of its parent; of the world (the first) its own. pose: (4, 4) in it [m].
        welded_to: the place of the topmost body that no joint lies between; its own where it has a joint.
    """

    name: str
    parent: int
    welded_to: int
    pose: np.ndarray
    is_mocap: bool


class MjcfFollower(NamedTuple):
    """A joint whose value is its reference + polynomial(value of `master` - its reference); None: a constant."""

    joint: str
    master: str | None
    polynomial: tuple[float, ...]
    active: bool


class MjcfKey(NamedTuple):
    """A keyframe; `positions`: (n,) of all joints in their order, 7 of a free one, 4 of a ball, 1 of others."""

    name: str
    positions: np.ndarray


@dataclass(frozen=True, eq=False)
class MjcfModel:
    """A compiled model; bodies with parents before children, the world first.

    Attributes:
        excludes: pairs of bodies that do not collide. pairs: of geoms that do, whatever else is said.
        filters_parents: bodies do not collide with their parents.
        reference: (n,) the positions at which the model is written, as `MjcfKey` has them.
    """

    name: str
    bodies: tuple[MjcfBody, ...]
    joints: tuple[MjcfJoint, ...]
    geoms: tuple[MjcfGeom, ...]
    follows: tuple[MjcfFollower, ...]
    excludes: tuple[tuple[str, str], ...]
    pairs: tuple[tuple[int, int], ...]
    filters_parents: bool
    keys: tuple[MjcfKey, ...]
    reference: np.ndarray
