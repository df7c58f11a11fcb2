"""The other libraries behind one face: make a body, place it, ask for the distance of two bodies [m].

All get the same triangles in metres, as their users would hand them over, and none is told where it will
fail. A library that cannot be imported is named by `absent_peers`, never replaced. Not for: loops over
the pairs of a scene (`loops`), or methods that are approximate by design (`contenders`).
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

import numpy as np
from inputs import Solid

DISTRIBUTIONS = {
    "fcl": "python-fcl",
    "coal": "coal",
    "klampt": "Klampt",
    "pybullet": "pybullet",
    "python_solvespace": "python-solvespace",
}
"""Module to the name under which pip installs it."""

PAIR_LIBRARIES = ("fcl", "coal", "klampt", "pybullet")
"""Those that measure one pair at a time."""


class PairPeer(Protocol):
    """Anything that measures two placed bodies."""

    name: str

    def body(self, given: Solid) -> Any:
        """The peer's own form of a body."""

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Moves a body to a (4, 4) `world_from_body` [m]."""

    def distance(self, a: Any, b: Any) -> float:
        """[m] what the peer answers; 0 or less is contact; NaN if it has no answer."""


class Fcl:
    """python-fcl: trees of OBB and RSS over triangles."""

    name = "FCL"

    def __init__(self) -> None:
        import fcl

        self.fcl = fcl
        self._request = fcl.DistanceRequest()

    def body(self, given: Solid) -> Any:
        """A collision object with its own model."""
        soup = given.soup
        model = self.fcl.BVHModel()
        model.beginModel(len(soup.vertices), len(soup.triangles))
        model.addSubModel(soup.vertices, soup.triangles)
        model.endModel()
        return self.fcl.CollisionObject(model)

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Sets the object's transform."""
        body.setTransform(self.fcl.Transform(pose[:3, :3], pose[:3, 3]))

    def distance(self, a: Any, b: Any) -> float:
        """One `fcl.distance`."""
        return self.fcl.distance(a, b, self._request, self.fcl.DistanceResult())


class _OwnRoundShapes:
    """In front of FCL or Coal, which name shapes alike: their own sphere and cylinder if a body is one."""

    def __init__(self) -> None:
        super().__init__()
        self._centres: dict[int, np.ndarray] = {}

    def body(self, given: Solid) -> Any:
        """A primitive, or else the model of the triangles."""
        if given.round_shape is None:
            return super().body(given)
        radius, length, centre = given.round_shape
        shapes = self.shapes
        shape = shapes.Cylinder(radius, length) if length > 0.0 else shapes.Sphere(radius)
        made = shapes.CollisionObject(shape)
        self._centres[id(made)] = centre
        return made

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Sets the object's transform, moved to the centre of a primitive."""
        centre = self._centres.get(id(body))
        super().place(body, pose if centre is None else about(pose, centre))


class FclShapes(_OwnRoundShapes, Fcl):
    """python-fcl with its own sphere and cylinder, iterated by GJK, where the body is one."""

    name = "FCL shapes"

    @property
    def shapes(self) -> Any:
        """The module that has the shapes."""
        return self.fcl


class Coal:
    """Coal: trees of OBB-RSS over triangles, without nearest points, which makes it faster."""

    name = "Coal"

    def __init__(self) -> None:
        import coal

        self.coal = coal
        self._request = coal.DistanceRequest()
        self._request.enable_nearest_points = False
        self._result = coal.DistanceResult()

    def body(self, given: Solid) -> Any:
        """A collision object with its own model."""
        soup = given.soup
        model = self.coal.BVHModelOBBRSS()
        model.beginModel(len(soup.triangles), len(soup.vertices))
        points, triangles = self.coal.StdVec_Vec3s(), self.coal.StdVec_Triangle()
        for vertex in soup.vertices:
            points.append(vertex)
        for corners in soup.triangles.tolist():
            triangles.append(self.coal.Triangle(*corners))
        model.addSubModel(points, triangles)
        model.endModel()
        return self.coal.CollisionObject(model)

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Sets the object's transform."""
        body.setTransform(self.coal.Transform3s(pose[:3, :3], pose[:3, 3]))

    def distance(self, a: Any, b: Any) -> float:
        """One `coal.distance`."""
        self._result.clear()
        return self.coal.distance(a, b, self._request, self._result)


class CoalShapes(_OwnRoundShapes, Coal):
    """Coal with its own sphere and cylinder, iterated by GJK, where the body is one."""

    name = "Coal shapes"

    @property
    def shapes(self) -> Any:
        """The module that has the shapes."""
        return self.coal


class Klampt:
    """Klampt: PQP's trees of RSS; it alone takes an upper bound above which it may stop."""

    name = "Klampt"

    def __init__(self) -> None:
        import klampt

        self.klampt = klampt
        self._settings = klampt.DistanceQuerySettings()

    def body(self, given: Solid) -> Any:
        """A geometry with its tree built."""
        soup = given.soup
        mesh = self.klampt.TriangleMesh()
        mesh.setVertices(np.ascontiguousarray(soup.vertices))
        mesh.setIndices(np.ascontiguousarray(soup.triangles, dtype=np.int32))
        geometry = self.klampt.Geometry3D(mesh)
        geometry.distance_point([0.0, 0.0, 0.0])  # builds the tree
        return geometry

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Sets the current transform (columns of the rotation first)."""
        body.setCurrentTransform(pose[:3, :3].T.ravel().tolist(), pose[:3, 3].tolist())

    def distance(self, a: Any, b: Any, upper_bound: float = np.inf) -> float:
        """One `distance_ext`; at least `upper_bound` if the distance is not below it."""
        self._settings.upperBound = upper_bound
        return a.distance_ext(b, self._settings).d


class BulletHull:
    """PyBullet's `getClosestPoints` on the convex hulls of both meshes: what it makes of a mesh."""

    name = "PyBullet hulls"
    concave_obstacles = False

    def __init__(self) -> None:
        import pybullet

        self.bullet = pybullet
        self._client = pybullet.connect(pybullet.DIRECT)

    def body(self, given: Solid) -> Any:
        """A multibody without mass: the hull, or the triangles where a concave obstacle is asked for."""
        soup = given.soup
        concave = self.concave_obstacles and given.stands
        given = {"indices": soup.triangles.ravel().tolist()} if concave else {}
        flags = self.bullet.GEOM_FORCE_CONCAVE_TRIMESH if concave else 0
        shape = self.bullet.createCollisionShape(
            self.bullet.GEOM_MESH,
            vertices=soup.vertices.tolist(),
            flags=flags,
            physicsClientId=self._client,
            **given,
        )
        return self.bullet.createMultiBody(0.0, shape, physicsClientId=self._client)

    def place(self, body: Any, pose: np.ndarray) -> None:
        """Resets the base; its frame is the mesh frame because the mass is 0."""
        self.bullet.resetBasePositionAndOrientation(
            body, pose[:3, 3].tolist(), quaternion(pose), physicsClientId=self._client
        )

    def distance(self, a: Any, b: Any) -> float:
        """The least distance of the closest points; NaN if there are none."""
        found = self.bullet.getClosestPoints(a, b, 1e3, physicsClientId=self._client)
        return min((point[8] for point in found), default=np.nan)

    def close(self) -> None:
        """Ends the physics client."""
        self.bullet.disconnect(self._client)


class BulletConcave(BulletHull):
    """PyBullet with `GEOM_FORCE_CONCAVE_TRIMESH` on what stands; on both bodies it answers nothing."""

    name = "PyBullet hull against concave"
    concave_obstacles = True


PEERS: dict[str, tuple[type, str]] = {
    "fcl": (Fcl, "fcl"),
    "coal": (Coal, "coal"),
    "klampt": (Klampt, "klampt"),
    "bullet_hull": (BulletHull, "pybullet"),
    "bullet_concave": (BulletConcave, "pybullet"),
}


def about(pose: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """(4, 4) the pose of a frame at `centre` of the body."""
    moved = pose.copy()
    moved[:3, 3] += pose[:3, :3] @ centre
    return moved


def quaternion(pose: np.ndarray) -> list[float]:
    """x, y, z, w of a (4, 4) pose."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()


def available(module: str) -> bool:
    """True if the library is installed."""
    return importlib.util.find_spec(module) is not None


@contextmanager
def silenced() -> Iterator[None]:
    """Keeps what compiled libraries print while they load or build off the terminal."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(nowhere)
        os.close(kept)


def peer(key: str) -> PairPeer | None:
    """A new peer, or None if its library is absent."""
    kind, module = PEERS[key]
    if not available(module):
        return None
    with silenced():
        return kind()


def absent_peers(modules: Iterable[str] = PAIR_LIBRARIES) -> list[str]:
    """One line for each of the libraries that is not installed."""
    return [
        f"absent: {DISTRIBUTIONS[module]} (pip install .[bench])"
        for module in modules
        if not available(module)
    ]


def versions(modules: Iterable[str] = PAIR_LIBRARIES) -> str:
    """Names and versions of the libraries that are there."""
    found = [DISTRIBUTIONS[module] for module in modules if available(module)]
    return ", ".join(f"{name} {importlib.metadata.version(name)}" for name in found)
