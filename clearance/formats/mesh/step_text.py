"""What the text of a STEP file says of itself, before Open CASCADE makes anything of it.

Not for: facets (`step_file`).
"""

from __future__ import annotations

import re
from typing import NamedTuple

from clearance.errors import BadSyntax

MOST_BYTES = 200_000_000

_FACE = re.compile(rb"(?<![A-Z0-9_])(?:ADVANCED_FACE|FACE_SURFACE|FACE)\s*\(")

_UNREAD = {
    b"TRIANGULATED_FACE": "it holds facets whose distance from the surface is not known",
    b"COMPLEX_TRIANGULATED_FACE": "it holds facets whose distance from the surface is not known",
    b"CSG_SOLID": "it holds solids that are made of others by rule",
    b"BOOLEAN_RESULT": "it holds solids that are made of others by rule",
    b"SWEPT_AREA_SOLID": "it holds solids that are made of others by rule",
    b"EXTRUDED_AREA_SOLID": "it holds solids that are made of others by rule",
    b"REVOLVED_AREA_SOLID": "it holds solids that are made of others by rule",
    b"HALF_SPACE_SOLID": "it holds solids that are made of others by rule",
    b"DOCUMENT_FILE": "it names other files, which are not opened",
}
"""Entities that are read in part or elsewhere, and why they are refused."""

_PREFIXES = {
    b"$": 1.0, b".KILO.": 1e3, b".DECI.": 1e-1, b".CENTI.": 1e-2, b".MILLI.": 1e-3, b".MICRO.": 1e-6,
    b".NANO.": 1e-9,
}  # fmt: skip

_ACCURACY = re.compile(
    rb"UNCERTAINTY_MEASURE_WITH_UNIT\s*\(\s*LENGTH_MEASURE\s*\(\s*([^()\s]+)\s*\)\s*,\s*#(\d+)"
)
_METRE = re.compile(rb"SI_UNIT\s*\(\s*(\$|\.[A-Z]+\.)\s*,\s*\.METRE\.")
_CONVERSION = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'[^']*'\s*,\s*#(\d+)")
_LENGTH = re.compile(rb"LENGTH_MEASURE(?:_WITH_UNIT)?\s*\(\s*([^()\s,]+)\s*\)?\s*,\s*#(\d+)")
"""Open CASCADE 8 writes the number alone, others name its type: LENGTH_MEASURE(25.4)."""


class StepFacts(NamedTuple):
    """What a file says of itself.

    Attributes:
        n_faces: as many faces as it has. accuracy: [m] how far it says its surfaces may be apart where they meet.
    """

    n_faces: int
    accuracy: float


def step_facts(data: bytes) -> StepFacts:
    """The facts of a STEP file.

    Raises:
        BadSyntax: not STEP, cut off, too long, without faces, of a kind that is not read, or of unknown units.
    """
    if len(data) > MOST_BYTES:
        raise BadSyntax(f"{len(data)} bytes are given", valid=f"{MOST_BYTES} or fewer")
    text = data.strip()
    if not text.startswith(b"ISO-10303-21;"):
        raise BadSyntax("not a STEP file", valid="ISO-10303-21; at its beginning")
    if not text.endswith(b"END-ISO-10303-21;"):
        raise BadSyntax("the STEP file is cut off", valid="END-ISO-10303-21; at its end")
    plain = re.sub(rb"/\*.*?\*/", b" ", text, flags=re.DOTALL)
    for entity, why in _UNREAD.items():
        if re.search(rb"(?<![A-Z0-9_])" + entity + rb"\s*\(", plain):
            raise BadSyntax(
                f"{entity.decode()} is not read: {why}", valid="solids of faces, in one file"
            )
    n_faces = len(_FACE.findall(plain))
    if not n_faces:
        raise BadSyntax("the STEP file has no faces", valid="a solid, or a surface")
    return StepFacts(n_faces, _accuracy(plain))


def _accuracy(text: bytes) -> float:
    """[m] the largest accuracy that is stated; 0 where none is."""
    stated = [_number(value) * _metres(text, unit, 0) for value, unit in _ACCURACY.findall(text)]
    if any(not 0.0 <= value < 1.0 for value in stated):
        raise BadSyntax(f"its accuracy is {max(stated):g} m", valid="0 to 1 m")
    return max(stated, default=0.0)


def _metres(text: bytes, unit: bytes, depth: int) -> float:
    """[m] how long a unit is, by the number of its entity."""
    entity = re.search(rb"#" + unit + rb"\s*=([^;]*);", text)
    body = b"" if entity is None or depth > 5 else entity[1]
    if (si := _METRE.search(body)) and si[1] in _PREFIXES:
        return _PREFIXES[si[1]]
    if (of := _CONVERSION.search(body)) and (
        measure := re.search(rb"#" + of[1] + rb"\s*=([^;]*);", text)
    ):
        if length := _LENGTH.search(measure[1]):
            return _number(length[1]) * _metres(text, length[2], depth + 1)
    raise BadSyntax(
        f"#{unit.decode():.20} is no length unit that is known",
        valid="SI_UNIT or a conversion of it",
    )


def _number(text: bytes) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1e9:
        raise BadSyntax(
            f"{text.decode(errors='replace')!r:.40} is given as a length", valid="a number"
        )
    return value
