"""The adapter of python-fcl: bodies as bounding-volume trees in millimetres, distance and contact.

Millimetres, because FCL's triangle kernel skips its vertex-face test where |normal|^2 <= 1e-15 and
then answers 0: in metres that is every triangle with edges of 0.1 mm, a false contact. Triangles
that fall under that threshold even in millimetres (area zero, for all that FCL can see) are left
out.
"""

from __future__ import annotations

from types import ModuleType

import numpy as np

from clearance.crosscheck.triangles import TriangleSoup
from clearance.extras import importing

_MM_PER_M = 1000.0
_LEAST_NORMAL_SQ = 1e-15  # [mm^4] the threshold in FCL's TriangleDistance::triDistance


class PeerBody:
    """One body as FCL holds it.

    Attributes:
        n_left_out: triangles without area.
        greatest_left_out: [m] greatest height of those triangles: how far the surface can have
        moved.
    """

    def __init__(self, soup: TriangleSoup) -> None:
        self._fcl = _fcl()
        corners = soup.corners * _MM_PER_M
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        kept = (normals * normals).sum(axis=1) > _LEAST_NORMAL_SQ
        self._kept = np.flatnonzero(kept)
        self.n_left_out = int((~kept).sum())
        self.greatest_left_out = _greatest_height(corners[~kept], normals[~kept]) / _MM_PER_M
        model = self._fcl.BVHModel()
        model.beginModel(len(soup.vertices), int(kept.sum()))
        model.addSubModel(soup.vertices * _MM_PER_M, soup.triangles[kept])
        model.endModel()
        self._object = self._fcl.CollisionObject(model)

    def place(self, world_from_body: np.ndarray) -> None:
        """Moves the body to a (4, 4) pose [m]."""
        self._object.setTransform(
            self._fcl.Transform(world_from_body[:3, :3], world_from_body[:3, 3] * _MM_PER_M)
        )

    def distance(self, other: PeerBody) -> float:
        """The distance [m] of the two surfaces as FCL sees it; 0 where they meet (FCL says -1 or
        0).
        """
        answer = self._fcl.distance(self._object, other._object, self._fcl.DistanceRequest())
        return max(0.0, answer) / _MM_PER_M

    def nearest_triangles(self, other: PeerBody) -> tuple[int, int] | None:
        """The triangles of both bodies that FCL takes for the nearest; None if it names none."""
        result = self._fcl.DistanceResult()
        request = self._fcl.DistanceRequest(enable_nearest_points=True)
        self._fcl.distance(self._object, other._object, request, result)
        i, j = result.b1, result.b2
        if not (0 <= i < len(self._kept) and 0 <= j < len(other._kept)):
            return None
        return int(self._kept[i]), int(other._kept[j])

    def collides(self, other: PeerBody) -> bool:
        """True if FCL's collision test, which shares no code with its distance, finds a contact."""
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
