"""One polytope cut by the faces of others: the working state of `kernels.polytope_clip` and its rounds.

Coordinates are taken about a common inner point before anything is computed, so that thin regions keep
their digits. Not for: deciding whether there is a region (`common_point`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope_clip import BROKEN, CUT, cut_by_planes, face_rings

ON_PLANE = 8 * 2.0**-53
"""[-] How far from a plane counts as on it, relative to the greatest coordinate about the inner point."""


class Broken(Exception):
    """The rim of a cut was not one ring: rounding has broken the surface; another way must be taken."""


@dataclass(frozen=True)
class Task:
    """Bodies about a common origin: the first plane number of each, and what counts as on a plane [m]."""

    bodies: list[Polytope]
    origin: np.ndarray
    bases: np.ndarray
    tolerance: float

    @classmethod
    def about(cls, bodies: list[Polytope], origin: np.ndarray) -> Task:
        """The task; the smallest body bounds all coordinates that remain."""
        bases = np.concatenate([[0], np.cumsum([body.n_faces for body in bodies])])
        least = min(bodies, key=lambda body: body.size)
        reach = float(np.abs(least.vertices - origin).max())
        return cls(bodies, origin, bases, ON_PLANE * reach)


class Cutting:
    """A trivalent polytope that is being cut."""

    def __init__(self, task: Task, i_first: int, n_planes: int) -> None:
        body = task.bodies[i_first]
        form = body.trivalent
        n = len(form.corner)
        rows = n + 3 * n_planes + 8
        self.task = task
        self.places = np.empty((rows, 3))
        self.across = np.empty((rows, 3), dtype=np.int64)
        self.planes = np.empty((rows, 3), dtype=np.int64)
        self.places[:n] = (body.vertices - task.origin)[form.corner]
        self.across[:n] = form.across
        self.planes[:n] = form.planes + task.bases[i_first]
        self.state = np.array([0, 0, 0, n], dtype=np.int64)
        self.free = np.empty(rows, dtype=np.int64)
        self.stamps = np.zeros(rows, dtype=np.int64)
        self.first = np.empty(task.bases[-1], dtype=np.int64)
        self.first_stamp = np.zeros(task.bases[-1], dtype=np.int64)
        self.queue = np.empty(rows, dtype=np.int64)
        self.rim = np.empty((rows, 4), dtype=np.int64)
        self.rim_at = np.empty((rows, 3))
        self.slots = np.empty(rows, dtype=np.int64)

    def by(self, i_body: int, order: np.ndarray) -> bool:
        """Cuts by the faces `order` of one body; False if nothing is left.

        Raises:
            Broken: see there.
        """
        body, task = self.task.bodies[i_body], self.task
        status, _ = cut_by_planes(
            self.places, self.across, self.planes, self.state, self.free,
            body.normals, body.offsets_about(task.origin), order, task.bases[i_body], task.tolerance,
            self.stamps, self.first, self.first_stamp, self.queue, self.rim, self.rim_at, self.slots,
        )  # fmt: skip
        if status == BROKEN:
            raise Broken
        return status == CUT

    def rings(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(plane of each face, face starts, corners as rows of `places`)."""
        return face_rings(self.across, self.planes, self.state[0], self.state[3])


def cut_down(task: Task, members: Iterable[int]) -> Cutting | None:
    """The part shared by the `members`, or None if rounding leaves nothing.

    Raises:
        Broken: see there.
    """
    members = sorted(members, key=lambda k: (task.bodies[k].volume, k))
    n_planes = sum(task.bodies[k].n_faces for k in members[1:])
    cutting = Cutting(task, members[0], n_planes)
    for k in members[1:]:
        if not cutting.by(k, task.bodies[k].cutting_order):
            return None
    return cutting


def joined(into: Cutting, other: Cutting) -> Cutting | None:
    """`into` cut by the faces that are left of `other`, in place."""
    names = np.unique(other.rings()[0])
    owners = np.searchsorted(into.task.bases, names, side="right") - 1
    for k in np.unique(owners):
        if not into.by(k, names[owners == k] - into.task.bases[k]):
            return None
    return into
