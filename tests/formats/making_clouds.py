"""Files of points, made after the formats' descriptions and by no reader or writer of the package."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

XYZ = (("x", "F", 4, 1), ("y", "F", 4, 1), ("z", "F", 4, 1))
"""Fields of a PCD file: name, type, size, count."""

KINDS = {("F", 4): "<f4", ("F", 8): "<f8", ("U", 1): "<u1", ("U", 4): "<u4", ("I", 2): "<i2"}


def pcd(
    points: np.ndarray,
    form: str = "binary",
    fields: Sequence = XYZ,
    more: Sequence[str] = (),
    **other: object,
) -> bytes:
    """A PCD file of points (n, 3); fields beside x, y and z are all 7.

    Args:
        more: further lines of the header. other: what stands in a line of the header instead, by its key.
    """
    n = len(points)
    lines = {
        "VERSION": "0.7",
        "FIELDS": " ".join(f[0] for f in fields),
        "SIZE": " ".join(str(f[2]) for f in fields),
        "TYPE": " ".join(f[1] for f in fields),
        "COUNT": " ".join(str(f[3]) for f in fields),
        "WIDTH": n, "HEIGHT": 1, "VIEWPOINT": "0 0 0 1 0 0 0", "POINTS": n, "DATA": form,
    }  # fmt: skip
    lines |= other
    header = "# .PCD v0.7 - Point Cloud Data file format\n"
    header += "".join(f"{line}\n" for line in more)
    header += "".join(f"{key} {value}\n" for key, value in lines.items() if value is not None)
    return header.encode() + _body(points, form, fields)


def _body(points: np.ndarray, form: str, fields: Sequence) -> bytes:
    columns = []
    for name, letter, size, count in fields:
        values = points[:, "xyz".index(name)] if name in "xyz" else np.full(len(points), 7)
        columns.append(np.repeat(values.astype(KINDS[letter, size])[:, None], count, axis=1))
    if form == "ascii":
        rows = [
            " ".join(repr(x) for column in columns for x in column[i].tolist())
            for i in range(len(points))
        ]
        return "".join(f"{row}\n" for row in rows).encode()
    if form == "binary":
        return b"".join(
            b"".join(column[i].tobytes() for column in columns) for i in range(len(points))
        )
    flat = b"".join(column.tobytes() for column in columns)
    packed = lzf(flat)
    return struct.pack("<II", len(packed), len(flat)) + packed


def lzf(data: bytes) -> bytes:
    """`data` compressed: copies of three bytes and more, wherever they came before within reach, else runs."""
    made, literals, place = bytearray(), bytearray(), 0
    seen: dict[bytes, int] = {}
    while place < len(data):
        start = seen.get(data[place : place + 3])
        seen[data[place : place + 3]] = place
        if start is None or place - start > 8192 or place + 3 > len(data):
            literals.append(data[place])
            place += 1
            continue
        length = 3
        while (
            length < 264
            and place + length < len(data)
            and data[start + length] == data[place + length]
        ):
            length += 1
        made += _runs(literals)
        literals.clear()
        back, n = place - start - 1, length - 2
        made += (
            bytes([(min(n, 7) << 5) | back >> 8])
            + (bytes([n - 7]) if n >= 7 else b"")
            + bytes([back & 255])
        )
        place += length
    return bytes(made + _runs(literals))


def _runs(literals: bytearray) -> bytes:
    return b"".join(
        bytes([len(part) - 1]) + part
        for part in (bytes(literals[i : i + 32]) for i in range(0, len(literals), 32))
    )


def ply(points: np.ndarray, form: str = "binary_little_endian", faces: Sequence = ()) -> bytes:
    """A PLY file of vertices (n, 3) with a colour each, and perhaps faces."""
    header = f"ply\nformat {form} 1.0\ncomment a scan\nelement vertex {len(points)}\n"
    header += "".join(f"property float {name}\n" for name in "xyz") + "property uchar red\n"
    if faces:
        header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\n"
    header += "end_header\n"
    if form == "ascii":
        rows = [f"{x!r} {y!r} {z!r} 9\n" for x, y, z in points.astype(np.float32).tolist()]
        rows += [f"{len(face)} {' '.join(map(str, face))}\n" for face in faces]
        return (header + "".join(rows)).encode()
    order = "<" if form == "binary_little_endian" else ">"
    body = b"".join(struct.pack(f"{order}3fB", *row, 9) for row in points.tolist())
    body += b"".join(struct.pack(f"{order}B{len(face)}i", len(face), *face) for face in faces)
    return header.encode() + body


def table(points: np.ndarray, delimiter: str = ",", header: str = "x,y,z") -> bytes:
    """A table of points, with a header unless that is empty."""
    rows = [delimiter.join(repr(x) for x in row) for row in points.tolist()]
    return "\n".join([header, *rows] if header else rows).encode() + b"\n"
