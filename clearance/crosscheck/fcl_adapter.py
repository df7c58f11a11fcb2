"""The adapter of python-fcl: bodies as bounding-volume trees in micrometres, distance and contact.

FCL's triangle kernel skips its vertex-face test where |normal|^2 <= 1e-15 and then answers 0: in
metres that is every triangle with edges of 0.1 mm, a false contact. Triangles that fall under that
threshold in millimetres (area zero, for all that FCL can see) are dropped. In micrometres a
triangle of 0.25 nm stands above it, which is what a point of a cloud is here: FCL has balls, but
measures them by an iteration with errors of 2 micrometres.
"""

from __future__ import annotations

from types import ModuleType

import numpy as np

from clearance.crosscheck.triangles import TriangleSoup
from clearance.extras import importing

_MM_PER_M = 1e3
_UM_PER_M = 1e6
_LEAST_NORMAL_SQ = 1e-15  # [mm^4] the threshold in FCL's TriangleDistance::triDistance

_POINT = 1.5e-10  # [m] from a point to the corners of the triangle that stands for it
_POINT_SHARE = 1e-12  # [-] of the greatest coordinate, where that is more: rounding must not see it
_CORNERS = np.array([[1.0, 0.0, 0.0], [-0.5, 0.75**0.5, 0.0], [-0.5, -(0.75**0.5), 0.0]])


class PeerBody:
    """One body in FCL.

    Attributes:
        n_dropped: triangles without area.
        greatest_dropped: [m] greatest height of those triangles: how far the surface can have
        moved.
        radius: [m] of the balls of a cloud, which distances are less by; else 0.
        point_size: [m] by how much a point of a cloud can seem nearer than it is; else 0.
    """

    def __init__(self, soup: TriangleSoup) -> None:
        self._fcl = _fcl()
        self.radius, self.point_size = soup.radius, 0.0
        vertices, triangles = self._points(soup) if soup.radius > 0.0 else self._surface(soup)
        model = self._fcl.BVHModel()
        model.beginModel(len(vertices), len(triangles))
        model.addSubModel(vertices * _UM_PER_M, triangles)
        model.endModel()
        self._object = self._fcl.CollisionObject(model)

    def _points(self, soup: TriangleSoup) -> tuple[np.ndarray, np.ndarray]:
        """A triangle about each point, all that FCL sees of it."""
        n = len(soup.vertices)
        self._with_area, self.n_dropped, self.greatest_dropped = np.arange(n), 0, 0.0
        self.point_size = max(_POINT, _POINT_SHARE * float(np.abs(soup.vertices).max()))
        corners = soup.vertices[:, None] + self.point_size * _CORNERS
        return corners.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3)

    def _surface(self, soup: TriangleSoup) -> tuple[np.ndarray, np.ndarray]:
        """The triangles that FCL can see."""
        corners = soup.corners * _MM_PER_M
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        has_area = (normals * normals).sum(axis=1) > _LEAST_NORMAL_SQ
        self._with_area = np.flatnonzero(has_area)
        self.n_dropped = int((~has_area).sum())
        self.greatest_dropped = _greatest_height(corners[~has_area], normals[~has_area]) / _MM_PER_M
        return soup.vertices, soup.triangles[has_area]

    def place(self, world_from_body: np.ndarray) -> None:
        """Moves the body to a (4, 4) pose [m]."""
        self._object.setTransform(
            self._fcl.Transform(world_from_body[:3, :3], world_from_body[:3, 3] * _UM_PER_M)
        )

    def distance(self, other: PeerBody) -> float:
        """The distance [m] of the two surfaces as FCL sees it, of clouds that of their balls; 0 where
        they meet.
        """
        return max(0.0, self.distance_of_centres(other) - self.radius - other.radius)

    def distance_of_centres(self, other: PeerBody) -> float:
        """The same, of a cloud that of its points (FCL says -1 or 0 where surfaces meet)."""
        answer = self._fcl.distance(self._object, other._object, self._fcl.DistanceRequest())
        return max(0.0, answer) / _UM_PER_M

    def nearest_triangles(self, other: PeerBody) -> tuple[int, int] | None:
        """The triangles of both bodies that are the nearest for FCL; None if it names none."""
        result = self._fcl.DistanceResult()
        request = self._fcl.DistanceRequest(enable_nearest_points=True)
        self._fcl.distance(self._object, other._object, request, result)
        i, j = result.b1, result.b2
        if not (0 <= i < len(self._with_area) and 0 <= j < len(other._with_area)):
            return None
        return int(self._with_area[i]), int(other._with_area[j])

    def collides(self, other: PeerBody) -> bool:
        """True if FCL's collision test, which shares no code with its distance, finds a contact; of
        clouds, which it cannot see, by their distance.
        """
        if self.radius > 0.0 or other.radius > 0.0:
            return self.distance(other) <= 0.0
        return self._fcl.collide(self._object, other._object, self._fcl.CollisionRequest()) > 0


def _greatest_height(corners: np.ndarray, normals: np.ndarray) -> float:
    """The greatest height of triangles (n, 3, 3) over their longest sides, in their unit."""
    if not len(corners):
        return 0.0
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    doubled = np.linalg.norm(normals, axis=1)
    return float(np.max(np.divide(doubled, longest, out=np.zeros_like(longest), where=longest > 0)))


def peer_name() -> str:
    """Name and version of the peer."""
    return f"python-fcl {_fcl().__version__}"


def _fcl() -> ModuleType:
    with importing("crosscheck", "the cross-check"):
        import fcl
    return fcl
