"""Bodies and places that look like millimetres: extents held against the robot's reach, and distances too.

Not for: bodies beyond all bounds (`reach`), which are refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from clearance.geometry.shapes import SHAPES
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.notice import Notice, Severity, listed
from clearance.world.robot import JointKind

RATIO = 200.0
"""[-] An obstacle this many times as long as the robot reaches, or a body this many times shorter, is in another
unit: millimetres are 1000. Of 69 robots no mesh is shorter than 1/43 of the reach."""

LONG_MESH, SHORT_MESH = 50.0, 0.01
"""[-] Parts of the reach from and up to which a mesh is also held against the other obstacles."""

FAR = 20.0
"""[-] An obstacle farther away than this many times the reach, and than this many metres, is not its own."""

HALL, WALL = 100.0, 5.0
"""[m] No cell is so large. [-] Within it, what is no farther away than this many times its length is a wall."""

FAR_ORIGIN = 20.0
"""[m] No joint is as far from the one before, and no shape from its link; 20 mm is usual."""


class Frame(NamedTuple):
    """What a robot's surroundings are measured by.

    Attributes:
        reach: [m] length of its longest chain of joints, slides included, and of its median body.
        base: (3,) where it stands.
    """

    reach: float
    base: np.ndarray


def notices_on_sizes(case: Case) -> list[Notice]:
    """What of the bodies and places of a case looks like another unit."""
    told: list[str] = []
    for placed in case.robots:
        told += _odd_origins(placed)
        told += _odd_links(placed)
    if not told:  # a robot that is odd itself is no measure for others
        frames = [_frame(placed) for placed in case.robots]
        told = [*_odd_obstacles(case.obstacles, frames), *_odd_places(case, frames)]
    return [Notice(Severity.SUSPECT, "units", f"CHECK UNITS: {text}") for text in told]


def _frame(placed: PlacedRobot) -> Frame:
    lengths = [_length(body) for body in placed.robot.bodies]
    size = float(np.median(lengths)) if lengths else 0.0
    return Frame(_chain(placed) + size, placed.world_from_base[:3, 3])


def _chain(placed: PlacedRobot) -> float:
    """[m] the longest way from the root over joints' origins, sliding joints as far as they go."""
    asked = placed.trajectory
    columns = {} if asked is None else {name: i for i, name in enumerate(asked.joint_names)}
    way = {placed.robot.link_names[0]: 0.0}
    for joint in placed.robot.joints:
        step = float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        if asked is not None and joint.kind is JointKind.PRISMATIC and joint.name in columns:
            step += float(np.abs(asked.positions[:, columns[joint.name]]).max(initial=0.0))
        way[joint.child] = way[joint.parent] + step
    return max(way.values())


def _length(body: Body) -> float:
    """[m] the longest side of a body's box."""
    return float(np.ptp(body.shape.bounds, axis=0).max())


def _odd_origins(placed: PlacedRobot) -> list[str]:
    far = [
        (float(np.linalg.norm(joint.parent_from_joint[:3, 3])), f"joint {joint.name!r}")
        for joint in placed.robot.joints
    ]
    far += [
        (
            float(np.linalg.norm(np.clip(0.0, *body.shape.bounds))),
            f"the shape of link {body.name!r}",
        )
        for body in placed.robot.bodies
    ]
    odd = [
        f"{what} stands {_metres(away)} m away"
        for away, what in _greatest(far)
        if away > FAR_ORIGIN
    ]
    return (
        [f"{listed(odd)} from its link's frame; lengths are in metres, is this millimetres?"]
        if odd
        else []
    )


def _odd_links(placed: PlacedRobot) -> list[str]:
    """Links that are much longer than the robot reaches, and meshes that are much shorter."""
    bodies = placed.robot.bodies
    lengths = [_length(body) for body in bodies]
    if not lengths:
        return []
    reach = _frame(placed).reach
    usual = _chain(placed) + sorted(lengths)[(len(lengths) - 1) // 2]
    long, tiny = [], []
    for body, length in zip(bodies, lengths, strict=True):
        text = f"link {body.name!r} is {_metres(length)} m long"
        if length >= RATIO * usual > 0:
            long.append((length, text))
        elif _is_mesh(body) and length * RATIO <= reach:
            tiny.append((-length, text))
    return _lengths_told(long, tiny, reach)


def _lengths_told(
    long: list[tuple[float, str]], tiny: list[tuple[float, str]], reach: float
) -> list[str]:
    return [
        f"{listed([text for _, text in _greatest(odd)])} where the robot reaches {_metres(reach)} m; {hint}"
        for odd, hint in ((long, _TOO_LARGE), (tiny, _TOO_SMALL))
        if odd
    ]


_TOO_LARGE = (
    "lengths are in metres, is this millimetres (a mesh file in millimetres needs scale 0.001)?"
)
_TOO_SMALL = "lengths are in metres, is it scaled by 0.001 though its file is in metres?"


def _odd_obstacles(obstacles: Sequence[Obstacle], frames: Sequence[Frame]) -> list[str]:
    least, most = min(f.reach for f in frames), max(f.reach for f in frames)
    lengths = [_length(obstacle.body) for obstacle in obstacles]
    large, small = [], []
    for i, obstacle in enumerate(obstacles):
        others = lengths[:i] + lengths[i + 1 :]
        text = f"obstacle {obstacle.name!r} is {_metres(lengths[i])} m long"
        if _is_large(obstacle.body, lengths[i], others, most):
            large.append((lengths[i], text))
        elif _is_small(obstacle.body, lengths[i], others, least):
            small.append((-lengths[i], text))
    return _lengths_told(large, small, least)


def _is_large(body: Body, length: float, others: list[float], reach: float) -> bool:
    if length >= RATIO * reach > 0:
        return True
    among = _is_mesh(body) and bool(others) and length >= RATIO * float(np.median(others))
    return among and length >= LONG_MESH * reach


def _is_small(body: Body, length: float, others: list[float], reach: float) -> bool:
    if length * RATIO <= reach:
        return True
    among = _is_mesh(body) and bool(others) and length * RATIO <= max(others)
    return among and length <= SHORT_MESH * reach


def _is_mesh(body: Body) -> bool:
    return not set(body.origin.split(", ")) <= SHAPES.keys()


def _odd_places(case: Case, frames: Sequence[Frame]) -> list[str]:
    """Obstacles, or else a base, that stand where no robot of the case gets."""
    far = []
    for obstacle in case.obstacles:
        gaps = [_gap(obstacle, frame.base) for frame in frames]
        if not all(
            gap > FAR * max(1.0, frame.reach) for gap, frame in zip(gaps, frames, strict=True)
        ):
            continue
        if min(gaps) > min(HALL, WALL * _length(obstacle.body)):
            far.append((min(gaps), obstacle.name))
    if not far:
        return []
    far = _greatest(far)
    base = max(float(np.abs(frame.base).max()) for frame in frames)
    hint = "lengths are in metres, is this millimetres?"
    if len(far) == len(case.obstacles) and base > FAR:
        apart = f"{_metres(far[-1][0])} m from the nearest obstacle"
        return [f"the robot's base stands {_metres(base)} m away, {apart}; {hint}"]
    stand = listed(
        [
            f"obstacle {name!r} stands {_metres(gap)} m away from the robot's base"
            for gap, name in far
        ]
    )
    return [f"{stand}; {hint}"]


def _gap(obstacle: Obstacle, point: np.ndarray) -> float:
    """[m] from a point in the world to an obstacle's box."""
    pose = obstacle.world_from_body
    local = pose[:3, :3].T @ (point - pose[:3, 3])
    return float(np.linalg.norm(local - np.clip(local, *obstacle.body.shape.bounds)))


def _greatest(found: Iterable[tuple[float, str]]) -> list[tuple[float, str]]:
    return sorted(found, key=lambda item: -item[0])


def _metres(length: float) -> str:
    """Three digits, never in powers of ten for what is long."""
    return f"{length:.3g}" if length < 1000.0 else f"{length:.0f}"
