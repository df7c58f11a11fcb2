"""The elements of a PLY file: its header, and rows of numbers and lists as it says, in text or binary.

Counts are held against the file's length before anything is made. Not for: what the elements mean (`ply_file`).
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax, DuplicateName, at
from clearance.formats.mesh.ply_binary import BinaryRows
from clearance.formats.mesh.ply_rows import Element, PlyRows, Property
from clearance.formats.mesh.ply_text import TextRows
from clearance.formats.text.numbers import integers

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip

_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}


def elements_of(data: bytes) -> dict[str, PlyRows]:
    """All elements of a PLY file, by name.

    Raises:
        BadSyntax: not PLY, cut off, or longer than its header says. DuplicateName: two of one name.
    """
    order, elements, body = _header(data)
    reader = TextRows(body) if order == "=" else BinaryRows(body)
    found = {}
    for element in elements:
        with at(f"element {element.name!r:.40}"):
            found[element.name] = reader.rows(element)
    reader.refuse_rest()
    return found


def _header(data: bytes) -> tuple[str, list[Element], bytes]:
    newline = b"\r\n" if data[3:5] == b"\r\n" else data[3:4]
    head, end, body = data.partition(newline + b"end_header" + newline)
    if data[:3] != b"ply" or newline not in (b"\n", b"\r", b"\r\n") or not end:
        raise _not_ply()
    lines = head.decode("utf-8", errors="replace").split(newline.decode("ascii"))
    words = [line.split() for line in lines]
    if (
        len(words) < 2
        or words[1][:1] != ["format"]
        or words[1][1:2] == []
        or words[1][1] not in _ORDERS
    ):
        raise _not_ply()
    order = _ORDERS[words[1][1]]
    elements: list[Element] = []
    for row in words[2:]:
        _take_line(row, elements, order)
    names = [element.name for element in elements]
    if len(set(names)) < len(names):
        raise DuplicateName("two elements of the PLY file have one name", valid="each name once")
    return order, elements, body


def _not_ply() -> BadSyntax:
    return BadSyntax(
        "not a PLY file that can be read", valid="ply, format ascii or binary, …, end_header"
    )


def _take_line(row: list[str], elements: list[Element], order: str) -> None:
    if not row or row[0] in ("comment", "obj_info"):
        return
    if row[0] == "element" and len(row) == 3:
        elements.append(Element(row[1], int(integers([row[2]])[0]), []))
        if elements[-1].n_rows >= 0:
            return
    elif row[0] == "property" and elements and len(row) == (5 if row[1:2] == ["list"] else 3):
        made = _property(row, order)
        if made is not None:
            if any(made.name == other.name for other in elements[-1].properties):
                raise DuplicateName(
                    f"property {made.name!r:.40} is there twice", valid="each name once"
                )
            elements[-1].properties.append(made)
            return
    raise BadSyntax(
        f"the PLY header has the line {' '.join(row)!r:.60}", valid="element or property"
    )


def _property(row: list[str], order: str) -> Property | None:
    words = row[2:4] if row[1] == "list" else row[1:2]
    if any(word not in _TYPES for word in words):
        return None
    made = [np.dtype(order + _TYPES[word]) for word in words]
    if len(made) == 1:
        return Property(row[-1], made[0], None)
    return Property(row[-1], made[1], made[0]) if made[0].kind in "iu" else None
