"""PCD, the files of the Point Cloud Library: ascii, binary and binary_compressed, to the points that they hold.

Own code: pypcd4 reads a file that is cut off between two points as the points before, and takes a text file of any
number of rows. Every count of the header is held against the others and against the bytes before room is taken.
Fields beside x, y and z are passed over. Not for: what the points are for (`formats`).
Source: the PCD file format, versions .5 to .7, of the Point Cloud Library's documentation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import (
    BadShape,
    BadSyntax,
    DuplicateName,
    MissingKey,
    UnknownKey,
    nearest_name,
)
from clearance.formats.cloud.formats import Points
from clearance.formats.mesh.triangles import as_points
from clearance.formats.text.numbers import floats, integers

_KEYS = (
    "VERSION",
    "FIELDS",
    "SIZE",
    "TYPE",
    "COUNT",
    "WIDTH",
    "HEIGHT",
    "VIEWPOINT",
    "POINTS",
    "DATA",
)
_KINDS = {
    "F4": "<f4", "F8": "<f8", "U1": "<u1", "U2": "<u2", "U4": "<u4", "U8": "<u8",
    "I1": "<i1", "I2": "<i2", "I4": "<i4", "I8": "<i8",
}  # fmt: skip
_VERSIONS = ("0.7", ".7", "0.6", ".6", "0.5", ".5")
_AT_THE_SENSOR = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]

LONGEST_HEADER = 1 << 16
"""Bytes in which a header ends."""


class _Field(NamedTuple):
    """A field of each point: `n` numbers of a kind, after `column` other numbers that have `offset` bytes."""

    name: str
    kind: np.dtype
    n: int
    column: int
    offset: int

    @property
    def n_bytes(self) -> int:
        return self.kind.itemsize * self.n


def read_pcd(data: bytes) -> Points:
    """The points of a PCD file, those that are not finite too.

    Raises:
        BadSyntax, BadShape, MissingKey, UnknownKey, DuplicateName: not PCD, cut off, or longer than it says.
    """
    header, body = _header(data)
    n_points = _n_points(header)
    fields = _fields(header)
    chosen = [_coordinate(fields, name) for name in "xyz"]
    form = " ".join(header["DATA"])
    readers = {"ascii": _of_text, "binary": _of_rows, "binary_compressed": _of_columns}
    if form not in readers:
        raise BadSyntax(f"DATA is {form!r:.40}", valid=", ".join(readers))
    points = readers[form](body, n_points, fields, chosen)
    return Points(points, _notes(header))


def _header(data: bytes) -> tuple[dict[str, list[str]], bytes]:
    """The words of each line of the header by its key, and what follows it."""
    found: dict[str, list[str]] = {}
    place = 0
    while "DATA" not in found:
        end = data.find(b"\n", place, LONGEST_HEADER)
        if end < 0:
            raise BadSyntax("not a PCD file that can be read", valid="a header that ends with DATA")
        words = data[place:end].decode("utf-8", errors="replace").split()
        place = end + 1
        if not words or words[0].startswith("#"):
            continue
        key = "FIELDS" if words[0] == "COLUMNS" else words[0]
        if key not in _KEYS:
            raise UnknownKey(
                f"the header has the line {words[0]!r:.40}", valid=nearest_name(key, _KEYS)
            )
        if key in found:
            raise DuplicateName(f"the header has {key} twice", valid="each line once")
        found[key] = words[1:]
    missing = [key for key in ("FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT") if key not in found]
    if missing:
        raise MissingKey(f"the header has no {missing[0]}", valid=f"lines {', '.join(_KEYS)}")
    version = found.get("VERSION", ["0.7"])
    if len(version) != 1 or version[0] not in _VERSIONS:
        raise BadSyntax(f"the version is {' '.join(version)!r:.40}", valid="0.7")
    return found, data[place:]


def _n_points(header: dict[str, list[str]]) -> int:
    width, height = (_counts(header[key], key, 1)[0] for key in ("WIDTH", "HEIGHT"))
    n_points = width * height
    if "POINTS" in header:
        (n_points,) = _counts(header["POINTS"], "POINTS", 1)
    if n_points != width * height:
        raise BadShape(f"POINTS is {n_points}", valid=f"WIDTH times HEIGHT, {width * height}")
    return n_points


def _counts(words: Sequence[str], key: str, n: int) -> list[int]:
    """`n` whole numbers from 0 on."""
    numbers = [int(number) for number in integers(words)] if words else []
    if len(numbers) != n or min(numbers) < 0:
        raise BadShape(f"{key} is {' '.join(words)!r:.60}", valid=f"{n} whole numbers, 0 or more")
    return numbers


def _fields(header: dict[str, list[str]]) -> list[_Field]:
    names = header["FIELDS"]
    if not names:
        raise BadShape("FIELDS names no field", valid="FIELDS x y z")
    sizes = _counts(header["SIZE"], "SIZE", len(names))
    counts = (
        _counts(header["COUNT"], "COUNT", len(names)) if "COUNT" in header else [1] * len(names)
    )
    types = header["TYPE"]
    if len(types) != len(names):
        raise BadShape(f"TYPE is {' '.join(types)!r:.60}", valid=f"{len(names)} letters")
    fields: list[_Field] = []
    column = offset = 0
    for name, letter, size, count in zip(names, types, sizes, counts, strict=True):
        kind = _KINDS.get(f"{letter}{size}")
        if kind is None:
            raise BadSyntax(
                f"field {name!r:.40} has TYPE {letter!r:.10} and SIZE {size}",
                valid=", ".join(_KINDS),
            )
        fields.append(_Field(name, np.dtype(kind), count, column, offset))
        column, offset = column + count, offset + fields[-1].n_bytes
    return fields


def _coordinate(fields: Sequence[_Field], name: str) -> _Field:
    own = [field for field in fields if field.name == name]
    if len(own) != 1 or own[0].n != 1:
        raise MissingKey(f"there is no one field {name!r}", valid="FIELDS x y z, each with COUNT 1")
    return own[0]


def _of_text(
    body: bytes, n_points: int, fields: Sequence[_Field], chosen: Sequence[_Field]
) -> np.ndarray:
    n_columns = sum(field.n for field in fields)
    if 2 * n_points * n_columns > len(body) + 1:
        raise BadSyntax(f"{n_points} points do not fit in the file: it is cut off")
    rows = [row for line in body.splitlines() if (row := line.split())]
    if len(rows) != n_points:
        raise BadSyntax(f"{len(rows)} of {n_points} rows are there", valid="as many as POINTS says")
    for i, row in enumerate(rows):
        if len(row) != n_columns:
            raise BadSyntax(f"point {i} has {len(row)} numbers", valid=f"{n_columns}")
    return np.stack([floats([row[field.column] for row in rows]) for field in chosen], axis=1)


def _of_rows(
    body: bytes, n_points: int, fields: Sequence[_Field], chosen: Sequence[_Field]
) -> np.ndarray:
    n_bytes = sum(field.n_bytes for field in fields)
    _require_length(body, n_points * n_bytes)
    if not n_points:
        return np.empty((0, 3))
    rows = np.frombuffer(body, np.uint8, n_points * n_bytes).reshape(n_points, n_bytes)
    columns = [rows[:, field.offset : field.offset + field.n_bytes] for field in chosen]
    with np.errstate(invalid="ignore"):  # of a signalling NaN, which becomes one that is quiet
        return as_points(
            [
                np.ascontiguousarray(column).view(field.kind)[:, 0]
                for column, field in zip(columns, chosen, strict=True)
            ]
        )


def _of_columns(
    body: bytes, n_points: int, fields: Sequence[_Field], chosen: Sequence[_Field]
) -> np.ndarray:
    if len(body) < 8:
        raise BadSyntax("the file ends before its compressed points: it is cut off")
    n_compressed, n_bytes = (int(number) for number in np.frombuffer(body, "<u4", 2))
    wanted = n_points * sum(field.n_bytes for field in fields)
    if n_bytes != wanted:
        raise BadShape(f"{n_bytes} bytes are compressed", valid=f"{wanted} for {n_points} points")
    _require_length(body[8:], n_compressed)
    columns = decompressed(body[8 : 8 + n_compressed], n_bytes)
    return as_points(
        [np.frombuffer(columns, field.kind, n_points, field.offset * n_points) for field in chosen]
    )


def _require_length(body: bytes, n_bytes: int) -> None:
    """Nothing, if a body is so long; zeros may follow, as where a file fills a page of memory."""
    if len(body) < n_bytes:
        raise BadSyntax(f"{len(body)} of {n_bytes} bytes are there: the file is cut off")
    if body[n_bytes:].strip(b" \t\r\n\0"):
        raise BadSyntax(f"the file has {len(body) - n_bytes} bytes more than its header says")


def _notes(header: dict[str, list[str]]) -> tuple[str, ...]:
    given = header.get("VIEWPOINT", [])
    if not given or floats(given).tolist() == _AT_THE_SENSOR:
        return ()
    return ("its VIEWPOINT, where the sensor stood, is not applied: points are taken as written",)


MOST_TIMES = 264
"""A copy of three bytes makes so many at most."""

_LITERALS = 32


def decompressed(data: bytes, n_bytes: int) -> bytes:
    """The `n_bytes` that `data` stands for.

    Raises:
        BadSyntax: it stands for another number of bytes, ends within a run, or copies what is not there.
    """
    if n_bytes > MOST_TIMES * len(data):
        raise _damaged("it is too short")
    made = bytearray()
    place, end = 0, len(data)
    while place < end:
        control = data[place]
        place += 1
        if control < _LITERALS:
            made += data[place : place + control + 1]
            place += control + 1
            if place > end:
                raise _damaged("it ends within a run")
        else:
            place = _copied(data, place, control, made)
        if len(made) > n_bytes:
            raise _damaged("it is longer than its header says")
    if len(made) != n_bytes:
        raise _damaged("it is cut off")
    return bytes(made)


def _copied(data: bytes, place: int, control: int, made: bytearray) -> int:
    """Adds a copy of what came before to `made`; the place in `data` after it."""
    length = control >> 5
    if length == 7 and place < len(data):
        length += data[place]
        place += 1
    if place >= len(data):
        raise _damaged("it ends within a copy")
    back = ((control & 31) << 8) + data[place] + 1
    length += 2
    if back > len(made):
        raise _damaged("it copies what is not there")
    part = bytes(made[len(made) - back : len(made) - back + length])
    made += (part * (length // len(part) + 1))[:length]  # a copy may run into itself
    return place + 1


def _damaged(why: str) -> BadSyntax:
    return BadSyntax(f"the compressed points cannot be read: {why}")
