"""What there is to see at the worst moment of a replay: bodies where they are, the line, and what may hide it.

Colours and the room that the camera frames are those of the page (`page.css`, `replay.js`). Not for: drawing it
(`picture`, `glb`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.pose import pose_from_quaternion
from clearance.record.replay import LINK, MOVING, PART, STANDING, DrawnBody, Replay
from clearance.record.status import STATUSES
from clearance.report.still.points import as_solids

ROBOTS = (0x5C7390, 0x7D6796, 0x4B7F78, 0x94705C)
"""Of the robots in turn."""

LINK_IDLE = 0xA9B4C0
"""Of links that are not measured."""

KINDS = {PART: 0xB3892F, MOVING: 0x9C9480, STANDING: 0xB9B4A8}
"""Of what is no link."""

OPACITIES = {LINK: 1.0, PART: 1.0, MOVING: 0.72, STANDING: 0.5}
"""By kind."""

COLOURS = {"clear": 0x2B7A4B, "near": 0xB06C00, "violated": 0xC0281C, "contact": 0x8A0F45}
"""Of the line, by status."""

HELD, NEAREST = 0.6, 0.55
"""How much of its carrier's colour a part takes on, and the nearest two bodies of that of the status."""

N_ROOM = 60
"""Frames that the room of all that moves is taken from."""


@dataclass(frozen=True, eq=False)
class StillBody:
    """A body at the moment.

    Attributes:
        i_shape: its place in the shapes. pose: (4, 4) [m] in the world frame.
        colour: (3,) sRGB, 0 to 1. opacity: 0 to 1.
    """

    name: str
    kind: str
    i_shape: int
    pose: np.ndarray
    colour: np.ndarray
    opacity: float


@dataclass(frozen=True, eq=False)
class Still:
    """One moment, to be drawn.

    Attributes:
        bodies: that are in the cell then. shapes: vertices (n, 3) [m] and triangles (m, 3) of each.
        nearest: the places in `bodies` of the two that are nearest.
        line: (2, 3) [m] the witness points. colour: (3,) sRGB of line and dots.
        room: (2, 3) [m] lower and upper corner of the box that the camera frames.
        region: vertices (n, 3) [m] and triangles (m, 3) of what two bodies share, or None. way_out: its foot (3,)
            [m] and direction (3,), or None.
    """

    bodies: tuple[StillBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    nearest: tuple[int, ...]
    line: np.ndarray
    colour: np.ndarray
    room: np.ndarray
    region: tuple[np.ndarray, np.ndarray] | None = None
    way_out: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def size(self) -> float:
        """[m] the room's diagonal."""
        return float(np.linalg.norm(self.room[1] - self.room[0]))


def still_of(replay: Replay) -> Still:
    """The moment of a replay that stands worst against its rule."""
    frame = replay.i_worst
    seen = [i for i in range(len(replay.bodies)) if _at(replay.shown[i], frame)]
    colour = rgb(COLOURS[str(STATUSES[int(replay.status[frame])])])
    nearest = [seen.index(i) for i in replay.nearest[frame].tolist() if i in seen]
    bodies = tuple(
        StillBody(
            replay.bodies[i].name,
            replay.bodies[i].kind,
            replay.bodies[i].i_shape,
            _pose(_at(replay.poses[i], frame)),
            _mixed(_colour(replay, i), colour, NEAREST * (k in nearest)),
            OPACITIES[replay.bodies[i].kind],
        )
        for k, i in enumerate(seen)
    )
    overlap = next((i for i, one in enumerate(replay.contacts) if one.frame == frame), None)
    return Still(
        bodies,
        tuple(as_solids(*shape) for shape in replay.shapes),
        tuple(nearest),
        replay.lines[frame].reshape(2, 3),
        colour,
        _room(replay),
        None if overlap is None else replay.regions[overlap],
        None if overlap is None else _way_out(replay, overlap),
    )


def rgb(code: int) -> np.ndarray:
    """(3,) sRGB, 0 to 1, of a colour written as 0xRRGGBB."""
    return np.array([code >> 16, code >> 8 & 255, code & 255]) / 255.0


def box_of(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """(2, 3) [m] the box in the world of the corners of a body's own box, as the page takes it."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    placed = corners @ pose[:3, :3].T + pose[:3, 3]
    return np.array([placed.min(axis=0), placed.max(axis=0)])


def _at(values: np.ndarray, frame: int) -> np.ndarray:
    """The value of a frame; that of all frames where there is one."""
    return values[frame if len(values) > 1 else 0]


def _pose(packed: np.ndarray) -> np.ndarray:
    """(4, 4) from xyz and quat_xyzw."""
    place, turn = packed[:3].astype(np.float64), packed[3:].astype(np.float64)
    return pose_from_quaternion(place.tolist(), (turn / np.linalg.norm(turn)).tolist())


def _colour(replay: Replay, i: int) -> np.ndarray:
    """A body's own colour; of a part in a hand, with some of the hand's."""
    own = _plain_colour(replay.bodies[i])
    time = replay.times[replay.i_worst]
    if replay.bodies[i].kind == PART:
        for held in replay.carries:
            if held.i_part == i and held.i_by >= 0 and held.start <= time < held.end:
                return _mixed(own, _plain_colour(replay.bodies[held.i_by]), HELD)
    return own


def _plain_colour(body: DrawnBody) -> np.ndarray:
    if body.kind != LINK:
        return rgb(KINDS[body.kind])
    return rgb(ROBOTS[body.i_robot % len(ROBOTS)] if body.measured else LINK_IDLE)


def _mixed(one: np.ndarray, other: np.ndarray, share: float) -> np.ndarray:
    return one + share * (other - one)


def _way_out(replay: Replay, i: int) -> tuple[np.ndarray, np.ndarray]:
    return np.array(replay.contacts[i].start), np.array(replay.contacts[i].direction)


def _room(replay: Replay) -> np.ndarray:
    """The box of all that moves, a quarter larger, as far as obstacles stand in it."""
    n = len(replay.steps)
    frames = [i * (n - 1) // max(1, min(n, N_ROOM) - 1) for i in range(min(n, N_ROOM))]
    moving = [i for i, body in enumerate(replay.bodies) if body.kind != STANDING]
    standing = [i for i, body in enumerate(replay.bodies) if body.kind == STANDING]
    room = _joined(_boxes(replay, moving, frames) or _boxes(replay, standing, [0]))
    around = _joined([room, *_boxes(replay, standing, [0])])
    grown = 0.25 * np.linalg.norm(room[1] - room[0])
    return np.array(
        [np.maximum(room[0] - grown, around[0]), np.minimum(room[1] + grown, around[1])]
    )


def _boxes(replay: Replay, bodies: Sequence[int], frames: Sequence[int]) -> list[np.ndarray]:
    found = []
    for i in bodies:
        points = replay.shapes[replay.bodies[i].i_shape][0].astype(np.float64)
        own = frames if len(replay.poses[i]) > 1 else frames[:1]
        found += [box_of(points, _pose(_at(replay.poses[i], frame))) for frame in own]
    return found


def _joined(boxes: Sequence[np.ndarray]) -> np.ndarray:
    every = np.array(boxes)
    return np.array([every[:, 0].min(axis=0), every[:, 1].max(axis=0)])
