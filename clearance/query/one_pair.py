"""Arrays for questions about one pair of solids, which need longer to make than many an answer."""

from __future__ import annotations

import threading
import weakref

import numpy as np

from clearance.geometry.polyhedron import Polyhedron, require_polyhedron
from clearance.geometry.pose import validated_pose
from clearance.geometry.tree import surface_of
from clearance.kernels.search.body_pair import NO_FACE
from clearance.kernels.search.pair_query import (
    AFRESH,
    FRONT_CAPACITY,
    POSES_ARE_RIGID,
    nearest_at_poses,
    track_pair,
)
from clearance.kernels.search.scratch import Scratch, new_scratch
from clearance.query.inside import doubt_of
from clearance.query.result import Nearest

_AT_REST = np.eye(4)

MOST_PAIRS = 256
"""Pairs that are cached for each thread, a kilobyte each."""


class OnePair:
    """A pair of solids as the search has it, and what it has found; for one thread at a time.

    Args:
        scratch: of `new_scratch`; pairs that are measured in turn may share it.
        goes_on: False if every search begins anew.

    Attributes:
        arrays: of `track_pair`. It refers to none of the polyhedra, so that it does not keep them alive.
        doubt: what of one may be inside the other, if anything.
    """

    def __init__(self, a: Polyhedron, b: Polyhedron, scratch: Scratch, *, goes_on: bool) -> None:
        require_polyhedron(a, "a"), require_polyhedron(b, "b")
        self.arrays = track_pair(
            surface_of(a), surface_of(b), FRONT_CAPACITY if goes_on else 0, scratch
        )
        self.doubt = doubt_of(a, b)
        self._how = 0 if goes_on else AFRESH
        self._poses, self._rows = (np.empty((1, 4, 4)), np.empty((1, 4, 4))), answer_rows(1)
        self._ask = nearest_at_poses.prepared(self.arrays, *self._poses, self._how, *self._rows)

    def nearest(self, given_a: np.ndarray | None, given_b: np.ndarray | None) -> Nearest:
        """The answer at one pose of each, (4, 4) or None for the identity."""
        pose_a, pose_b = _pose(given_a), _pose(given_b)
        self._poses[0][0], self._poses[1][0] = pose_a, pose_b
        how = self._how
        if self._ask() != -1:
            validated_pose(pose_a), validated_pose(pose_b)
            how |= POSES_ARE_RIGID
            nearest_at_poses(self.arrays, *self._poses, how, *self._rows)
        numbers, points, counts = self._rows
        ((distance, error),), (point_a, point_b) = numbers.tolist(), points[0].copy()
        ((face_a, face_b, n_nodes, n_faces, n_exact),) = counts.tolist()
        return Nearest(
            distance, point_a, point_b, face_a, face_b, distance == 0.0, error,
            {"nodes": n_nodes, "polygons": n_faces, "exact_decisions": n_exact},
            self._inside(distance, face_a),
        )  # fmt: skip

    def _inside(self, distance: float, face_a: int) -> str:
        """`Nearest.inside` at the poses of the last question."""
        if distance == 0.0:
            return "yes" if face_a == NO_FACE else "no"
        return "undecided" if self.doubt is not None and self.doubt.at(*self._poses)[0] else "no"


def answer_rows(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Arrays for n answers, as `nearest_at_poses` fills it."""
    return np.empty((n, 2)), np.empty((n, 2, 3)), np.empty((n, 5), dtype=np.int64)


class _CachedPair:
    """A cached pair; its arrays go when one of the solids does."""

    def __init__(self, a: Polyhedron, b: Polyhedron, pair: OnePair) -> None:
        self.pair: OnePair | None = pair
        self._a, self._b = weakref.ref(a, self._let_go), weakref.ref(b, self._let_go)

    def is_of(self, a: Polyhedron, b: Polyhedron) -> bool:
        return self._a() is a and self._b() is b

    def _let_go(self, _: weakref.ref) -> None:
        self.pair = None


class _Thread(threading.local):
    """The pairs of a thread."""

    def __init__(self) -> None:
        self.pairs: dict[tuple[int, int], _CachedPair] = {}
        self.scratch = new_scratch()


_thread = _Thread()


def cached_pair(a: Polyhedron, b: Polyhedron) -> OnePair:
    """Arrays for a pair: those of an earlier question of this thread, if there is one."""
    found = _thread.pairs.get((id(a), id(b)))
    # a solid that is gone may have had the same address
    if found is not None and found.pair is not None and found.is_of(a, b):
        return found.pair
    if len(_thread.pairs) == MOST_PAIRS:
        _thread.pairs.clear()
    pair = OnePair(a, b, _thread.scratch, goes_on=False)
    _thread.pairs[id(a), id(b)] = _CachedPair(a, b, pair)
    return pair


def _pose(given: np.ndarray | None) -> np.ndarray:
    """A (4, 4) array that is not yet known to be a pose."""
    if given is None:
        return _AT_REST
    try:
        pose = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        return validated_pose(given)
    return pose if pose.shape == (4, 4) else validated_pose(pose)
