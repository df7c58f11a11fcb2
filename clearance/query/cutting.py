"""One polytope cut by others: the working state of `kernels.polytope.cut`.

Coordinates are taken about a common inner point before anything is computed, so that thin regions have
their digits. Not for: deciding whether there is a region (`common_point`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope.clip import cut_by_bodies, rooms_about
from clearance.kernels.polytope.cut import (
    BROKEN,
    CUT,
    FIRST_BODY,
    FREE,
    FULL,
    N_FREE,
    N_ROWS,
    VISITED,
    begin,
    cut_by_planes,
)
from clearance.kernels.polytope.faces import face_rings, trivalent_moments

ON_PLANE = 8 * 2.0**-53
"""[-] How far from a plane counts as on it, relative to the greatest coordinate about the inner point."""

ACROSS_ALL = np.array([0.53, 0.61, 0.59]) / np.linalg.norm([0.53, 0.61, 0.59])
"""[-] Normal of the plane that parts two halves: no face or edge of bodies as people place them lies in it."""

ROWS_A_VERTEX = 4
"""Rows at first for each vertex of the body that is cut; doubled when they are full."""


SPARSE = 0.5
"""[-] Part of the rows that may be free before those in use are moved together."""


class BrokenRim(Exception):
    """The rim of a cut was not one ring: rounding has broken the surface; another method is needed."""


@dataclass(frozen=True)
class CuttingTask:
    """Bodies about a common origin: the first plane number of each, and what counts as on a plane [m]."""

    bodies: list[Polytope]
    origin: np.ndarray
    bases: np.ndarray
    tolerance: float

    @classmethod
    def about(cls, bodies: list[Polytope], origin: np.ndarray) -> CuttingTask:
        """The task; the smallest body bounds all coordinates that remain."""
        bases = np.concatenate([[0], np.cumsum([body.n_faces for body in bodies])])
        least = min(bodies, key=lambda body: body.size)
        reach = float(np.abs(least.box - origin).max())
        return cls(bodies, origin, bases, ON_PLANE * reach)

    @cached_property
    def order(self) -> list[int]:
        """The smallest body, then the others by the distance [m] of the nearest face from the origin."""
        bodies = self.bodies
        first = min(range(len(bodies)), key=lambda k: (bodies[k].volume, k))
        rest = [k for k in range(len(bodies)) if k != first]
        rooms = np.zeros(len(bodies))
        if rest[1:]:
            rooms_about(self.rows, self.origin, rooms)
        return [first, *sorted(rest, key=lambda k: (rooms[k], bodies[k].volume, k))]

    @cached_property
    def rows(self) -> np.ndarray:
        """(m, 5) where the bodies' arrays are and the first plane of each, as `kernels.polytope.bodies` says."""
        bases = self.bases.tolist()
        return np.array([(*body.packed_at, bases[i]) for i, body in enumerate(self.bodies)])

    @property
    def seam(self) -> int:
        """The number of the plane that parts two halves, after all faces."""
        return int(self.bases[-1])


class Cutting:
    """A trivalent polytope that is being cut."""

    def __init__(self, task: CuttingTask, i_first: int) -> None:
        body = task.bodies[i_first]
        form = body.trivalent
        n = len(form.corner)
        self.task = task
        self._reserve(ROWS_A_VERTEX * n)
        begin(self.spots, self.mesh, task.rows, i_first, form.corner, form.mesh, task.origin)
        self.state = np.array([0, 0, n, i_first], dtype=np.int64)
        self.table = np.zeros((task.seam + 1, 3), dtype=np.int32)

    def _reserve(self, n_rows: int) -> None:
        """Working space for so many rows, in one block.

        The allocator caches freed memory only up to twice its largest block: in four blocks it gave the memory
        back each time, and the 210 page faults of the next call took 0.5 ms.
        """
        self.block = block = np.empty(12 * n_rows)
        self.spots = block[: 4 * n_rows].reshape(-1, 4)
        self.mesh = block[4 * n_rows : 8 * n_rows].view(np.int32).reshape(-1, 8)
        self.work = block[8 * n_rows : 10 * n_rows].view(np.int32).reshape(4, -1)
        self.rim = block[10 * n_rows :].view(np.int32).reshape(-1, 4)

    def _grown(self) -> None:
        spots, mesh, work, used = self.spots, self.mesh, self.work, self.state[N_ROWS]
        self._reserve(2 * len(spots))
        self.spots[:used], self.mesh[:used] = spots[:used], mesh[:used]
        self.mesh[:used, VISITED] = 0  # a call that came to no end may have put vertices off
        self.work[FREE, : self.state[N_FREE]] = work[FREE, : self.state[N_FREE]]

    def halve(self, side: float) -> None:
        """Keeps the half on one side of a plane through the origin; `side` is 1 or -1.

        Raises:
            Broken: see there.
        """
        plane = np.append(side * ACROSS_ALL, 0.0)[None, :]
        if cut_by_planes(self.block, self.state, self.table, plane, self.task.seam, 0.0) != CUT:
            raise BrokenRim

    def by(self, *i_bodies: int) -> bool:
        """Cuts by bodies in turn, in one call of a kernel; False if nothing remains.

        Raises:
            Broken: see there.
        """
        task, turns = self.task, np.array(i_bodies, dtype=np.int64)
        while True:
            status, n_done = cut_by_bodies(
                self.block, self.state, self.table, task.rows, task.origin, turns, task.tolerance, SPARSE
            )  # fmt: skip
            if status != FULL:
                break
            turns = turns[n_done:]
            self._grown()
        if status == BROKEN:
            raise BrokenRim
        return status == CUT

    def places(self) -> np.ndarray:
        """(n, 3) [m] its vertices about the origin."""
        used = self.state[N_ROWS]
        return self.spots[:used, :3][self.mesh[:used, 0] >= 0]

    def rings(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(plane of each face, face starts, corners as rows of `places`)."""
        return face_rings(self.mesh, self.state[N_ROWS])

    def moments(self) -> np.ndarray:
        """(5,) volume [m^3], volume times centroid [m^4], greatest coordinate [m], about the origin."""
        task, areas = self.task, self.task.bodies[self.state[FIRST_BODY]].face_areas
        return np.array(
            trivalent_moments(self.block, self.state, self.table, task.rows, areas, task.origin)
        )


def by_edges(block: np.ndarray, state: np.ndarray, table: np.ndarray) -> np.ndarray:
    """As `Cutting.moments`, for a polytope that was made of no body."""
    no_body, none = np.zeros((state[FIRST_BODY] + 1, 5), dtype=np.int64), np.empty((0, 4))
    return np.array(trivalent_moments(block, state, table, no_body, none, none.ravel()))


def cut_down(task: CuttingTask, side: float = 0.0) -> Cutting | None:
    """The common region of all bodies, or its half on one `side` (1 or -1); None if rounding leaves nothing.

    The smallest body is cut by the others, those first whose surface comes nearest to the common point: what
    they leave is small soon.

    Raises:
        Broken: see there.
    """
    members = task.order
    cutting = Cutting(task, members[0])
    if side:
        cutting.halve(side)
    return cutting if cutting.by(*members[1:]) else None


def cut_whole(task: CuttingTask) -> Cutting:
    """The common region of all bodies, from its known halves.

    Raises:
        Broken: see there; also where rounding leaves nothing of the whole.
    """
    cutting = cut_down(task)
    if cutting is None:
        raise BrokenRim
    return cutting
