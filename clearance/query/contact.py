"""Overlap of two bodies: penetration depth, separation vector, common region and its volume.

Depth comes from convex parts (`penetration`, `retreat`), the region of convex bodies from the exact cut
(`intersection`), that of concave ones from manifold3d. Whatever is not exact is a pair of bounds. Not for:
whether bodies are in contact (`distance`), which never depends on parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.errors import BadInput, ClearanceError
from clearance.geometry import boolean
from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.convex_parts import ConvexParts, convex_parts, hull_drawn_in
from clearance.geometry.edges import fans_of
from clearance.geometry.point_cloud import require_surface
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.geometry.pose import inverse, validated_pose
from clearance.query.distance import distance
from clearance.query.intersection import Intersection, intersect
from clearance.query.penetration import ConvexCorners, Penetration, depths_at_most, penetration
from clearance.query.region_bounds import ball_depth, thickness, volume_of_facets, ways_through
from clearance.query.retreat import Ray, separations, shortened, shortened_through
from clearance.query.solid_near import SolidNear, solid_for, solid_near

EXACT = 1e-12
"""[-] Bounds that differ by no more, relative to the bodies' size, are one value."""

MOST_CORNERS = 2000
"""Corners of a region whose hull is made where the bodies were not cut: a tenth of a second."""

CLOSE = 0.99
"""[-] A lower bound that is this share of the upper one is not worth a costly second one."""


@dataclass(frozen=True, eq=False)
class Contact:
    """The overlap of body a with body b.

    Attributes:
        penetration: [m] `a` moved by `penetration * direction` is separate from `b`; the shortest such, or an
            upper bound of it.
        penetration_at_least: [m] no shorter translation separates them.
        direction: (3,) unit, world frame: the retreat direction of `a`.
        volume: [m^3] of the region that both fill, or an upper bound. volume_at_least: a lower bound, unless one
            component of a body goes through itself.
        centroid: (3,) [m] of the region, world frame; the common point where they only touch.
        region: its surface, world frame; empty where they only touch, and for surfaces without an inside that
            of the hulls.
        exact: (depth, volume) are exact to rounding.
        notes: what stands for a body that is not convex, or is faceted; one line each.
    """

    penetration: float
    penetration_at_least: float
    direction: np.ndarray
    volume: float
    volume_at_least: float
    centroid: np.ndarray
    region: ClosedMesh
    exact: tuple[bool, bool]
    notes: tuple[str, ...]

    def placed(self, world_from_b: np.ndarray) -> Contact:
        """The same overlap, its vectors turned and moved by a (4, 4) pose."""
        turn, shift = world_from_b[:3, :3], world_from_b[:3, 3]
        mesh = ClosedMesh(self.region.vertices @ turn.T + shift, self.region.triangles)
        direction, centroid = turn @ self.direction, turn @ self.centroid + shift
        return replace(self, direction=direction, centroid=centroid, region=mesh)


def contact(
    a: Polyhedron,
    b: Polyhedron,
    *,
    pose_a: np.ndarray | None = None,
    pose_b: np.ndarray | None = None,
    rough: bool = False,
    bounded: bool = True,
) -> Contact | None:
    """The overlap of two bodies; None if they are separate.

    Args:
        pose_a, pose_b: (4, 4) `world_from_body` [m]; the identity if not given.
        rough: concave bodies are not cut, which needs milliseconds only: bounds of the depth are wider.
        bounded: False leaves the lower bound of the depth at 0 where it is not known anyway: half the work.

    Raises:
        BadPose: not a rigid motion. BadInput: a body without extent in space, or that may be inside another one
            whose surface has holes. BadShape: a cloud of points.

    Exactness: for two convex bodies, exact to rounding. Otherwise `penetration` and `volume` are upper bounds
        and `_at_least` lower ones; the translation has then been confirmed by the distance of the bodies
        themselves, where both have an inside.
    """
    require_surface(a, "a"), require_surface(b, "b")
    world_from_a = validated_pose(np.eye(4) if pose_a is None else pose_a)
    world_from_b = validated_pose(np.eye(4) if pose_b is None else pose_b)
    near = distance(a, b, pose_a=world_from_a, pose_b=world_from_b)
    if near.inside == "undecided":
        raise BadInput(
            "it is open whether one body is inside the other: a surface has holes or cracks",
            valid="closed meshes",
        )
    if not near.contact:
        return None
    b_from_a = inverse(world_from_b) @ world_from_a
    witness = (inverse(world_from_b) @ [*near.point_b, 1.0])[:3]
    try:
        pair = BodyPair(a, b, convex_parts(a, rough=rough), convex_parts(b, rough=rough))
    except ClearanceError as error:
        raise BadInput(f"a body in contact has no depth: {error.problem}") from None
    return pair.contact(b_from_a, witness, bounded=bounded).placed(world_from_b)


@dataclass(frozen=True, eq=False)
class BodyPair:
    """Two bodies with their convex parts; each body in its own frame."""

    a: Polyhedron
    b: Polyhedron
    parts_a: ConvexParts
    parts_b: ConvexParts
    near_a: SolidNear | None = None
    near_b: SolidNear | None = None

    @cached_property
    def hull_a(self) -> Polytope:
        """The hull of a, in its own frame; prepared once for all poses."""
        return _hull_of(self.parts_a)

    @cached_property
    def hull_b(self) -> Polytope:
        """The hull of b."""
        return _hull_of(self.parts_b)

    @property
    def is_rated_by_volume(self) -> bool:
        """True where a body was not cut, both have an inside, and manifold3d knows what they share."""
        parts = self.parts_a, self.parts_b
        known = all(part.solid is not None or part.convex for part in parts)
        return known and all(part.closed for part in parts) and any(part.rough for part in parts)

    def near(self, poses: np.ndarray) -> BodyPair:
        """The same pair for poses (k, 4, 4) about these: large solids are cut down to what the other can reach."""
        if not self.is_rated_by_volume:
            return self
        back = np.array([inverse(pose) for pose in poses])
        near_a = solid_near(self.a, self.parts_a, self.b, back)
        near_b = solid_near(self.b, self.parts_b, self.a, poses)
        return replace(self, near_a=near_a, near_b=near_b)

    def shared(self, b_from_a: np.ndarray) -> ClosedMesh | None:
        """The common region of the meshes of two solids, not both convex; None where it is not known."""
        try:
            one = solid_for(self.parts_a, self.near_a, self.b, inverse(b_from_a))
            other = solid_for(self.parts_b, self.near_b, self.a, b_from_a)
        except ClearanceError:
            return None
        return boolean.mesh_of(boolean.moved(one, b_from_a) ^ other)

    def contact(self, b_from_a: np.ndarray, witness: np.ndarray, bounded: bool = True) -> Contact:
        """The overlap in the frame of b, of bodies that are in contact.

        Args:
            b_from_a: (4, 4) pose [m]. witness: (3,) a common point. bounded: as there.
        """
        return _PlacedPair(self, b_from_a, witness).found(bounded=bounded)


@dataclass(frozen=True, eq=False)
class _PlacedPair:
    """A pair at one relative pose, all in the frame of b."""

    pair: BodyPair
    b_from_a: np.ndarray
    witness: np.ndarray

    def found(self, *, bounded: bool) -> Contact:
        region, volume, volume_at_least = self._region
        ray, at_least = self._depth(bounded=bounded)
        return Contact(
            penetration=ray.length,
            penetration_at_least=min(at_least, ray.length),
            direction=ray.direction,
            volume=volume,
            volume_at_least=min(volume_at_least, volume),
            centroid=self.witness if region.is_empty else region.centroid,
            region=region,
            exact=(ray.length - at_least <= EXACT * self.size, volume_at_least >= volume),
            notes=tuple(parts.note for parts in self._both_parts if parts.note),
        )

    def _corners(
        self, parts_a: Sequence[Polytope], parts_b: Sequence[Polytope]
    ) -> tuple[list[ConvexCorners], list[ConvexCorners]]:
        """Convex parts of a and of b, where they are."""
        placed = [ConvexCorners.placed(part, self.b_from_a) for part in parts_a]
        return placed, [ConvexCorners(part.vertices, part.normals) for part in parts_b]

    @cached_property
    def size(self) -> float:
        """[m] the sum of the bodies' diagonals."""
        diagonals = (np.ptp(body.bounds, axis=0) for body in (self.pair.a, self.pair.b))
        return float(sum(map(np.linalg.norm, diagonals)))

    @property
    def _both_convex(self) -> bool:
        return all(parts.convex for parts in self._both_parts)

    @property
    def _both_closed(self) -> bool:
        return all(parts.closed for parts in self._both_parts)

    def _depth(self, *, bounded: bool) -> tuple[Ray, float]:
        """The separation vector, and a lower bound of its length; 0 where that is neither known nor needed.

        A search is needed where hulls are more than the bodies; they stand for surfaces without an inside.
        """
        outer = self._corners(*(parts.outer for parts in self._both_parts))
        whole = penetration(*map(_joined, outer))
        ray = Ray(whole.depth, whole.direction)
        if self._both_convex and self.pair.a.excess + self.pair.b.excess == 0.0:
            return ray, whole.at_least
        if self._by_region:
            ray = self._through_region(ray)
        elif self._both_closed and not all(parts.tight for parts in self._both_parts):
            across = (ray.direction for ray in self._rays_across())
            extra = np.array([whole.direction, *across])
            rays = separations(*outer, whole.depth, extra)
            ray = self._confirmed([*rays, ray])
        if not bounded:
            return ray, 0.0
        at_least = self._depth_of_balls() if self._by_region else self._depth_of_inner()
        is_close = at_least > CLOSE * ray.length
        return ray, max(at_least, self._width_of_region(at_least, only_convex=is_close))

    @property
    def _by_region(self) -> bool:
        """True where a body was not cut, and what both share is known."""
        if not self._both_closed or not any(parts.rough for parts in self._both_parts):
            return False
        return self._mesh_shared is not None and not self._mesh_shared.is_empty

    def _through_region(self, proven: Ray) -> Ray:
        """The shortest translation that the bodies confirm, along thin directions or normals of the region."""
        rays = [*self._rays_across(), *ways_through(self._region[0])]
        padded = self._padded(sorted(rays, key=lambda ray: ray.length))
        found = shortened_through(padded, proven.length, self._is_clear, self._still_shared)
        return found or self._confirmed([proven])

    def _still_shared(self, shift: np.ndarray, along: np.ndarray) -> float:
        """[m] how thick what both share is along a unit direction after a translation (3,) of a; 0 if nothing."""
        mesh = _PlacedPair(self.pair, self._moved(shift), self.witness)._mesh_shared
        return 0.0 if mesh is None or mesh.is_empty else float(thickness(mesh, along[None, :])[0])

    def _depth_of_balls(self) -> float:
        """[m] as `ball_depth`."""
        a, b = self.pair.a, self.pair.b
        placed_a = a.vertices @ self.b_from_a[:3, :3].T + self.b_from_a[:3, 3]
        bodies = [placed_a[a.triangles()], b.vertices[b.triangles()]]
        return ball_depth(self._region[0], bodies, a.excess + b.excess)

    def _padded(self, rays: list[Ray]) -> list[Ray]:
        """The same a little longer, so that rounding does not leave a touch."""
        return [Ray(r.length * (1.0 + 1e-12) + 1e-13 * self.size, r.direction) for r in rays]

    def _confirmed(self, rays: list[Ray]) -> Ray:
        """The shortest translation that the bodies confirm; the hulls prove the last of `rays` anyway."""
        padded = self._padded(rays)
        return shortened(padded, self._is_clear) or padded[-1]

    def _is_clear(self, shift: np.ndarray) -> bool:
        return distance(self.pair.a, self.pair.b, pose_a=self._moved(shift)).distance > 0.0

    def _moved(self, shift: np.ndarray) -> np.ndarray:
        """(4, 4) [m] the pose of a after a translation (3,)."""
        pose = self.b_from_a.copy()
        pose[:3, 3] += shift
        return pose

    def _depth_of_inner(self) -> float:
        """[m] the depth of the convex bodies inside both: no translation that separates the bodies is shorter.

        Pairs in turn by what 26 directions leave of their depth, until that is no more than the greatest found.
        """
        inner_a, inner_b = self._corners(*(parts.inner for parts in self._both_parts))
        at_most = depths_at_most(inner_a, inner_b)
        found = 0.0
        for row in np.argsort(-at_most, axis=None, kind="stable"):
            i, j = divmod(int(row), len(inner_b))
            if at_most[i, j] <= found:
                break
            found = max(found, penetration(inner_a[i], inner_b[j]).at_least)
        return found

    @cached_property
    def _width(self) -> Penetration | None:
        """The width of the hull of the region, and its direction; None where the region is empty."""
        region = self._region[0]
        if region.is_empty:
            return None
        corners = ConvexCorners(region.vertices, np.zeros((0, 3)))
        return penetration(corners, corners)

    def _rays_across(self) -> list[Ray]:
        """The two ways out of what is shared where it is thinnest; none where it is empty."""
        width = self._width
        if width is None:
            return []
        return [Ray(width.depth, direction) for direction in (width.direction, -width.direction)]

    def _width_of_region(self, more_than: float, only_convex: bool) -> float:
        """[m] the width of a convex part of the region: a separation of the bodies separates it from itself.

        Where the whole hull is no wider than `more_than` [m], no part of it is searched for.
        """
        region, volume, volume_at_least = self._region
        if volume_at_least < volume or self._width is None or self._width.depth <= more_than:
            return 0.0
        if len(region.vertices) > MOST_CORNERS and any(parts.rough for parts in self._both_parts):
            return 0.0
        try:
            parts = hull_drawn_in(region.vertices[region.triangles], only_convex)
        except ClearanceError:  # thinner than rounding
            return 0.0
        return max((penetration(part, part).at_least for part in parts), default=0.0)

    @cached_property
    def _region(self) -> tuple[ClosedMesh, float, float]:
        """The region, or that of the hulls, and its volume [m^3] from above and from below."""
        mesh = self._mesh_shared
        if mesh is not None:
            return mesh, mesh.volume, max(0.0, mesh.volume - self._shell(mesh))
        shared = intersect([self.pair.hull_a.moved(self.b_from_a), self.pair.hull_b])
        mesh = _mesh_of(shared)
        if self._both_convex:
            return mesh, shared.volume, max(0.0, shared.volume - self._shell(mesh))
        return mesh, shared.volume, self._volume_of_inner()

    def _volume_of_inner(self) -> float:
        """[m^3] the greatest region that a convex body inside a shares with one inside b."""
        inner_a = [
            Polytope(ConvexCorners.placed(p, self.b_from_a).vertices)
            for p in self.pair.parts_a.inner
        ]
        shared = [intersect([p, q]).volume for p in inner_a for q in self.pair.parts_b.inner]
        return max(shared, default=0.0)

    @property
    def _both_parts(self) -> tuple[ConvexParts, ConvexParts]:
        return self.pair.parts_a, self.pair.parts_b

    @cached_property
    def _mesh_shared(self) -> ClosedMesh | None:
        """The common region of the meshes, for closed bodies that are not both convex."""
        if self._both_convex or not self._both_closed or not boolean.available():
            return None
        return self.pair.shared(self.b_from_a)

    def _shell(self, region: ClosedMesh) -> float:
        """[m^3] what facets that stand out can add: their height times the area of those about the region."""
        if region.is_empty:
            return 0.0
        shells = ((self.pair.a, self.b_from_a), (self.pair.b, np.eye(4)))
        return sum(volume_of_facets(body, pose, region) for body, pose in shells)


def _hull_of(parts: ConvexParts) -> Polytope:
    if len(parts.outer) == 1:
        return parts.outer[0]
    return Polytope(np.concatenate([part.vertices for part in parts.outer]))


def _joined(parts: list[ConvexCorners]) -> ConvexCorners:
    return ConvexCorners(*(np.concatenate(rows) for rows in zip(*parts, strict=True)))


def _mesh_of(shared: Intersection) -> ClosedMesh:
    if shared.relation != "overlap":
        return ClosedMesh.empty()
    starts = np.cumsum([0, *map(len, shared.faces)])
    return ClosedMesh(shared.vertices, np.concatenate(shared.faces)[fans_of(starts)[0]])
