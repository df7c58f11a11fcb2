"""Ours, and the ways to a distance that are approximate by design, behind the face of the peers.

Ours exact and by the first paper; points sampled on both surfaces; balls round the bodies; convex hulls.
Not for: other libraries' own distances (`peers`).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from inputs import Scene, Solid
from loops import sphere_of
from peers import Coal
from scipy.spatial import KDTree

import clearance as cl
from clearance.query.paper import distance_paper


class Placed:
    """A body and where it is; `form` is what a contender made of it."""

    def __init__(self, form: Any) -> None:
        self.form, self.pose = form, np.eye(4)


class _Posing:
    """Keeps the pose beside the body."""

    def place(self, body: Placed, pose: np.ndarray) -> None:
        """Moves a body to a (4, 4) `world_from_body` [m]."""
        body.pose = pose


class Ours(_Posing):
    """`clearance.distance`, one pair a call; its tree is built with the body."""

    name = "clearance exact"

    def body(self, given: Solid) -> Placed:
        """The polyhedron itself."""
        cl.distance(given.shape, given.shape)
        return Placed(given.shape)

    def distance(self, a: Placed, b: Placed) -> float:
        """One exact query."""
        return cl.distance(a.form, b.form, pose_a=a.pose, pose_b=b.pose).distance


class Paper(Ours):
    """`clearance` by the first paper's method, its rules on or off."""

    def __init__(
        self, tolerance: float = math.inf, rule_1: bool = True, rule_2: bool = True
    ) -> None:
        self._options = {"tolerance": tolerance, "rule_1": rule_1, "rule_2": rule_2}
        rules = [n for n, on in (("1", rule_1 and math.isfinite(tolerance)), ("2", rule_2)) if on]
        within = f" {tolerance * 1e3:g} mm" if "1" in rules else ""
        self.name = f"paper, rules {'+'.join(rules)}{within}" if rules else "paper, no rules"
        self.name = self.name.replace("rules 1 ", "rule 1 ").replace("rules 2", "rule 2")

    def body(self, given: Solid) -> Placed:
        """The polyhedron itself."""
        return Placed(given.shape)

    def distance(self, a: Placed, b: Placed) -> float:
        """One query; infinite where the rules cut everything, which is no answer."""
        found = distance_paper(a.form, b.form, a.pose, b.pose, **self._options).distance
        return found if math.isfinite(found) else math.nan


class SampledPoints(_Posing):
    """Points sampled on both surfaces by area, the second's in a KD-tree; never below the truth."""

    def __init__(self, n_points: int) -> None:
        self.n_points = n_points
        self.name = f"points 1e{round(math.log10(n_points))}"

    def body(self, given: Solid) -> Placed:
        """The points, or the tree of them where the body stands."""
        points = sampled([given], [np.eye(4)], self.n_points)
        return Placed(KDTree(points) if given.stands else points)

    def distance(self, a: Placed, b: Placed) -> float:
        """The least distance of a's points, moved into b's frame, from b's."""
        motion = np.linalg.inv(b.pose) @ a.pose
        return least_distance(b.form, a.form @ motion[:3, :3].T + motion[:3, 3])


def least_distance(tree: KDTree, points: np.ndarray) -> float:
    """[m] The least of points from those of a tree; a few first, so that the many look no further."""
    best = math.inf
    for stride in (1000, 30, 1):
        distances = tree.query(points[::stride], distance_upper_bound=best)[0]
        best = min(best, float(distances.min()))
    return best


def sampled(solids: list[Solid], poses: list[np.ndarray], n_points: int) -> np.ndarray:
    """(n_points, 3) [m] evenly distributed over the area of all triangles, each solid at its pose."""
    corners = np.concatenate(
        [s.soup.corners @ p[:3, :3].T + p[:3, 3] for s, p in zip(solids, poses, strict=True)]
    )
    random = np.random.default_rng(3)
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    chance = areas / areas.sum() if areas.sum() > 0.0 else None
    chosen = random.choice(len(corners), n_points, p=chance)
    u, v = random.random((2, n_points, 1))
    outside = u + v > 1.0
    u, v = np.where(outside, 1.0 - u, u), np.where(outside, 1.0 - v, v)
    return corners[chosen, 0] + u * sides[chosen, 0] + v * sides[chosen, 1]


class SampledScene:
    """A whole scene as points: all links' against one tree of all obstacles'; a loop over steps."""

    coherent = False
    library = "points"

    def __init__(self, scene: Scene, n_points: int) -> None:
        moving, standing = scene.moving, scene.standing
        assert len(scene.index) == len(moving) * len(standing), "one tree holds all pairs"
        self.name = SampledPoints(n_points).name
        self._scene, self._moving = scene, moving
        areas = np.array([area_of(scene.bodies[i]) for i in moving])
        shares = np.maximum(1, np.round(n_points * areas / areas.sum())).astype(int)
        self._links = [
            sampled([scene.bodies[i]], [np.eye(4)], n) for i, n in zip(moving, shares, strict=True)
        ]
        still = [scene.bodies[i] for i in standing]
        self._tree = KDTree(sampled(still, list(scene.poses[0, standing]), n_points))
        self.counters: dict[str, int] = {}

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        return np.array([self._step(int(step)) for step in steps])

    def _step(self, step: int) -> float:
        poses = self._scene.poses[step, self._moving]
        moved = [
            points @ pose[:3, :3].T + pose[:3, 3]
            for points, pose in zip(self._links, poses, strict=True)
        ]
        return least_distance(self._tree, np.concatenate(moved))


def area_of(given: Solid) -> float:
    """[m^2] of all triangles."""
    corners = given.soup.corners
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(sides, axis=1).sum())


class BoundingSpheres(_Posing):
    """One ball round each body; never above the truth, and contact long before it."""

    name = "bounding spheres"

    def body(self, given: Solid) -> Placed:
        """Centre and radius."""
        return Placed(sphere_of(given.soup.vertices))

    def distance(self, a: Placed, b: Placed) -> float:
        """Between the balls."""
        centres = [body.pose[:3, :3] @ body.form[0] + body.pose[:3, 3] for body in (a, b)]
        return max(0.0, math.dist(*centres) - a.form[1] - b.form[1])


class ConvexHulls(Coal):
    """Convex hulls by qhull, their distance by Coal's GJK."""

    name = "hulls (Coal GJK)"

    def body(self, given: Solid) -> Any:
        """A convex collision object."""
        points = self.coal.StdVec_Vec3s()
        for vertex in given.soup.vertices:
            points.append(vertex)
        return self.coal.CollisionObject(self.coal.Convex.convexHull(points, True, "Qt"))
