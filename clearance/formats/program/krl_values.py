"""Values of KRL: frames as aggregates (`{X 1, Y 2, …}`), in mm and degrees. Not for: how they are written."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.program.expressions import Unknown
from clearance.geometry.pose import pose_from_rpy

MM = 1e-3

FRAME = ("X", "Y", "Z", "A", "B", "C")

UNIT = "UNIT"
"""The part of a base that a machine carries: which one; no frame of a file has it."""

Aggregate = Mapping[str, Any]


def is_number(value: object) -> bool:
    """True for a number; a truth value is none, nor is what is too large for one."""
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return is_one and abs(value) < 1e300  # type: ignore[arg-type]


def matrix_of(frame: Aggregate, shown: str) -> np.ndarray:
    """(4, 4) [m] The frame of an aggregate: A about z, then B about the new y, then C about the new x.

    Raises:
        BadSyntax: not six numbers.
    """
    for key in FRAME:
        value = frame.get(key, Unknown("it is not given"))
        if not is_number(value):
            fault = f"{key} of {shown} is not known: {why(value)}"
            raise BadSyntax(fault, valid="X, Y, Z, A, B and C as numbers")
    x, y, z, a, b, c = (float(frame[key]) for key in FRAME)
    return pose_from_rpy([x * MM, y * MM, z * MM], [math.radians(one) for one in (c, b, a)])


def frame_of(pose: np.ndarray) -> Aggregate:
    """The aggregate of a pose (4, 4) [m]; B is within 90 degrees."""
    x, y, z = (float(one) for one in pose[:3, 3] / MM)
    turn = pose[:3, :3]
    level = math.hypot(turn[0, 0], turn[1, 0])
    a, c = math.atan2(turn[1, 0], turn[0, 0]), math.atan2(turn[2, 1], turn[2, 2])
    if level < 1e-12:
        a, c = math.atan2(-turn[0, 1], turn[1, 1]), 0.0
    angles = (math.degrees(one) for one in (a, math.atan2(-turn[2, 0], level), c))
    return dict(zip(FRAME, (x, y, z, *angles), strict=True))


def composed(one: Any, other: Any) -> Aggregate:
    """A frame seen from where another one is: `BASE : POINT`; none of a base that a machine carries."""
    if not isinstance(one, Mapping) or not isinstance(other, Mapping) or UNIT in {**one, **other}:
        raise TypeError
    product = matrix_of(one, "the left side of ':'") @ matrix_of(other, "its right side")
    return {**other, **frame_of(product)}


def quotient(one: float, other: float) -> float:
    """A quotient; that of two integers is one too."""
    whole = isinstance(one, int) and isinstance(other, int)
    return math.trunc(one / other) if whole else one / other


def as_integer(value: Any) -> Any:
    """A value as an INT takes it: the nearest whole number, of two the greater."""
    return math.floor(value + 0.5) if is_number(value) else value


def as_real(value: Any) -> Any:
    """A value as a REAL takes it."""
    return float(value) if is_number(value) else value


def why(value: object) -> str:
    """Why a value is not known, or that it does not fit."""
    return value.why if isinstance(value, Unknown) else f"{value!r:.40} is given"
