"""What only a file shows of values that look like a wrong unit: angles as they are written, scales, radii,
limits of joints.

Not for: what the case itself shows (`world.plausibility`), and values that cannot be right (`schema.case`,
`csv_table`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydantic import BaseModel

from clearance.formats.schema.obstacle import Obstacle
from clearance.formats.schema.pose import Pose
from clearance.formats.schema.program import JointMove, PathMove
from clearance.formats.schema.program_file import Axis, ProgramFile
from clearance.geometry.shapes import SHAPES
from clearance.world.joint_positions import turns
from clearance.world.notice import IN_MILLIMETRES, Notice, listed, units
from clearance.world.robot import Joint

LARGE_RADIUS = 5.0
"""[m] No arm of this world works near a pipe or ball of more than ten metres across; 5 mm is a
usual radius.
"""

LARGE_BALL = 0.2
"""[m] Points of a scan are millimetres to centimetres apart; 5 is 5 mm."""

LARGE_SCALE = 100.0
"""[-] Mesh files are in metres or finer units, so that scales are 1 or less: 1000 is mistaken for 0.001."""

LARGE_ZONE = 1.0
"""[m] Corners of programs are rounded within 1 to 200 mm."""

TOO_WIDE = 10.0
"""[-] A slide's limit is so many of its own ranges out, or a speed so many times the robot's own: degrees are 57
times radians.
"""

MANY_TURNS = 6.0 * math.pi
"""[rad] Limits of joints that turn endlessly are a few turns at most; 30 degrees are 4.8 turns of radians."""

IN_DEGREES = "angles are in radians, is this degrees (90° are 1.5708 rad)?"

ROUND_ANGLE = 0.02
"""[rad] How near a multiple of pi/4 an angle is that is meant as one, written with few digits: 3.15, 4.7, 6.3."""


def obstacle_notices(obstacles: Sequence[Obstacle]) -> list[Notice]:
    """What is odd about radii, angles and scales of a scene's obstacles."""
    wide, turned = [], []
    for obstacle in obstacles:
        radius = _radius(obstacle)
        if radius > LARGE_RADIUS:
            wide.append(f"obstacle {obstacle.name!r} has a radius of {radius:g} m")
        if obstacle.points is not None and obstacle.points.radius > LARGE_BALL:
            wide.append(
                f"each point of {obstacle.name!r} has a radius of {obstacle.points.radius:g} m"
            )
        turned += odd_angles(f"obstacle {obstacle.name!r}", obstacle.pose.rpy)
    return [*map(units, _asked(wide, IN_MILLIMETRES)), *angle_notices(turned)]


def _asked(odd: Sequence[str], meant: str) -> list[str]:
    """A line that asks what is meant by odd values, if there are some."""
    return [f"{listed(odd)}; {meant}"] if odd else []


def _radius(obstacle: Obstacle) -> float:
    """[m] of a round shape; 0 for others."""
    shape = SHAPES.get(obstacle.kind)
    return 0.0 if shape is None or shape.radius is None else obstacle.dimensions[shape.radius]


def odd_in_program(*given: BaseModel | None) -> list[str]:
    """A line each on angles and corner radii of a program that look like another unit."""
    models = [one for model in given if model is not None for one in _within(model, "")]
    turned = [
        odd
        for where, one in models
        if isinstance(one, Pose)
        for odd in odd_angles(where or "the pose", one.rpy)
    ]
    turned += [
        f"{where}.offset is {one.offset:g} rad"
        for where, one in models
        if isinstance(one, Axis) and not isinstance(one.axis, str)
        if _looks_like_degrees(abs(one.offset))
    ]
    turned += [
        f"{where}.hold has {name} go to {value:g} rad"
        for where, one in models
        if isinstance(one, PathMove)
        for name, value in one.hold.items()
        if _is_round_in_degrees(abs(value))
    ]
    radii = [
        (f"{where}.zone", one.zone)
        for where, one in models
        if isinstance(one, JointMove | PathMove)
    ]
    files = [one for _, one in models if isinstance(one, ProgramFile)]
    radii += [(f"zones.{word}", radius) for one in files for word, radius in one.zones.items()]
    wide = [f"{where} is {radius:g} m" for where, radius in radii if radius > LARGE_ZONE]
    return [*_asked(turned, IN_DEGREES), *_asked(wide, IN_MILLIMETRES)]


def _within(model: Any, where: str) -> Iterator[tuple[str, BaseModel]]:
    """A model and all models in it, each with where it is written."""
    if isinstance(model, BaseModel):
        yield where, model
        parts = [(f"{where}.{name}", getattr(model, name)) for name in type(model).model_fields]
    elif isinstance(model, Mapping):
        parts = [(f"{where}.{name}", one) for name, one in model.items()]
    else:
        items = model if isinstance(model, list) else []
        parts = [(f"{where}[{i}]", one) for i, one in enumerate(items)]
    for place, one in parts:
        yield from _within(one, place.lstrip("."))


def odd_angles(what: str, rpy: Sequence[float] | None) -> list[str]:
    """That an angle looks like degrees, if one does."""
    odd = [angle for angle in map(abs, rpy or ()) if _looks_like_degrees(angle)]
    return [f"{what} has an angle of {max(odd):g} rad in its rpy"] if odd else []


def angle_notices(odd: Sequence[str]) -> list[Notice]:
    """One notice on all odd angles."""
    return [*map(units, _asked(odd, IN_DEGREES))]


def scale_notices(scales: Sequence[tuple[str, Sequence[float]]]) -> list[Notice]:
    """A notice if meshes, given by name, are made larger than any unit asks for."""
    large = [(name, max(map(abs, scale))) for name, scale in scales]
    odd = [
        f"the file is scaled by {scale:g} ({name})" for name, scale in large if scale >= LARGE_SCALE
    ]
    meant = "lengths are in metres, and a file in millimetres needs 0.001"
    return [*map(units, _asked(odd, meant))]


class LimitBound(NamedTuple):
    """A limit of a joint in a file, and the robot's own of its kind [rad or m, or either a second]."""

    kind: str
    joint: Joint
    given: float
    own: float
    is_wider: bool


def limit_notices(bounds: Iterable[LimitBound], shown: str) -> list[Notice]:
    """A notice on limits that are wider than the robot's own, so that they limit nothing, as in another unit."""
    odd = [
        f"{one.kind} of {one.joint.name} is {one.given:g}{_beside(one.own)}"
        for one in bounds
        if (one.is_wider or math.isinf(one.own)) and _is_far_out(one)
    ]
    meant = (
        "limits are in radians or metres, and these limit nothing; is this degrees or millimetres?"
    )
    return [units(f"{shown}: {one}") for one in _asked(odd, meant)]


def _beside(own: float) -> str:
    return "" if math.isinf(own) else f" beside the robot's own {own:g}"


def _is_far_out(bound: LimitBound) -> bool:
    """True for what rounding, full turns and a margin do not explain, nor that no limit is meant."""
    given, own = abs(bound.given), bound.own
    if bound.kind == "velocity":
        return given > TOO_WIDE * own and not _stands_for_none(given)
    span = bound.joint.upper - bound.joint.lower
    beyond = given if math.isinf(own) else abs(bound.given - own)
    if turns(bound.joint):
        return beyond > min(span, MANY_TURNS) and _looks_like_degrees(given)
    return beyond > TOO_WIDE * span


def _stands_for_none(speed: float) -> bool:
    """True for 100, 1000 and so on, which files write for a speed without a limit."""
    return speed >= 100.0 and math.log10(speed).is_integer()


def _looks_like_degrees(angle: float) -> bool:
    """True above two half turns, and above one for a number that is round in decimals and no part of a turn.

    Programs that write angles from 0 to a full turn write all digits; who writes 5 or 4.5 thinks of degrees.
    """
    return angle > 2.0 * np.pi + ROUND_ANGLE or _is_round_in_degrees(angle)


def _is_round_in_degrees(angle: float) -> bool:
    """True above a half turn for a number that is round in decimals and no part of a turn."""
    if angle <= np.pi + ROUND_ANGLE or round(angle, 2) != angle:
        return False
    eighths = angle / (np.pi / 4)
    return abs(eighths - round(eighths)) * np.pi / 4 > ROUND_ANGLE
