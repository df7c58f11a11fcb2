"""The unit that a column of a trajectory table names: `elbow [deg]`, `elbow (deg)`, `elbow_deg`, `time [ms]`.

A name that a joint of the robot has is that joint's, whatever it ends in. Not for: guessing units, which
`world.plausible_motion` does, as a question.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput, DuplicateName, MissingKey, nearest_name
from clearance.formats.table.csv_table import EMPTY, TIME
from clearance.world.notice import listed, naming

POSITION, VELOCITY = "/position", "/velocity"
"""How ros2_control names its interfaces; a joint's position needs no ending."""


class Unit(NamedTuple):
    """A unit of a column.

    Attributes:
        of: "angle", "length" or "time". word: it, in notes; nothing for those of this package.
    """

    of: str
    word: str = ""


UNITS = {
    "rad": Unit("angle"),
    "deg": Unit("angle", "degrees"),
    "m": Unit("length"),
    "mm": Unit("length", "millimetres"),
    "s": Unit("time"),
    "ms": Unit("time", "milliseconds"),
    "us": Unit("time", "microseconds"),
    "ns": Unit("time", "nanoseconds"),
}
"""By how they are written; velocities are in one of them a second."""

_PARTS = {"mm": 1e3, "ms": 1e3, "us": 1e6, "ns": 1e9}
"""How many of a unit are a metre or a second."""

_TIMES = (TIME, "t", "timestamp")
"""What programs call the column of times, in small letters."""

_A = {"angle": "an angle", "length": "a length", "time": "a time"}

_BRACKETS = re.compile(
    r"(.*\S)\s*(?:\[(rad|deg|mm?|[mun]?s)(/s)?\]|\((rad|deg|mm?|[mun]?s)(/s)?\))"
)
_ENDING = re.compile(r"(.+)_(rad|deg|mm?|[mun]?s)")


class Column(NamedTuple):
    """A column: its name in the header, what it is of, and in which unit; none where it names none.

    Attributes:
        name: `time`, a joint, or a joint and `/velocity`.
    """

    header: str
    name: str
    unit: str | None = None


def columns_in(
    header: Sequence[str], turns: Mapping[str, bool], units: tuple[str, str] | None
) -> list[Column]:
    """What the columns are; those that name no unit are in that of `units` for their kind of joint.

    Args:
        turns: of each joint of the robot, whether it turns; empty where that is not known.

    Raises:
        BadInput: a unit that the joint cannot have, or one of only a position or its velocity. DuplicateName: two
            columns of one thing.
    """
    columns = [_column(name, turns) for name in header if name != EMPTY]
    by_name: dict[str, Column] = {}
    for column in columns:
        if column.name in by_name:
            raise DuplicateName(f"column {column.name!r} is there twice", valid="each column once")
        by_name[column.name] = column
    for column in columns:
        _refuse_other_kind(column, turns)
        moving = by_name.get(column.name + VELOCITY)
        if moving is not None and (column.unit is None) != (moving.unit is None):
            raise BadInput(
                f"one of the columns {column.header!r} and {moving.header!r} names a unit",
                valid="units of both, or of none",
            )
    return [_with_default(column, turns, units) for column in columns]


def with_time(columns: Sequence[Column], turns: Mapping[str, bool]) -> list[Column]:
    """The columns; where none is `time`, that which other programs call so, as `Time`, `t` or `timestamp`.

    Raises:
        MissingKey: several could be. BadInput: its unit is none of a time.
    """
    if any(column.name == TIME for column in columns):
        return list(columns)
    found = [one for one in columns if one.name.lower() in _TIMES and one.name not in turns]
    if len(found) > 1:
        names = listed([repr(one.header) for one in found])
        raise MissingKey(
            f"there is no column {TIME!r}, and {names} could each be it",
            valid=f"did you mean {found[0].header!r}? columns: {{{TIME}: {found[0].header}, …}}",
        )
    named = [one._replace(name=TIME) if one in found else one for one in columns]
    for one in named:
        _refuse_other_kind(one, turns)
    return named


def in_kind(
    header: str, name: str, turns: Mapping[str, bool], units: tuple[str, str] | None
) -> Column:
    """A column that is called otherwise than in its header; in the unit that the header ends in, if the joint, or
    time, can have it.

    Raises:
        BadInput: a unit in brackets that the joint cannot have.
    """
    column = Column(header, name)
    bracketed, ending = _BRACKETS.fullmatch(header), _ENDING.fullmatch(header)
    if bracketed:
        column = Column(header, name, bracketed[2] or bracketed[4])
    elif ending and UNITS[ending[2]].of == _kind(name, turns):
        column = Column(header, name, ending[2])
    _refuse_other_kind(column, turns)
    return _with_default(column, turns, units)


def in_own_units(values: np.ndarray, columns: Sequence[Column]) -> None:
    """Turns (n, k) values of k columns into rad, metres and seconds, in place.

    Exactness: a quotient by a power of ten is rounded once; degrees are within 2^-52 of their value.
    """
    for i, column in enumerate(columns):
        if column.unit == "deg":
            values[:, i] *= math.pi / 180.0
        elif column.unit in _PARTS:
            values[:, i] /= _PARTS[column.unit]


def odd_degrees(angles: np.ndarray) -> tuple[str, ...]:
    """A line where angles (n, k) [rad] that were read in degrees are those that a table in radians has.

    Args:
        angles: of the columns in degrees.
    """
    if angles.shape[1] < 2 or not len(angles) or not np.ptp(angles, axis=0).any():
        return ()
    if np.abs(angles).max() > math.radians(2.0 * math.pi):
        return ()
    return (
        "all angles are within 6.28 degrees of 0: is the table in radians, and no unit to be given?",
    )


def note_on_units(columns: Sequence[Column]) -> list[str]:
    """A line that says which columns are in which other unit."""
    parts = []
    for key, unit in UNITS.items():
        names = [repr(column.name) for column in columns if column.unit == key]
        if unit.word and names:
            parts.append(f"in {unit.word}: {listed(names, 8)}")
    return [f"read {'; '.join(parts)}"] if parts else []


def note_on_endings(columns: Sequence[Column], turns: Mapping[str, bool]) -> list[str]:
    """A line on columns that end as if in another unit and are read as rad or m, as no robot has such a joint."""
    found = []
    for column in columns:
        ending = _ENDING.fullmatch(column.name)
        if ending and UNITS[ending[2]].word and column.name not in turns and column.name != TIME:
            found.append(repr(column.name))
    if not found:
        return []
    valid = "write `joint [deg]` or `joint [mm]` if another is meant"
    return [f"read in rad or m, whatever the name ends in: {listed(found, 8)}; {valid}"]


def _column(header: str, turns: Mapping[str, bool]) -> Column:
    if header in turns:
        return Column(header, header)
    found = _BRACKETS.fullmatch(header)
    if found:
        name, unit, a_second = found[1], found[2] or found[4], found[3] or found[5]
        if bool(a_second) == name.endswith(VELOCITY):
            return Column(header, name.removesuffix(POSITION), unit)
    found = _ENDING.fullmatch(header)
    is_time = found and found[1].lower() in _TIMES and UNITS[found[2]].of == "time"
    if found and (found[1] in turns or found[1] == TIME or is_time):
        return Column(header, found[1], found[2])
    return Column(header, header.removesuffix(POSITION))


def _refuse_other_kind(column: Column, turns: Mapping[str, bool]) -> None:
    kind = _kind(column.name, turns)
    if column.unit is None or kind is None or UNITS[column.unit].of == kind:
        return
    valid = [unit for unit, about in UNITS.items() if about.of == kind]
    raise BadInput(
        f"column {column.header!r} is {_A[kind]}, not in {column.unit}", valid=" or ".join(valid)
    )


def _kind(name: str, turns: Mapping[str, bool]) -> str | None:
    if name == TIME:
        return "time"
    turning = turns.get(name.removesuffix(VELOCITY))
    return None if turning is None else "angle" if turning else "length"


def _with_default(
    column: Column, turns: Mapping[str, bool], units: tuple[str, str] | None
) -> Column:
    kind = _kind(column.name, turns)
    if column.unit is not None or units is None or kind in (None, "time"):
        return column
    return column._replace(unit=units[0] if kind == "angle" else units[1])


def chosen_columns(
    header: Sequence[str],
    chosen: Mapping[str, str],
    turns: Mapping[str, bool],
    units: tuple[str, str] | None,
) -> list[Column]:
    """The columns of a header that a case names, with the case's names, in its order.

    Args:
        chosen: the column of the header for `time`, a joint, or a joint and `/velocity`; one that stands for
            itself is what its header says. turns, units: as `columns_in`.

    Raises:
        MissingKey: a column that is not in the header. DuplicateName: one that is given twice. BadInput: one that
            is called as another joint, or as `columns_in`.
    """
    for name, given in chosen.items():
        _require_own(name, given, header, turns)
        if list(chosen.values()).count(given) > 1:
            raise DuplicateName(f"`columns` gives {given!r} twice", valid="each column once")
    own = [name for name, given in chosen.items() if name == given]
    found = {one.header: one for one in with_time(columns_in(own, turns, units), turns)}
    for name, given in chosen.items():
        if name != given:
            found[name] = in_kind(given, name, turns, units)
    return [found[name] for name in chosen]


def _require_own(name: str, given: str, header: Sequence[str], turns: Mapping[str, bool]) -> None:
    """Nothing, if there is such a column, which is not called as another joint of the robot."""
    if given not in header:
        raise MissingKey(
            f"there is no column {given!r}, which `columns` names",
            valid=nearest_name(given, header),
        )
    owner = given.removesuffix(VELOCITY).removesuffix(POSITION)
    if owner in turns and owner != name.removesuffix(VELOCITY):
        raise BadInput(
            f"`columns` gives {given!r}, which has the name of joint {owner!r}, to {name!r}",
            valid="each joint its own column; one that is called wrongly is renamed in the table",
        )


def notes_on_names(header: Sequence[str], columns: Sequence[Column]) -> list[str]:
    """Notes on the column read as time, and on columns that are not read."""
    notes = [
        f"column {one.header!r} is taken for time"
        for one in columns
        if one.name == TIME and not re.match(r"time\b|time_", one.header.lower())
    ]
    used = {one.header for one in columns}
    unread = [repr(name) for name in header if name not in used and name != EMPTY]
    notes += naming("columns not read", unread, 8)
    notes += ["the empty column at the end is left out"] if EMPTY in header else []
    return notes
