"""The bodies of a replay: what each is, where it is at every frame, and when it is not in the cell.

Poses are those of the phase that a frame is in, so a part that is carried moves with what carries it, and what
stands on something that moves rides with it. Not for: which frames there are (`frames`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.quaternions import quaternions_of
from clearance.query.distance import distance
from clearance.record.record import Record
from clearance.record.replay import LINK, MOVING, PART, STANDING, DrawnCarry
from clearance.world.case import Case
from clearance.world.clocks import clocks_of
from clearance.world.forest import forest_of, positions_between
from clearance.world.motion import place_in
from clearance.world.pairs import BodyIndex
from clearance.world.phase import Phase

SAME_PLACE = 1e-6
"""[m] A clearance that differs by less is that of the poses drawn."""


MOST_DRAWN = 100_000
"""Points of a cloud that are drawn at most: 1.2 MB."""


@dataclass(frozen=True, eq=False)
class FramePlace:
    """When a frame is.

    Attributes:
        step: the step or the one before. share: how much of the way to the next has passed, 0 to 1.
        clearance: [m] the one reported for it, or None.
        pair: the names of its two bodies, None where a bound decides.
        time_b: [s] when the second body is there, if its clock is another.
    """

    step: int
    share: float
    clearance: float | None
    pair: tuple[str | None, str | None]
    time_b: float | None = None


def kind_of(case: Case, body: BodyIndex) -> str:
    """What a body is drawn as."""
    if not body.is_obstacle:
        return STANDING if body.is_floor_in(case) else LINK
    if any(carry.part == body.name_in(case) for carry in case.carries):
        return PART
    return STANDING if case.obstacles[body.i_body].stands else MOVING


def carries_of(record: Record, bodies: Sequence[BodyIndex]) -> tuple[DrawnCarry, ...]:
    """Who carries what from when until when, in order of time."""
    case, times = record.case, record.timeline.times
    places = {name: i for i, name in enumerate(body.name_in(case) for body in bodies)}
    found = []
    for carry in case.carries:
        by = (
            carry.by.removeprefix(f"{case.robots[0].robot.name}/")
            if len(case.robots) == 1
            else carry.by
        )
        end = min(carry.window.end, float(times[-1]))
        start = max(carry.window.start, float(times[0]))
        found.append(DrawnCarry(carry.part, by, places[carry.part], places.get(by, -1), start, end))
    return tuple(sorted(found, key=lambda one: (one.start, one.part)))


@dataclass(frozen=True, eq=False)
class ReplayBodies:
    """Where all bodies of a record are at some frames.

    Attributes:
        poses: of each body (frames, 4, 4) [m]. shown: of each body (frames,) False while it is not in the cell.
    """

    poses: list[np.ndarray]
    shown: list[np.ndarray]


def placed_bodies(
    record: Record, bodies: Sequence[BodyIndex], frames: Sequence[FramePlace]
) -> ReplayBodies:
    """The poses of all bodies at the frames."""
    poses = np.empty((len(bodies), len(frames), 4, 4))
    shown = np.ones((len(bodies), len(frames)), dtype=bool)
    for phase, own in _by_phase(record, frames):
        link_poses = _link_poses(phase, [frames[i] for i in own])
        for k, body in enumerate(bodies):
            poses[k, own] = body.poses_in(phase.case, link_poses)
            shown[k, own] = not _is_absent(phase, body)
    for i, frame in enumerate(frames):
        before = _phase_before(record, frame)
        if before is not None and not _is_seen(record, bodies, frame, poses[:, i], shown[:, i]):
            _put(bodies, before, frame, poses[:, i], shown[:, i])
        if frame.time_b is not None:
            _put_second(record, bodies, frame, poses[:, i])
    return ReplayBodies(list(poses), list(shown))


def _by_phase(record: Record, frames: Sequence[FramePlace]) -> Iterator[tuple[Phase, np.ndarray]]:
    """The phases with the places of their frames; a step where two meet is of the later one."""
    firsts = [phase.first for phase in record.timeline.phases]
    owners = np.searchsorted(firsts, [frame.step for frame in frames], side="right") - 1
    for i, phase in enumerate(record.timeline.phases):
        own = np.flatnonzero(owners == i)
        if len(own):
            yield phase, own


def _link_poses(phase: Phase, frames: Sequence[FramePlace]) -> np.ndarray:
    """(k, links, 4, 4) of a phase's forest at frames of it."""
    forest = forest_of(phase.case)
    columns = [
        positions_between(phase.case, phase.motions, frame.step - phase.first, frame.share)
        for frame in frames
    ]
    return forest.poses(np.array(columns).reshape(len(frames), -1))


def _is_absent(phase: Phase, body: BodyIndex) -> bool:
    if body.is_obstacle:
        return body.i_body in phase.absent_obstacles
    return body.i_robot in phase.absent_robots


def _phase_before(record: Record, frame: FramePlace) -> Phase | None:
    """The phase that ends at the step of a frame, where another begins."""
    if frame.share > 0.0:
        return None
    ended = [phase for phase in record.timeline.phases if phase.last == frame.step]
    return None if not ended or ended[0] is record.timeline.phases[-1] else ended[0]


def _is_seen(
    record: Record,
    bodies: Sequence[BodyIndex],
    frame: FramePlace,
    poses: np.ndarray,
    shown: np.ndarray,
) -> bool:
    """True if what is reported of a frame is so with all bodies where they are drawn."""
    case = record.case
    pair = [i for name in frame.pair for i, body in enumerate(bodies) if body.name_in(case) == name]
    if len(pair) != 2 or frame.clearance is None or frame.time_b is not None:
        return True
    if not shown[pair].all():
        return False
    a, b = (bodies[i] for i in pair)
    shapes = a.shape_in(case), b.shape_in(case)
    reached = distance(*shapes, pose_a=poses[pair[0]], pose_b=poses[pair[1]]).distance
    padding = a.padding_in(case) + b.padding_in(case) + record.timeline.path_error
    return abs(reached - padding - frame.clearance) < SAME_PLACE


def _put(
    bodies: Sequence[BodyIndex],
    phase: Phase,
    frame: FramePlace,
    poses: np.ndarray,
    shown: np.ndarray,
) -> None:
    """Puts all bodies where they are in another phase that the frame belongs to."""
    link_poses = _link_poses(phase, [frame])
    for k, body in enumerate(bodies):
        poses[k] = body.poses_in(phase.case, link_poses)[0]
        shown[k] = not _is_absent(phase, body)


def _put_second(
    record: Record, bodies: Sequence[BodyIndex], frame: FramePlace, poses: np.ndarray
) -> None:
    """Puts what moves by the clock of the frame's second body where that is then."""
    case = record.case
    assert frame.time_b is not None
    clocks = clocks_of(case)
    second = next((body for body in bodies if body.name_in(case) == frame.pair[1]), None)
    step, share = place_in(record.timeline.times, frame.time_b)
    phase = record.timeline.phase_of(step)
    link_poses = _link_poses(phase, [FramePlace(step, share, None, (None, None))])
    for k, body in enumerate(bodies):
        if second is not None and clocks[body.thing] == clocks[second.thing]:
            poses[k] = body.poses_in(phase.case, link_poses)[0]


def packed(poses: np.ndarray) -> np.ndarray:
    """(n, 7) float32 xyz and quat_xyzw, one row where nothing moves."""
    if (poses == poses[0]).all():
        poses = poses[:1]
    rotations = quaternions_of(poses[:, :3, :3])
    return np.column_stack([poses[:, :3, 3], rotations]).astype(np.float32)


def notes_on_drawing(case: Case) -> list[str]:
    """A line on each cloud of which not all points are drawn."""
    clouds = [(one.name, one.body.shape) for one in case.obstacles]
    return [
        f"{name}: the pictures show one in {_every(shape)} of its {shape.n_points:,} points; all are measured"
        for name, shape in clouds
        if isinstance(shape, PointCloud) and _every(shape) > 1
    ]


def _every(cloud: PointCloud) -> int:
    """Of so many points in order, one is drawn."""
    return -(-cloud.n_points // MOST_DRAWN)


def shape_index(
    shape: Polyhedron, shapes: list[tuple[np.ndarray, np.ndarray]], seen: dict[bytes, int]
) -> int:
    """The place of a shape among those that are drawn, each of which is there once.

    A cloud has no triangles; of many points some are drawn.
    """
    if isinstance(shape, PointCloud):
        vertices = shape.vertices[:: _every(shape)].astype(np.float32)
        triangles = np.empty((0, 3), dtype=np.int32)
    else:
        vertices, triangles = shape.vertices.astype(np.float32), shape.triangles().astype(np.int32)
    key = vertices.tobytes() + triangles.tobytes()
    if key not in seen:
        seen[key] = len(shapes)
        shapes.append((vertices, triangles))
    return seen[key]
