"""Bodies that look like millimetres: extents compared with the robot's reach, places with where robots get."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.shapes import SHAPES
from clearance.query.distance import distance
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.extents import (
    chain_of,
    farthest_corner,
    greatest,
    length_of,
    metres,
    own_bodies,
    reach_of,
    slides_of,
)
from clearance.world.forest import owner_of, resolved_mount
from clearance.world.notice import IN_MILLIMETRES, Notice, Severity, listed, units
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind
from clearance.world.robot_in_cell import robots_below
from clearance.world.whereabouts import Place, bases_of, obstacle_place

RATIO = 200.0
"""[-] An obstacle this many times as long as the robot reaches, or a body this many times shorter, is in another
unit: millimetres are 1000. Of 69 robots no mesh is shorter than 1/43 of the reach."""

OF_A_MESH, RIDING = 100.0, 20.0
"""[-] The same of an obstacle that is a mesh, whose file may be in millimetres, and of what rides on a link."""

LONG_MESH = 50.0
"""[-] Times the reach from which a mesh is also compared with the other obstacles."""

FAR_ORIGIN = 20.0
"""[m] No joint is as far from the one before, and no shape from its link; 20 mm is usual."""


def notices_on_sizes(case: Case) -> list[Notice]:
    """Bodies and places of a case that look like another unit."""
    return list(_notices(case, tuple(map(slides_of, case.robots))))


@once_a_cell(16)
def _notices(case: Case, slides: tuple) -> tuple[Notice, ...]:
    """The same; of the motion only `slides` counts, as `slides_of` returns them."""
    texts: list[str] = []
    for placed in case.robots:
        before = case.prefix_of(placed)
        texts += _odd_origins(placed, before)
        texts += _odd_links(placed, before)
    if not texts:  # a robot that is odd itself is no measure for others
        reaches = [reach_of(placed) for placed in case.robots]
        texts = [*_odd_obstacles(case, reaches), *odd_places(case)]
    return tuple(map(units, texts)) or tuple(_far_off(case))


def _odd_origins(placed: PlacedRobot, before: str) -> list[str]:
    far = [
        (float(np.linalg.norm(joint.parent_from_joint[:3, 3])), f"joint {before + joint.name!r}")
        for joint in placed.robot.joints
    ]
    far += [
        (
            float(np.linalg.norm(np.clip(0.0, *body.shape.bounds))),
            f"the shape of link {before + body.name!r}",
        )
        for body in placed.robot.bodies
    ]
    odd = [
        f"{what} stands {metres(away)} m away" for away, what in greatest(far) if away > FAR_ORIGIN
    ]
    return [f"{listed(odd)} from its link's frame; {IN_MILLIMETRES}"] if odd else []


def _odd_links(placed: PlacedRobot, before: str) -> list[str]:
    """Links that are much longer than the robot reaches, and meshes that are much shorter."""
    bodies = own_bodies(placed.robot)
    lengths = [length_of(body) for body in bodies]
    if not lengths:
        return []
    usual = chain_of(placed) + sorted(lengths)[(len(lengths) - 1) // 2]
    long, tiny = [], []
    for body, length in zip(bodies, lengths, strict=True):
        text = f"link {before + body.name!r} is {metres(length)} m long"
        if length >= RATIO * usual > 0:
            long.append((length, text))
        elif _is_mesh(body) and length * RATIO <= usual:
            tiny.append((-length, text))
    return _lengths_in_words(long, tiny, usual)


def _lengths_in_words(
    long: list[tuple[float, str]], tiny: list[tuple[float, str]], reach: float
) -> list[str]:
    return [
        f"{listed([text for _, text in greatest(odd)])} where the robot reaches {metres(reach)} m; {hint}"
        for odd, hint in ((long, _TOO_LARGE), (tiny, _TOO_SMALL))
        if odd
    ]


_TOO_LARGE = f"{IN_MILLIMETRES[:-1]} (a mesh file in millimetres needs scale 0.001)?"
_TOO_SMALL = (
    "lengths are in metres, is it a thousand times too small (a mesh file in metres has scale 1)?"
)


def _odd_obstacles(case: Case, reaches: Sequence[float]) -> list[str]:
    least, most = min(reaches), max(reaches)
    lengths = [length_of(obstacle.body) for obstacle in case.obstacles]
    large, small = [], []
    for i, obstacle in enumerate(case.obstacles):
        others = lengths[:i] + lengths[i + 1 :]
        text = f"obstacle {obstacle.name!r} is {metres(lengths[i])} m long"
        rides = _rides(case, obstacle)
        is_long = rides and lengths[i] >= RIDING * most > 0
        if is_long or _is_large(obstacle.body, lengths[i], others, most):
            large.append((lengths[i], text))
        elif _is_small(obstacle.body, lengths[i], least, rides=rides):
            small.append((-lengths[i], text))
    return _lengths_in_words(large, small, least)


def _rides(case: Case, obstacle: Obstacle) -> bool:
    """True for a part in a hand, and for what is mounted on a link."""
    mounted = obstacle.mount is not None and not owner_of(case, obstacle.mount)[0]
    return mounted or any(carry.part == obstacle.name for carry in case.carries)


def _is_large(body: Body, length: float, others: list[float], reach: float) -> bool:
    if length >= (OF_A_MESH if _is_mesh(body) else RATIO) * reach > 0:
        return True
    among = _is_mesh(body) and bool(others) and length >= RATIO * float(np.median(others))
    return among and length >= LONG_MESH * reach


def _is_small(body: Body, length: float, reach: float, *, rides: bool) -> bool:
    """True for what is far too short; parts in a hand may be screws."""
    return length * (OF_A_MESH if _is_mesh(body) and not rides else RATIO) <= reach


def _is_mesh(body: Body) -> bool:
    return not set(body.origin.split(", ")) <= SHAPES.keys()


POINT = 1e-6
"""[m] The radius of a ball that stands for a point."""

FAR = 20.0
"""[-] An obstacle farther away than this many times the reach, and than this many metres, is not its own."""

HALL, WALL, THIN = 100.0, 5.0, 0.1
"""[m] No cell is so large. Within it [-] what is no farther away than this many times its length, and no thicker
than this part of it, is a wall."""


def odd_places(case: Case) -> list[str]:
    """Obstacles, or else bases, that stand where no robot of the case gets, or far from all else."""
    bases = bases_of(case)
    reaches = [reach_of(placed) for placed in case.robots]
    far, gaps = [], _gaps(case, bases, of_units=True)
    for obstacle, own in zip(case.obstacles, gaps, strict=True):
        near = any(gap <= FAR * max(1.0, reach) for gap, reach in zip(own, reaches, strict=True))
        if not near and not _may_be_wall(obstacle.body, min(own)):
            far.append((min(own), obstacle.name))
    return _in_words(case, greatest(far), bases) if far else _odd_bases(case, bases, gaps)


def _odd_bases(case: Case, bases: Sequence[Place], gaps: Sequence[Sequence[float]]) -> list[str]:
    """A line on robots that stand far from all that is not on them: from another robot, and from each obstacle."""
    farthest, far = FAR * max(1.0, *map(reach_of, case.robots)), []
    for i, base in enumerate(bases):
        on = {(False, k) for k in range(len(bases)) if i in (k, *robots_below(case, k))}
        away = [_apart(base, other) for k, other in enumerate(bases) if (False, k) not in on]
        for one, own in zip(case.obstacles, gaps, strict=True):
            if away and (one.mount is None or owner_of(case, one.mount) not in on):
                away.append(own[i])
        if min(away, default=0.0) > farthest:
            far.append((min(away), f"robot {case.robots[i].robot.name!r} stands"))
    stand = [f"{text} {metres(gap)} m away from all else" for gap, text in greatest(far)]
    return [f"{listed(stand)}; {IN_MILLIMETRES}"] if far else []


def _apart(one: Place, other: Place) -> float:
    """[m] Two origins never are nearer."""
    between = float(np.linalg.norm(one.pose[:3, 3] - other.pose[:3, 3]))
    return between - one.travel - other.travel


def _may_be_wall(body: Body, gap: float) -> bool:
    sides = np.ptp(body.shape.bounds, axis=0)
    is_thin = sides.min() <= THIN * sides.max()
    return bool(is_thin and gap <= min(HALL, WALL * sides.max()))


FAR_OFF = 5.0
"""[-] What stays this many times as far away as `reach_of` is idle."""


def _far_off(case: Case) -> list[Notice]:
    """A warning where no obstacle is within reach, else on those that no robot ever comes near to."""
    gaps = _gaps(case, bases_of(case))
    return _out_of_reach(case, gaps) or _idle(case, gaps)


def _out_of_reach(case: Case, gaps: Sequence[Sequence[float]]) -> list[Notice]:
    """A warning where no robot, with what is mounted on it, reaches any obstacle. Carried parts are anywhere."""
    standing = [one for one in zip(case.obstacles, gaps, strict=True) if not _rides(case, one[0])]
    if case.carries or not standing:
        return []
    mounts = [(one.body, one.mount) for one in case.obstacles if one.mount and _rides(case, one)]
    longest = max((_length_on(case, *one) for one in mounts), default=0.0)
    reaches = [reach_of(one) + longest + _slides_left(one) for one in case.robots]
    within = [reach * _farther(one) for one, reach in zip(case.robots, reaches, strict=True)]
    if any(gap <= reach for _, own in standing for gap, reach in zip(own, within, strict=True)):
        return []
    gap, name = min((min(own), one.name) for one, own in standing)
    text = (
        f"no obstacle is within reach: {name!r}, the nearest, stays {metres(gap)} m and more away from "
        f"{_whose_base(case)}, and no point of a link gets farther than {metres(max(reaches))} m from it; "
        "are base, places and units right?"
    )
    return [Notice(Severity.WARNING, "reach", text)]


def _slides_left(placed: PlacedRobot) -> float:
    """[m] How much farther its sliding joints can go than they do, where they have limits."""
    gone = dict(slides_of(placed))
    ends = [(gone[j.name], max(-j.lower, j.upper)) for j in placed.robot.joints if j.name in gone]
    return sum(max(0.0, end - way) for way, end in ends if np.isfinite(end))


def _farther(placed: PlacedRobot) -> float:
    """[-] How many times its reach a robot may get: what slides without limits is only held against far things."""
    slides = [one for one in placed.robot.joints if one.kind is JointKind.PRISMATIC]
    is_free = any(not np.isfinite([one.lower, one.upper]).all() for one in slides)
    return FAR_OFF if is_free else 1.0


def _length_on(case: Case, body: Body, mount: Mount) -> float:
    """[m] No point of a body is farther from the link that it is mounted on."""
    return float(np.linalg.norm(resolved_mount(case, mount).pose[:3, 3])) + farthest_corner(body)


def _idle(case: Case, gaps: Sequence[Sequence[float]]) -> list[Notice]:
    """A warning on what stays far away where others are near, as in a hall: not on walls, and on shapes without a
    file only from twice as far."""
    reach = max(map(reach_of, case.robots))
    far = [
        (min(own), f"obstacle {one.name!r} stays {metres(min(own))} m")
        for one, own in zip(case.obstacles, gaps, strict=True)
        if min(own) > _idle_from(one.body) * reach and not _may_be_wall(one.body, min(own))
    ]
    if not far:
        return []
    text = f"{listed([text for _, text in greatest(far)])} and more away from {_whose_base(case)}"
    return [far_off_notice(text, min(far)[0] / reach)]


def _idle_from(body: Body) -> float:
    return FAR_OFF if _is_mesh(body) else 2.0 * FAR_OFF


def far_off_notice(text: str, times: float) -> Notice:
    """A warning that what is measured is many times the reach away."""
    asks = "are sizes and places in metres, not in millimetres?"
    return Notice(Severity.WARNING, "units", f"{text}, {times:.0f} times its reach: {asks}")


def _whose_base(case: Case) -> str:
    return "the robot's base" if len(case.robots) == 1 else "every robot's base"


def _gaps(case: Case, bases: Sequence[Place], of_units: bool = False) -> list[list[float]]:
    """[m] Least distances of each obstacle from each base.

    Args:
        of_units: of parts that a robot picks up first, until it does; of a box round a base, its surface.
    """
    return [
        [_gap(obstacle, obstacle_place(case, i, of_units), base, of_units) for base in bases]
        for i, obstacle in enumerate(case.obstacles)
    ]


def _in_words(case: Case, far: list[tuple[float, str]], bases: list[Place]) -> list[str]:
    base = max(float(np.abs(place.pose[:3, 3]).max()) for place in bases)
    whose = _whose_base(case)
    if len(far) == len(case.obstacles) and base > FAR:
        gap_text = f"{metres(far[-1][0])} m from the nearest obstacle"
        return [f"{whose} stands {metres(base)} m away, {gap_text}; {IN_MILLIMETRES}"]
    stand = [f"obstacle {name!r} stands {metres(gap)} m away from {whose}" for gap, name in far]
    return [f"{listed(stand)}; {IN_MILLIMETRES}"]


def _gap(obstacle: Obstacle, place: Place, base: Place, of_units: bool) -> float:
    """[m] Nothing of an obstacle ever is nearer to a base."""
    pose = place.pose
    local = pose[:3, :3].T @ (base.pose[:3, 3] - pose[:3, 3])
    if obstacle.stands:
        gap = _from_body(obstacle.body, local, of_units)
    else:  # it may be turned
        gap = float(
            np.linalg.norm(local) - np.linalg.norm(obstacle.body.shape.bounds, axis=1).max()
        )
    return gap - place.travel - base.travel


def _from_body(body: Body, point: np.ndarray, of_units: bool) -> float:
    """[m] No point of a body is nearer to a point in its frame."""
    low, high = body.shape.bounds
    outside = float(np.linalg.norm(point - np.clip(point, low, high)))
    if outside > 0.0 or body.is_cloud:
        return outside
    if body.origin == "box" and of_units:
        return float(min((point - low).min(), (high - point).min()))
    return distance(PointCloud(point[None], POINT), body.shape).distance
