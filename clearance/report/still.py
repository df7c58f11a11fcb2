"""The worst moment of a replay, standing still: bodies where they are, the line, and from where to look at it.

Colours, room and camera are those of the page (`page.css`, `replay.js`), so that picture and page agree. Not for:
drawing it (`picture`), writing it for other programs (`glb`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.pose import pose_from_quaternion
from clearance.record.replay import LINK, MOVING, PART, STANDING, DrawnBody, DrawnMoment, Replay
from clearance.record.status import STATUSES

ROBOTS, LINK_IDLE = (0x5C7390, 0x7D6796, 0x4B7F78, 0x94705C), 0xA9B4C0
"""Of the robots in turn, and of links that are not measured."""

KINDS = {PART: 0xB3892F, MOVING: 0x9C9480, STANDING: 0xB9B4A8}
"""Of what is no link."""

OPACITIES = {LINK: 1.0, PART: 1.0, MOVING: 0.72, STANDING: 0.5}
"""By kind."""

COLOURS = {"clear": 0x2B7A4B, "near": 0xB06C00, "violated": 0xC0281C, "contact": 0x8A0F45}
"""Of the line, by status."""

CARRIED, NEAREST = 0.6, 0.55
"""How much of its carrier's colour a part takes on, and the nearest two bodies of that of the status."""

N_VIEWED = 60
"""Frames from which the view box of all that moves is made."""

FIELD_OF_VIEW = math.radians(40.0)
"""From top to bottom."""

N_SIDES, LIFT = 16, 0.42
"""Sides that the camera tries, and how far above the target they are [rad]."""

MOST_POINTS, HALF = 20_000, 0.002
"""Points of a cloud that are shown, evenly spread, and [m] from each to the corners of its solid."""

_CORNERS = HALF * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)


@dataclass(frozen=True, eq=False)
class StillBody:
    """A body at the moment: its place in the shapes, pose (4, 4) [m], colour (3,) sRGB and opacity, 0 to 1."""

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
        view_box: (2, 3) [m] lower and upper corner of the box that the camera frames.
        region: vertices (n, 3) [m] and triangles (m, 3) of what two bodies share, or None.
        separation: foot (3,) [m] and direction (3,) of the separation vector, or None.
    """

    bodies: tuple[StillBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    nearest: tuple[int, ...]
    line: np.ndarray
    colour: np.ndarray
    view_box: np.ndarray
    region: tuple[np.ndarray, np.ndarray] | None = None
    separation: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def size(self) -> float:
        """[m] the view box's diagonal."""
        return float(np.linalg.norm(self.view_box[1] - self.view_box[0]))

    def placed(self, body: StillBody) -> np.ndarray:
        """(n, 3) [m] a body's vertices in the world."""
        return _placed(self.shapes[body.i_shape][0].astype(np.float64), body.pose)


def still_of(replay: Replay) -> Still:
    """The most critical moment of a replay."""
    worst = replay.worst
    frame = worst.frame
    seen = [i for i in range(len(replay.bodies)) if _at(replay.shown[i], frame)]
    colour = rgb(COLOURS[str(STATUSES[worst.status])])
    nearest = [seen.index(i) for i in worst.bodies if i in seen]
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
    shapes = tuple(as_solids(*shape) for shape in replay.shapes)
    line, view_box = np.reshape(worst.line, (2, 3)), _view_box(replay)
    for contact, region in zip(replay.contacts, replay.regions, strict=True):
        if (contact.frame, contact.link, contact.obstacle) == (frame, *_names(replay, worst)):
            separation = np.array(contact.start), np.array(contact.direction)
            return Still(bodies, shapes, tuple(nearest), line, colour, view_box, region, separation)
    return Still(bodies, shapes, tuple(nearest), line, colour, view_box)


def _names(replay: Replay, worst: DrawnMoment) -> list[str]:
    return [replay.bodies[i].name if i >= 0 else "" for i in worst.bodies]


def rgb(code: int) -> np.ndarray:
    """(3,) sRGB, 0 to 1, of a colour written as 0xRRGGBB."""
    return np.array([code >> 16, code >> 8 & 255, code & 255]) / 255.0


def as_solids(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a shape; those of an octahedron about each point where it has no triangles."""
    if len(triangles):
        return vertices, triangles
    points = vertices[:: -(-len(vertices) // MOST_POINTS)]
    corners = points[:, None] + _CORNERS
    faces = _FACES + len(_CORNERS) * np.arange(len(points))[:, None, None]
    return corners.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.int32)


def _at(values: np.ndarray, frame: int) -> np.ndarray:
    """The value of a frame; that of all frames where there is one."""
    return values[frame if len(values) > 1 else 0]


def _pose(packed: np.ndarray) -> np.ndarray:
    """(4, 4) from xyz and quat_xyzw."""
    place, turn = packed[:3].astype(np.float64), packed[3:].astype(np.float64)
    return pose_from_quaternion(place.tolist(), (turn / np.linalg.norm(turn)).tolist())


def _placed(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    return points @ pose[:3, :3].T + pose[:3, 3]


def _colour(replay: Replay, i: int) -> np.ndarray:
    """A body's own colour; of a part in a hand, with some of the hand's."""
    own, time = _plain_colour(replay.bodies[i]), replay.times[replay.i_worst]
    for carry in replay.carries if replay.bodies[i].kind == PART else ():
        if carry.i_part == i and carry.i_by >= 0 and carry.start <= time < carry.end:
            return _mixed(own, _plain_colour(replay.bodies[carry.i_by]), CARRIED)
    return own


def _plain_colour(body: DrawnBody) -> np.ndarray:
    if body.kind != LINK:
        return rgb(KINDS[body.kind])
    return rgb(ROBOTS[body.i_robot % len(ROBOTS)] if body.measured else LINK_IDLE)


def _mixed(one: np.ndarray, other: np.ndarray, share: float) -> np.ndarray:
    return one + share * (other - one)


def _box_of(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """(2, 3) [m] the box in the world of the corners of a body's own box, as the page takes it."""
    ends = np.array([points.min(axis=0), points.max(axis=0)])
    corners = ends[np.indices((2, 2, 2)).reshape(3, -1).T, np.arange(3)]
    placed = _placed(corners, pose)
    return np.array([placed.min(axis=0), placed.max(axis=0)])


def _view_box(replay: Replay) -> np.ndarray:
    """The box of all that moves, a quarter larger, as far as obstacles stand in it."""
    n = len(replay.steps)
    frames = [i * (n - 1) // max(1, min(n, N_VIEWED) - 1) for i in range(min(n, N_VIEWED))]
    standing = [i for i, body in enumerate(replay.bodies) if body.kind == STANDING]
    moving = [i for i in range(len(replay.bodies)) if i not in standing]
    obstacles = _boxes(replay, standing, [0])
    box = _joined(_boxes(replay, moving, frames) or obstacles)
    around = _joined([box, *obstacles])
    grown = 0.25 * np.linalg.norm(box[1] - box[0])
    return np.array([np.maximum(box[0] - grown, around[0]), np.minimum(box[1] + grown, around[1])])


def _boxes(replay: Replay, bodies: Sequence[int], frames: Sequence[int]) -> list[np.ndarray]:
    found = []
    for i in bodies:
        points = replay.shapes[replay.bodies[i].i_shape][0].astype(np.float64)
        own = frames if len(replay.poses[i]) > 1 else frames[:1]
        found += [_box_of(points, _pose(_at(replay.poses[i], frame))) for frame in own]
    return found


def _joined(boxes: Sequence[np.ndarray]) -> np.ndarray:
    every = np.array(boxes)
    return np.array([every[:, 0].min(axis=0), every[:, 1].max(axis=0)])


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera: its eye (3,) [m], its axes right, up, forward as rows (3, 3), and [m] what is too near."""

    eye: np.ndarray
    axes: np.ndarray
    near: float

    def seen_from_it(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) [m] to the right, up and ahead, of points in the world."""
        return (points - self.eye) @ self.axes.T


def overview(still: Still) -> Camera:
    """All of the room."""
    distance = 0.5 * still.size / math.sin(0.5 * FIELD_OF_VIEW) * 0.8
    return _camera_towards(still, still.view_box.mean(axis=0), distance)


def at_gap(still: Still) -> Camera:
    """The line, from near."""
    length = float(np.linalg.norm(still.line[1] - still.line[0]))
    return _camera_towards(still, still.line.mean(axis=0), max(6.0 * length, still.size / 12.0))


def _camera_towards(still: Still, target: np.ndarray, distance: float) -> Camera:
    """From the side where fewest boxes hide the line, or the separation vector, and it is least foreshortened."""
    line = still.line[1] - still.line[0] if still.separation is None else still.separation[1]
    length = np.linalg.norm(line)
    line = line / length if length > 0.0 else line
    others = [body for i, body in enumerate(still.bodies) if i not in still.nearest]
    boxes = [_box_of(still.shapes[one.i_shape][0].astype(np.float64), one.pose) for one in others]
    best, best_cost = target, math.inf
    for k in range(N_SIDES):
        turn = (k + 0.5) * 2.0 * math.pi / N_SIDES
        level = math.cos(LIFT)
        towards = np.array([math.cos(turn) * level, math.sin(turn) * level, math.sin(LIFT)])
        eye = target + distance * towards
        cost = _n_hiding(boxes, still.line.mean(axis=0), eye) + 0.8 * abs(float(towards @ line))
        if cost < best_cost - 1e-9:
            best, best_cost = eye, cost
    forward = (target - best) / np.linalg.norm(target - best)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return Camera(best, np.array([right, np.cross(right, forward), forward]), still.size / 2000.0)


def _n_hiding(boxes: list[np.ndarray], point: np.ndarray, eye: np.ndarray) -> int:
    """How many boxes stand between the eye and a point."""
    if not boxes:
        return 0
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (np.array(boxes) - point) / (eye - point)
    first, last = np.nanmin(ends, axis=1).max(axis=1), np.nanmax(ends, axis=1).min(axis=1)
    hit = np.where(first >= 0.0, first, last)
    return int(((first <= last) & (last >= 0.0) & (hit < 1.0)).sum())
