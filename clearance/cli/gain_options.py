"""What `clearance gain` takes from the command line: stretches of time, room for a shift, places.

Not for: what they are for (`gain`).
"""

from __future__ import annotations

import math
import re
from typing import Any

import click


class Stretch(click.ParamType):
    """A stretch of time, START:END."""

    name = "start:end"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Start and end [s]."""
        if isinstance(value, tuple):
            return value
        try:
            start, end = (float(part) for part in value.split(":"))
        except ValueError:
            start, end = math.nan, math.nan
        if not (math.isfinite(start) and math.isfinite(end) and start <= end):
            self.fail(
                f"{value!r} is no stretch of time; START:END in seconds, as 1.2:1.5", param, ctx
            )
        return start, end


class Pose(click.ParamType):
    """How far a tool may move and turn at a moment, TIME=Nmm,Ndeg; transfers on in seconds, metres and radians."""

    name = "time=mm,deg"
    _FORM = re.compile(r"([^=]+?)s?=([^,]+)mm,([^,]+)deg")

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float, float]:
        """Time [s], way [m] and angle [rad]."""
        if isinstance(value, tuple):
            return value
        form = self._FORM.fullmatch(value)
        try:
            time, far, turn = (float(part) for part in form.groups()) if form else (math.nan,) * 3
        except ValueError:
            time = far = turn = math.nan
        if not all(map(math.isfinite, (time, far, turn))):
            self.fail(
                f"{value!r} is no moment with a tolerance; TIME=Nmm,Ndeg, as 12.0=2mm,1deg",
                param,
                ctx,
            )
        return time, far / 1000.0, math.radians(turn)


class Room(click.ParamType):
    """How far a shift may go along x, y and z: N for either way or LOW:HIGH, in millimetres; transfers on in
    metres.
    """

    name = "x,y,z"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[tuple[float, float], ...]:
        """Three ranges [m]."""
        if isinstance(value, tuple):
            return value
        try:
            found = tuple(_range(part) for part in value.split(","))
        except ValueError:
            found = ()
        if len(found) != 3:
            self.fail(
                f"{value!r} is no room for a shift; X,Y,Z in millimetres, each N or LOW:HIGH, as 50,0:100,0",
                param,
                ctx,
            )
        return found


def _range(text: str) -> tuple[float, float]:
    """A range [m]; a ValueError for what is none."""
    ends = [float(part) / 1000.0 for part in text.split(":")]
    if len(ends) == 1 and ends[0] >= 0.0:
        ends = [-ends[0], ends[0]]
    low, high = ends
    if not (math.isfinite(low) and math.isfinite(high) and low <= high):
        raise ValueError(text)
    return low, high


class Place(click.ParamType):
    """A point X,Y,Z in millimetres; transfers on in metres."""

    name = "x,y,z"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """x, y, z [m]."""
        if isinstance(value, tuple):
            return value
        try:
            found = tuple(float(part) / 1000.0 for part in value.split(","))
        except ValueError:
            found = ()
        if len(found) != 3 or not all(map(math.isfinite, found)):
            self.fail(f"{value!r} is no point; X,Y,Z in millimetres", param, ctx)
        return found
