"""Who is right where the peer's clearance of a step is not ours, as far as exact arithmetic can say.

A clearance is refuted by two faces that are nearer, and by the faces it names where those are farther. Not for:
bodies inside others, which no two faces decide.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from clearance.crosscheck.exact import placed, point_sq, triangles_sq
from clearance.crosscheck.pairs import PeerPair, PeerSide

MOST_TRIANGLES = 4
"""Triangles of each body nearest to our witness point that are tested: a point on an edge is on two."""


def peer_is_wrong(
    ours: float,
    points: np.ndarray,
    our_pair: PeerPair,
    peers: float,
    peer_pair: PeerPair,
    poses: np.ndarray,
    tolerance: float,
) -> bool:
    """True if exact arithmetic refutes the peer's clearance and bears out ours; False if it does not say.

    Ours is borne out where the faces under our witness points are as near as we say, within the tolerance. If the
    peer says more, that refutes it. If it says less, the faces that it names must be farther than it says.

    Args:
        ours, peers: [m]. points: (2, 3) [m] our witness points, on the link and on the obstacle.
        poses: (movers, 4, 4) [m] of the links. tolerance: [m].
    """
    if not _attained(ours, points, our_pair, poses, tolerance):
        return False
    if peers > ours:
        return True
    faces, least = _named_by_the_peer(peer_pair, poses), peers + peer_pair.radii + tolerance
    return faces is not None and _exceeds(_distance_sq(peer_pair, poses, faces), least)


def off_body(point: np.ndarray, side: PeerSide, pose: np.ndarray) -> float:
    """[m] how far a point (3,) is from a body at a pose (4, 4), its triangles measured exactly.

    In float64 heights over needles are off by their length's rounding over their sine.
    """
    triangles = side.locator.near(pose[:3, :3].T @ (point - pose[:3, 3]))
    (x,) = placed(point[None], np.eye(4))
    found = float(point_sq(x, [placed(triangle, pose) for triangle in triangles])) ** 0.5
    return abs(found - side.soup.radius)


def _attained(
    ours: float, points: np.ndarray, pair: PeerPair, poses: np.ndarray, tolerance: float
) -> bool:
    """True if two faces under our points are as near as we say."""
    sides = _placed_sides(pair, poses)
    near = [
        _nearest_triangles(side, pose, x) for (side, pose), x in zip(sides, points, strict=True)
    ]
    least = min(_distance_sq(pair, poses, (i, j)) for i in near[0] for j in near[1])
    reached = ours + pair.radii
    return not _exceeds(least, reached + tolerance) and (
        ours <= tolerance or _exceeds(least, reached - tolerance)
    )


def _exceeds(distance_sq: Fraction, length: float) -> bool:
    """True if a distance, given as its exact square, is more than a length [m]."""
    return length < 0.0 or distance_sq > Fraction(length) ** 2


def _distance_sq(pair: PeerPair, poses: np.ndarray, faces: tuple[int, int]) -> Fraction:
    (link, link_pose), (obstacle, pose) = _placed_sides(pair, poses)
    return triangles_sq(
        placed(link.soup.corners[faces[0]], link_pose),
        placed(obstacle.soup.corners[faces[1]], pose),
    )


def _placed_sides(pair: PeerPair, poses: np.ndarray) -> tuple[tuple[PeerSide, np.ndarray], ...]:
    return (pair.link, poses[pair.i_mover]), (pair.other, poses[pair.i_other])


def _nearest_triangles(side: PeerSide, pose: np.ndarray, point: np.ndarray) -> list[int]:
    distances = side.locator.distances(pose[:3, :3].T @ (point - pose[:3, 3]))
    return np.argsort(distances, kind="stable")[:MOST_TRIANGLES].tolist()


def _named_by_the_peer(pair: PeerPair, poses: np.ndarray) -> tuple[int, int] | None:
    """The triangles of the link and the obstacle that are the nearest for the peer."""
    pair.link.peer.place(poses[pair.i_mover])
    pair.other.peer.place(poses[pair.i_other])
    return pair.link.peer.nearest_triangles(pair.other.peer)
