"""Data of RAPID: records as lists, standard speeds and zones, poses, and functions of them; in mm and degrees.

Sources: ABB, Technical reference manual, RAPID instructions, functions and data types: `robtarget`, `orient` (q1
is the scalar), `confdata`, `speeddata`, `zonedata` (tables), `Offs`, `RelTool`, `OrientZYX`, `PoseMult`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import BadProgram
from clearance.formats.program.expressions import Unknown
from clearance.geometry.pose import inverse, pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import quaternions_of
from clearance.tolerance import ROUNDED_ROTATION

_SIX = (
    "rax_1 rax_2 rax_3 rax_4 rax_5 rax_6",
    "eax_a eax_b eax_c eax_d eax_e eax_f",
    "mass cog aom ix iy iz",
)
RECORDS: Mapping[int, list[list[str]]] = {
    n: [names.split() for names in own]
    for n, *own in (
        (2, "trans rot", "robax extax"),
        (3, "x y z", "robhold tframe tload"),
        (
            4,
            "q1 q2 q3 q4",
            "trans rot robconf extax",
            "cf1 cf4 cf6 cfx",
            "v_tcp v_ori v_leax v_reax",
        ),
        (5, "robhold ufprog ufmec uframe oframe"),
        (6, *_SIX),
        (7, "finep pzone_tcp pzone_ori pzone_eax zone_ori zone_leax zone_reax"),
    )
}
"""The fields of records, by how many a record has; a name is in one place in all of a length."""

NO_AXIS = 9e9
"""An external axis that is not there."""

_SPEEDS = (
    *(5, 10, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800),
    *(1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000, 7000),
)
_ZONES = {
    0: (0.3, 0.3, 0.3, 0.03, 0.3, 0.03),
    1: (1, 1, 1, 0.1, 1, 0.1),
    5: (5, 8, 8, 0.8, 8, 0.8),
    10: (10, 15, 15, 1.5, 15, 1.5),
    15: (15, 23, 23, 2.3, 23, 2.3),
    20: (20, 30, 30, 3.0, 30, 3.0),
    30: (30, 45, 45, 4.5, 45, 4.5),
    40: (40, 60, 60, 6.0, 60, 6.0),
    50: (50, 75, 75, 7.5, 75, 7.5),
    60: (60, 90, 90, 9.0, 90, 9.0),
    80: (80, 120, 120, 12, 120, 12),
    100: (100, 150, 150, 15, 150, 15),
    150: (150, 225, 225, 23, 225, 23),
    200: (200, 300, 300, 30, 300, 30),
}
_HERE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]
_NO_LOAD = [0.001, [0.0, 0.0, 0.001], [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0]

STANDARD: Mapping[str, Any] = {
    **{f"v{speed}": [float(speed), 500.0, 5000.0, 1000.0] for speed in _SPEEDS},
    "vmax": [7000.0, 500.0, 5000.0, 1000.0],
    **{f"z{size}": [False, *map(float, zone)] for size, zone in _ZONES.items()},
    "fine": [True, *(0.0,) * 6],
    "tool0": [True, _HERE, [0.0, *_NO_LOAD[1:]]],
    "wobj0": [False, True, "", _HERE, _HERE],
    "load0": _NO_LOAD,
    "pi": math.pi,
}
"""Data that every controller has."""


def pose_of(frame: Any) -> np.ndarray:
    """(4, 4) of a record [[x, y, z] in mm, [q1, q2, q3, q4]], lengths in m.

    Raises:
        BadProgram: an orientation that is none. TypeError, ValueError: other things.
    """
    (x, y, z), (q1, q2, q3, q4) = frame[0], frame[1]
    length = math.hypot(q1, q2, q3, q4)
    if not abs(length - 1.0) <= ROUNDED_ROTATION:
        raise BadProgram(
            f"the orientation {[q1, q2, q3, q4]} has length {length:.6g}",
            valid="length 1, q1 the scalar",
        )
    unit = [q2 / length, q3 / length, q4 / length, q1 / length]
    return pose_from_quaternion([1e-3 * x, 1e-3 * y, 1e-3 * z], unit)


def frame_of(pose: np.ndarray) -> list[list[float]]:
    """The record of a (4, 4) pose [m]."""
    x, y, z, w = quaternions_of(pose[None, :3, :3])[0].tolist()
    return [(1e3 * pose[:3, 3]).tolist(), [w, x, y, z]]


def tool_record(pose: np.ndarray) -> list[Any]:
    """`tooldata` of a tool on the flange, by its (4, 4) pose [m]."""
    return [True, frame_of(pose), _NO_LOAD]


def work_object_record(pose: np.ndarray) -> list[Any]:
    """`wobjdata` of a frame on the base, by its (4, 4) pose [m]."""
    return [False, True, "", frame_of(pose), _HERE]


_ROUNDING = math.radians(0.1)
"""[rad] By which an axis may be beyond its quarter turn, since targets are rounded."""


def external_of(values: list[float]) -> dict[str, float]:
    """The external axes of a target that are there, as they are written."""
    return {f"E{i}": value for i, value in enumerate(values, 1) if abs(value) < NO_AXIS}


def configuration_of(flags: list[float], has_more: bool) -> dict[str, Any]:
    """A configuration by the field of a `PoseTarget`: quarter turns of axes 1, 4 and 6; `cfx` has the sign of axis
    5, and whether the wrist is behind the lower arm and behind axis 1.

    Args:
        has_more: external axes are there; one may be the seventh of an arm, whose `cfx` means something else.
    """
    quarter = math.pi / 2.0
    ranges = {
        axis: (flag * quarter - _ROUNDING, (flag + 1.0) * quarter + _ROUNDING)
        for axis, flag in zip((1, 4, 6), flags, strict=False)
    }
    if has_more or not 0.0 <= flags[3] <= 7.0:
        return {"ranges": ranges, "unchecked": f"cfx {flags[3]:g}"}
    cfx = int(flags[3])
    ranges[5] = (-math.pi, _ROUNDING) if cfx & 1 else (-_ROUNDING, math.pi)
    return {"ranges": ranges, "is_back": bool(cfx & 2), "is_behind": bool(cfx & 4)}


def record(value: Any, n: int, is_flagged: bool) -> list[Any]:
    """The n fields of a record, whose first is a truth if it is flagged.

    Raises:
        TypeError: it is another.
    """
    if not isinstance(value, list) or len(value) != n or isinstance(value[0], bool) != is_flagged:
        raise TypeError
    return value


def flange_from_tool(value: list[Any]) -> np.ndarray:
    """(4, 4) `flange_from_tool` [m].

    Raises:
        BadProgram: a tool that stands.
    """
    holds, frame, _ = record(value, 3, is_flagged=True)
    if not holds:
        raise BadProgram(
            "the tool stands, and the robot holds the work", valid="use a tool that the robot holds"
        )
    return pose_of(frame)


def speed_of(value: Any, options: Mapping[str, float]) -> tuple[float, float, float | None]:
    """[m/s] and [rad/s] of the tool, and the time that the move asks for in their place [s].

    Args:
        options: arguments of the move that replace them, V [mm/s] and T [s].
    """
    tcp, turn, *_ = record(value, 4, is_flagged=False)
    speed, time = 1e-3 * options.get("v", tcp), options.get("t")
    if time is not None and not time > 0.0:
        raise BadProgram(f"T is {time:g} s", valid="more than 0")
    if not speed > 0.0:
        raise BadProgram(f"the speed is {speed:g} m/s", valid="more than 0")
    return speed, math.radians(turn), time


def zone_of(value: Any, options: Mapping[str, float]) -> tuple[float, float]:
    """[m] The radii of a zone for the tool's point, which Z replaces, and its orientation; 0 where it stops."""
    stops, point, turn, *_ = record(value, 7, is_flagged=True)
    if stops:
        return 0.0, 0.0
    point = options.get("z", point)
    if point < 0.0 or turn < 0.0:
        raise BadProgram(f"a zone of {point:g} mm", valid="0 or more")
    return 1e-3 * point, 1e-3 * turn


class Work(NamedTuple):
    """A work object: its pose (4, 4) [m] on a mechanical unit, or on the controller's base if that is empty."""

    unit: str
    pose: np.ndarray


def work_of(value: list[Any], units: Mapping[str, str]) -> Work:
    """A work object: user frame times object frame; a unit that moves it has the user frame itself.

    Args:
        units: mechanical units whose frames the case gives, by name in small letters.

    Raises:
        BadProgram: one that the robot holds, or that moves with an unknown unit.
    """
    holds, is_fixed, unit, user, frame = record(value, 5, is_flagged=True)
    if holds:
        valid = "use a work object that stands, with ufprog TRUE"
        raise BadProgram("the robot holds the work object", valid=valid)
    if is_fixed:
        return Work("", pose_of(user) @ pose_of(frame))
    if str(unit).lower() not in units:
        valid = f"units: {{{unit or 'STN_1'}: {{on: turntable/plate}}}}, where its user frame is"
        raise BadProgram(f"mechanical unit {unit!r} moves the work object", valid=valid)
    return Work(units[unit.lower()], pose_of(frame))


def _offs(target: list[Any], *way: float) -> list[Any]:
    return [[a + b for a, b in zip(target[0], way, strict=True)], *target[1:]]


def _rel_tool(
    target: list[Any],
    x: float,
    y: float,
    z: float,
    rx: float = 0.0,
    ry: float = 0.0,
    rz: float = 0.0,
) -> list[Any]:
    """`RelTool`: moved along the tool's axes [mm], then turned about its x, the new y and the new z [degrees]."""
    pose = pose_of(target)
    pose[:3, 3] += 1e-3 * pose[:3, :3] @ np.array([x, y, z])
    for angle, axis in ((rx, 0), (ry, 1), (rz, 2)):
        turn = [0.0, 0.0, 0.0]
        turn[axis] = math.radians(angle)
        pose[:3, :3] = pose[:3, :3] @ pose_from_rpy([0.0, 0.0, 0.0], turn)[:3, :3]
    return [*frame_of(pose), *target[2:]]


def array_of(first: Any, *sizes: float) -> Any:
    """An array that is declared: its value, or a first value for each item.

    Raises:
        BadProgram: a size that is none.
    """
    if isinstance(first, list) or not sizes:
        return first
    if not 1 <= sizes[0] <= 1000:
        raise BadProgram(f"an array of {sizes[0]:g} items", valid="1 to 1000")
    item = Unknown("an item of an array has no value") if first is None else first
    return [array_of(item, *sizes[1:]) for _ in range(int(sizes[0]))]


def _rounded(value: float, dec: float = 0.0, more: float = 0.5) -> float:
    return math.floor(abs(value) * 10.0**dec + more) / 10.0**dec * math.copysign(1.0, value)


def _turned(z: float, y: float, x: float) -> list[float]:
    """`OrientZYX` [degrees]."""
    turn = [math.radians(one) for one in (x, y, z)]
    return frame_of(pose_from_rpy([0.0, 0.0, 0.0], turn))[1]


VALUES: Mapping[str, Callable[..., Any]] = {
    "%array": array_of,
    "Offs": _offs,
    "RelTool": _rel_tool,
    "PoseMult": lambda a, b: frame_of(pose_of(a) @ pose_of(b)),
    "PoseInv": lambda a: frame_of(inverse(pose_of(a))),
    "PoseVect": lambda a, way: frame_of(pose_of(a) @ pose_of([way, _HERE[1]]))[0],
    "OrientZYX": _turned,
    "NOrient": lambda q: [one / math.hypot(*q) for one in q],
    "Distance": lambda a, b: math.dist(a, b),
    "VectMagn": lambda a: math.hypot(*a),
    "DotProd": lambda a, b: float(np.dot(a, b)),
    "Dim": lambda array, level: float(len(array)) if level == 1 else float(len(array[0])),
    "Abs": abs,
    "Sqrt": math.sqrt,
    "Pow": math.pow,
    "Exp": math.exp,
    "Round": _rounded,
    "Trunc": lambda a, dec=0.0: _rounded(a, dec, 0.0),
    "Sin": lambda a: math.sin(math.radians(a)),
    "Cos": lambda a: math.cos(math.radians(a)),
    "Tan": lambda a: math.tan(math.radians(a)),
    "ASin": lambda a: math.degrees(math.asin(a)),
    "ACos": lambda a: math.degrees(math.acos(a)),
    "ATan": lambda a: math.degrees(math.atan(a)),
    "ATan2": lambda y, x: math.degrees(math.atan2(y, x)),
}
"""Functions whose value follows from their arguments."""
