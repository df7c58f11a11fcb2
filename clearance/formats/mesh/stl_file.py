"""STL, binary and text, to triangles. Strict: a file whose length or facets do not add up is
refused.

Own code, because the usual readers keep what is left of a cut-off text file without a word, and
because the binary format is one numpy type: 50,000 triangles in a few milliseconds (NOTES.md).
"""

from __future__ import annotations

import re

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.mesh.triangles import MeshRequest, Triangles
from clearance.formats.text.numbers import floats

_HEADER_BYTES = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_SOLID_LINE = re.compile(rb"^[ \t]*(end)?solid\b.*$", re.IGNORECASE | re.MULTILINE)
_FACET_WORDS = (
    b"facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet".split()
)
_KEYWORDS = [i for i, word in enumerate(_FACET_WORDS) if word != b"0"]
_COORDINATES = [8, 9, 10, 12, 13, 14, 16, 17, 18]


def read_stl(asked: MeshRequest) -> Triangles:
    """The triangles of an STL file, values as stored (single precision in binary files).

    Raises:
        BadSyntax: cut off, or not STL.
    """
    data = asked.data
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
    vertices = facets["corners"].reshape(-1, 3)
    return Triangles(vertices, np.arange(3 * n_facets).reshape(-1, 3))


def _text(data: bytes) -> Triangles:
    data = data.replace(b"\r", b"\n")
    n_solids = len(re.findall(rb"^[ \t]*solid\b", data, re.IGNORECASE | re.MULTILINE))
    if n_solids != len(re.findall(rb"^[ \t]*endsolid\b", data, re.IGNORECASE | re.MULTILINE)):
        raise BadSyntax("the text STL file is cut off", valid="every 'solid' ends with 'endsolid'")
    words = _SOLID_LINE.sub(b"", data).split()
    if len(words) % len(_FACET_WORDS):
        raise _bad_facet(words)
    rows = [words[i :: len(_FACET_WORDS)] for i in range(len(_FACET_WORDS))]
    if any(word.lower() != _FACET_WORDS[i] for i in _KEYWORDS for word in rows[i]):
        raise _bad_facet(words)
    try:
        columns = [floats(rows[i]) for i in _COORDINATES]
    except BadSyntax as error:
        raise BadSyntax(
            f"a facet is not three vertices of three numbers: {error.problem}"
        ) from None
    return Triangles(
        np.stack(columns, axis=1).reshape(-1, 3), np.arange(3 * len(rows[0])).reshape(-1, 3)
    )


def _bad_facet(words: list[bytes]) -> BadSyntax:
    """What is wrong with the first facet that is not as facets are."""
    size = len(_FACET_WORDS)
    for i in range(0, len(words), size):
        facet = [word.lower() for word in words[i : i + size]]
        wrong = [k for k in _KEYWORDS if facet[k : k + 1] != [_FACET_WORDS[k]]]
        if not wrong:
            continue
        given = (
            facet[wrong[0]].decode("utf-8", errors="replace")
            if wrong[0] < len(facet)
            else "nothing"
        )
        return BadSyntax(
            f"facet {i // size} of the text STL file has {given!r:.40} where "
            f"{_FACET_WORDS[wrong[0]].decode()!r} is due",
            valid="a normal and a closed outer loop of three vertices of three numbers",
        )
    return BadSyntax("the text STL file is no list of facets")
