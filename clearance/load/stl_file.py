"""STL, binary and text, to triangles. Strict: a file whose length or facets do not add up is
refused.

Own code, because the usual readers keep what is left of a cut-off text file without a word, and
because the binary format is one numpy type: 50,000 triangles in a few milliseconds (NOTES.md).
"""

from __future__ import annotations

import re

import numpy as np

from clearance.errors import BadSyntax
from clearance.load.triangles import Triangles

_HEADER_BYTES = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_SOLID_LINE = re.compile(rb"^[ \t]*(end)?solid\b.*$", re.IGNORECASE | re.MULTILINE)
_LOOP = re.compile(rb"outer\s+loop(.*?)endloop", re.IGNORECASE | re.DOTALL)


def read_stl(data: bytes) -> Triangles:
    """The triangles of an STL file, values as stored (single precision in binary files).

    Raises:
        BadSyntax: cut off, or not STL.
    """
    if len(data) >= _HEADER_BYTES:
        n_facets = int(np.frombuffer(data, "<u4", count=1, offset=_HEADER_BYTES - 4)[0])
        if len(data) == _HEADER_BYTES + n_facets * _FACET.itemsize:
            return _binary(data, n_facets)
    if data.lstrip()[:5].lower() == b"solid" and (b"facet" in data.lower() or len(data) < 1000):
        return _text(data)
    raise BadSyntax(
        f"not an STL file: {len(data)} bytes",
        valid="84 + 50 bytes for each triangle of its header, or 'solid' … 'endsolid'",
    )


def _binary(data: bytes, n_facets: int) -> Triangles:
    facets = np.frombuffer(data, _FACET, count=n_facets, offset=_HEADER_BYTES)
    vertices = facets["corners"].reshape(-1, 3).astype(np.float64)
    return Triangles(vertices, np.arange(3 * n_facets).reshape(-1, 3))


def _text(data: bytes) -> Triangles:
    n_solids = len(re.findall(rb"^[ \t]*solid\b", data, re.IGNORECASE | re.MULTILINE))
    if n_solids != len(re.findall(rb"^[ \t]*endsolid\b", data, re.IGNORECASE | re.MULTILINE)):
        raise BadSyntax("the text STL file is cut off", valid="every 'solid' ends with 'endsolid'")
    body = _SOLID_LINE.sub(b"", data)
    loops = _LOOP.findall(body)
    if len(loops) != len(re.findall(rb"\bfacet\s+normal\b", body, re.IGNORECASE)):
        raise BadSyntax("a facet of the text STL file has no closed outer loop")
    words = b" ".join(loops).split()
    try:
        if len(words) != 12 * len(loops) or any(w.lower() != b"vertex" for w in words[::4]):
            raise ValueError
        rows = np.array(words).reshape(-1, 4)[:, 1:].astype(np.float64)
    except ValueError:
        raise BadSyntax(
            "a facet of the text STL file is not three vertices of three numbers"
        ) from None
    return Triangles(rows, np.arange(len(rows)).reshape(-1, 3))
