"""The drawing data of a record: shapes, poses frame by frame, and the line between the witness points.

The page, its picture and its GLB draw from this, so they show the same frames. Geometry
and poses are float32, which is for the eye only; times, clearances and witness points stay float64.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.world.pairs import OBSTACLE

LINK, STANDING, MOVING, PART = "link", "obstacle", "moving", "part"
"""Kinds of bodies as they are drawn: links, obstacles that stand (a robot's own floor too), that move, and parts
that are carried at some time."""


@dataclass(frozen=True)
class DrawnBody:
    """A body as it is drawn: `kind` is one of those above, `i_shape` its place in the shapes, `i_robot` its
    robot's or -1."""

    name: str
    kind: str
    measured: bool
    i_shape: int
    i_robot: int = OBSTACLE


@dataclass(frozen=True)
class DrawnCarry:
    """A part in the hands of a body from a time to another [s]; `i_part`, `i_by` are their places in the bodies,
    `i_by` -1 where what carries it is not drawn."""

    part: str
    by: str
    i_part: int
    i_by: int
    start: float
    end: float


@dataclass(frozen=True)
class DrawnContact:
    """One overlap: in which frame, between whom, where its arrow starts and points (world frame, [m]).

    `exact` and `volume_exact` are False where `penetration` [m] and `volume` [m^3] are upper bounds; lower ones
    stand beside them.
    """

    frame: int
    link: str
    obstacle: str
    penetration: float
    penetration_at_least: float
    volume: float
    volume_at_least: float
    exact: bool
    volume_exact: bool
    start: tuple[float, float, float]
    direction: tuple[float, float, float]


class EarlierBody(NamedTuple):
    """Where a body of a replay was before.

    Attributes:
        i_body: its place in the replay's bodies. poses: as those of `Replay`. shown: (frames,) uint8.
    """

    i_body: int
    poses: np.ndarray
    shown: np.ndarray


class DrawnMoment(NamedTuple):
    """A moment of one pair: its frame, clearance [m], index into `STATUSES`, witness points (6,) [m] in the world
    frame, and the places of its two bodies, -1 where one is not drawn."""

    frame: int
    clearance: float
    status: int
    line: tuple[float, ...]
    bodies: tuple[int, int]


@dataclass(frozen=True)
class DrawnRule:
    """A rule that frames are held against: its name and its limits [m]."""

    name: str
    fail: float
    warn: float


@dataclass(frozen=True, eq=False)
class Replay:
    """The frames of one record.

    Attributes:
        rules: what frames are held against.
        worst: the most critical moment of what decides the verdict.
        n_steps: number of steps of the record; those of `steps` that are not `between` are frames.
        shapes: vertices (n, 3) float32 [m] and triangles (m, 3) int32 of each different shape.
        poses: for each body (frames, 7) or, where it stands still, (1, 7) float32: xyz [m] and
            quat_xyzw, in the world frame.
        shown: for each body (frames,) or (1,) uint8, 0 while it is not in the cell.
        carries: who carries what from when until when.
        steps, times, clearances: (frames,) step index, [s], [m].
        times_b: (frames,) [s] when the second body of the line is there, if its clock is another; else NaN.
        rule: (frames,) int32 into `rules`, of what judges it.
        between: (frames,) uint8, 1 for a moment between that step and the next, where the motion is worse than at
            both.
        known: (frames,) uint8, 0 where the clearance is only a proven lower bound; then the line has no
            length and nothing is nearest.
        status: (frames,) uint8 indices into `STATUSES`.
        lines: (frames, 6) [m] witness points on the two bodies in the world frame.
        nearest: (frames, 2) int32 indices into `bodies` of the two; -1: there is none.
        move: (frames,) int32 indices into `moves`, the names of a program's moves; -1: none is made.
        unmeasured: start and end [s] of the stretches between steps in which no pair is measured.
        contacts: the overlaps that are drawn, frames first.
        regions: of each contact the common region's vertices (n, 3) float32 [m] in the world frame and
            triangles (m, 3) int32.
    """

    name: str
    rules: tuple[DrawnRule, ...]
    n_steps: int
    bodies: tuple[DrawnBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    poses: tuple[np.ndarray, ...]
    shown: tuple[np.ndarray, ...]
    carries: tuple[DrawnCarry, ...]
    worst: DrawnMoment
    steps: np.ndarray
    times: np.ndarray
    times_b: np.ndarray
    clearances: np.ndarray
    between: np.ndarray
    known: np.ndarray
    status: np.ndarray
    rule: np.ndarray
    lines: np.ndarray
    nearest: np.ndarray
    move: np.ndarray
    moves: tuple[str, ...] = ()
    unmeasured: tuple[tuple[float, float], ...] = ()
    contacts: tuple[DrawnContact, ...] = ()
    regions: tuple[tuple[np.ndarray, np.ndarray], ...] = ()

    @property
    def i_worst(self) -> int:
        """The frame of the most critical moment."""
        return self.worst.frame
