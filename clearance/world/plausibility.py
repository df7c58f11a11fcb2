"""Values of a case that can be right but look wrong: lengths, angles or times in another unit, joints beyond
their limits.

Works on the case itself, so that one made in memory is checked like one from files.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.world.case import Case
from clearance.world.collision_matrix import NEVER
from clearance.world.joint_limits import notices_on_joints
from clearance.world.joint_speeds import notices_on_speed
from clearance.world.notice import Notice, Severity, listed, units, worst_first
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_clocks import notices_on_clocks
from clearance.world.plausible_motion import (
    notices_on_motion,
)
from clearance.world.plausible_planes import notices_on_planes
from clearance.world.plausible_recordings import notices_on_holes, notices_on_unproven
from clearance.world.plausible_rest import notices_on_bases, notices_on_rest
from clearance.world.plausible_sizes import notices_on_sizes
from clearance.world.plausible_tables import notices_on_tables
from clearance.world.plausible_wrap import notices_on_wrap
from clearance.world.self_pairs import limbs, self_pairs

LARGE_LIMIT = 0.5
"""[m] A clearance limit above half a metre would forbid a robot most of its cell; in millimetres it
is usual.
"""

SMALL_LIMITS = 1e-6, 5e-5
"""[m] Nobody asks a robot for 1 to 50 micrometres; 1 to 50 mm, in metres and read as millimetres, are that."""


def notices_of(case: Case) -> tuple[Notice, ...]:
    """All that is suspect about a case, and all warnings, worst first: what loading found and what is seen here.

    Raises:
        BadInput: `limits.joints` is neither "warn" nor "fail".
    """
    found = [*case.notices, *_notices_of_robots(case)]
    found += _notices_on_limits(case)
    found += _notices_on_padding(case)
    found += notices_on_sizes(case)
    found += notices_on_scans(case)
    found += notices_on_planes(case)
    found += [one for placed in case.robots for one in notices_on_bases(placed)]
    found += notices_on_tables(case)
    found += notices_on_clocks(case)
    found += _rides_with_tolerance(case)
    found += _never_measured(case)
    found += _of_other_robots(case)
    moves = [placed.trajectory is not None for placed in case.robots]
    moves += [obstacle.moves is not None for obstacle in case.obstacles]
    for placed in case.robots:
        if not any(moves):
            break  # no robot has to move
        before = case.prefix_of(placed)
        if placed.trajectory is not None:
            found += notices_on_motion(placed, before)
            found += notices_on_speed(placed, case.limits.joints, before)
            found += notices_on_holes(placed, before)
            found += notices_on_unproven(placed, before)
            found += notices_on_wrap(placed, before)
        found += notices_on_rest(placed, before)
        found += notices_on_joints(placed, case.limits.joints, before)
        found += _limbs_not_measured(placed)
    return worst_first(found)


def _limbs_not_measured(placed: PlacedRobot) -> Iterator[Notice]:
    ends = [] if placed.self_clearance is not None else limbs(placed.robot)
    if ends:
        text = f"limbs of robot {placed.robot.name!r} are not measured against each other: those of {listed(ends)}"
        yield Notice(Severity.WARNING, "limbs", f"{text}; self_clearance: true measures them")


def _notices_of_robots(case: Case) -> list[Notice]:
    """Notices of loading about the robots; with several robots each says whose it is."""
    whose: dict[Notice, list[str]] = {}
    for placed in case.robots:
        for notice in placed.robot.notices:
            whose.setdefault(notice, []).append(repr(placed.robot.name))
    if len(case.robots) == 1:
        return list(whose)
    return [
        replace(notice, text=f"{notice.text} (robot {listed(names)})")
        for notice, names in whose.items()
    ]


def _notices_on_limits(case: Case) -> list[Notice]:
    limits = case.limits
    given = {"limits.fail": limits.fail, "limits.warn": limits.warn}
    for i, rule in enumerate(limits.rules):
        levels = {"fail": rule.fail, "warn": rule.warn}
        given |= {f"limits.rules[{i}].{key}": level for key, level in levels.items() if level}
    small = [
        f"{key} is {value * 1000:g} mm"
        for key, value in given.items()
        if SMALL_LIMITS[0] <= value <= SMALL_LIMITS[1]
    ]
    given |= {f"profiles[{i}].limit": space.limit for i, space in enumerate(case.profiles)}
    large = [f"{key} is {value:g} m" for key, value in given.items() if value > LARGE_LIMIT]
    found = _in_millimetres(large, "limits are")
    if small:
        asked = "is this metres, given to an option in millimetres?"
        found.append(units(f"{' and '.join(small[:2])}; {asked}"))
    return found


def _notices_on_padding(case: Case) -> list[Notice]:
    given = {f"obstacle {one.name!r}": one.padding for one in case.obstacles}
    for placed in case.robots:
        before = case.prefix_of(placed)
        given |= {f"link {before + link!r}": padding for link, padding in placed.padding.items()}
    large = [
        f"the padding of {what} is {value:g} m"
        for what, value in given.items()
        if value > LARGE_LIMIT
    ]
    return _in_millimetres(large, "paddings are")


def _in_millimetres(large: list[str], what: str) -> list[Notice]:
    if not large:
        return []
    names = " and ".join(large) if len(large) < 3 else listed(large)
    return [units(f"{names}; {what} in metres, is this millimetres?")]


def _never_measured(case: Case) -> Iterator[Notice]:
    """A notice on the pairs that a robot leaves out by `trust_never`; suspect for shapes other than collision."""
    for placed in case.robots:
        asked = placed.self_clearance
        if asked is None or not asked.trust_never:
            continue
        pairs = self_pairs(placed.robot, asked.matrix, trust_never=True)
        names = [f"{one.link_a} - {one.link_b}" for one in pairs if one.excused == NEVER]
        text = (
            f"trust_never leaves out what the SRDF calls Never ({listed(names)}): it says that collision shapes "
            "do not touch, and these pairs are taken to keep their limits too"
        )
        if names and asked.geometry != "collision":
            text = f"CHECK SHAPES: {text}, with geometry: {asked.geometry}; srdf audit --geometry proves them"
            yield Notice(Severity.SUSPECT, "never", text, placed.robot.name)
        elif names:
            yield Notice(Severity.WARNING, "never", text, placed.robot.name)


def _of_other_robots(case: Case) -> Iterator[Notice]:
    """A warning on an SRDF that names another robot: many robots call their links alike."""
    for placed in case.robots:
        matrix = None if placed.self_clearance is None else placed.self_clearance.matrix
        if matrix is not None and matrix.other:
            text = (
                f"the SRDF of robot {placed.robot.name!r} names another robot, {matrix.other!r}: is it the right "
                "file? pairs of links that it excuses are not measured"
            )
            yield Notice(Severity.WARNING, "srdf", text, placed.robot.name)


def _rides_with_tolerance(case: Case) -> Iterator[Notice]:
    """Warnings on tools that go with what has tolerances, which do not move them."""
    for placed in case.robots if case.tolerance is not None else ():
        if placed.trajectory is not None and placed.trajectory.rides:
            name, on = placed.robot.name, listed([*placed.trajectory.rides])
            text = (
                f"the tool of robot {name!r} goes with {on} exactly: a tolerance of {on} does not move the tool; "
                f"give robot {name!r} one as large if its controller measures where {on} is"
            )
            yield Notice(Severity.WARNING, "program", text, name)


SAMPLED = 200
"""Points that are asked whether their ball touches another."""


def notices_on_scans(case: Case) -> Iterator[Notice]:
    """A warning on each scan most of whose balls touch no other."""
    for obstacle in case.obstacles:
        shape = obstacle.body.shape
        if isinstance(shape, PointCloud) and _has_gaps(shape):
            mm = f"{1e3 * shape.ball_radius:.4g} mm"
            text = (
                f"scan {obstacle.name!r}: most of its balls of {mm} touch no other: what is thinner than the gaps "
                "between them passes through; its radius should be at least the distance of neighbouring points"
            )
            yield Notice(Severity.WARNING, "scan", text)


@lru_cache(maxsize=16)
def _has_gaps(shape: PointCloud) -> bool:
    """True if most of some balls, evenly spread, stand alone."""
    points = shape.vertices
    chosen = points[:: -(-len(points) // SAMPLED)]
    n_alone = sum(not _touches_another(point, points, shape.ball_radius) for point in chosen)
    return 2 * n_alone > len(chosen)


def _touches_another(point: np.ndarray, points: np.ndarray, radius: float) -> bool:
    """True if the ball about a point touches that of another of `points` (n, 3), which are ordered by x."""
    reach = 2.0 * radius
    ends = np.searchsorted(points[:, 0], [point[0] - reach, np.nextafter(point[0] + reach, np.inf)])
    near = points[ends[0] : ends[1]] - point
    return int(np.count_nonzero((near**2).sum(axis=1) <= reach * reach)) > 1
