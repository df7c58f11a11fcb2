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
    b"CARTESIAN_TRANSFORMATION_OPERATOR_3D": "Open CASCADE scales, mirrors and places by it wrongly",
    b"DOCUMENT_FILE": "it names other files, which are not opened",
}
"""Entities that are read in part, wrongly or elsewhere, and why they are refused."""

_STRING_OR_COMMENT = re.compile(rb"(?:'[^']*')+|/\*.*?\*/", re.DOTALL)

_ITEMS = re.compile(
    rb"SHAPE_REPRESENTATION\s*\(\s*(?:''|\$)\s*,\s*\(([^()]*)\)"
    rb"|REPRESENTATION\s*\(\s*(?:''|\$)\s*,\s*\(([^()]*)\)[^;]*SHAPE_REPRESENTATION\s*\(\s*\)"
)
_MEMBERS = re.compile(rb"(?<![A-Z0-9_])GEOMETRIC_SET\s*\(\s*(?:(?:''|\$)\s*,\s*)?\(([^()]*)\)")
_REFERENCE = re.compile(rb"#(\d+)")
_RECORD = re.compile(rb"#(\d+)\s*=\s*(?:([A-Z0-9_]+)|\(([^;]*))")
_NAME = re.compile(rb"([A-Z0-9_]+)\s*\(")

_BODY = re.compile(
    rb"MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|FACETED_BREP|(?:SHELL|FACE)_BASED_SURFACE_MODEL|ADVANCED_FACE"
    rb"|FACE_SURFACE|MAPPED_ITEM|GEOMETRIC_SET|TESSELLATED_(?:SOLID|SHELL)|(?:COMPLEX_)?TRIANGULATED_SURFACE_SET"
)
_SURFACE = re.compile(rb"RECTANGULAR_TRIMMED_SURFACE|CURVE_BOUNDED_SURFACE|B_SPLINE_SURFACE\w*")
_LINES = re.compile(
    rb"GEOMETRIC_CURVE_SET|(?:EDGE|SHELL)_BASED_WIREFRAME_MODEL|TESSELLATED_CURVE_SET"
)
_NO_SURFACE = re.compile(
    rb"(?:\w+_)?(?:CURVE|LINE|POLYLINE|CIRCLE|ELLIPSE|PARABOLA|HYPERBOLA|POINT|EDGE|LOOP|PATH|DIRECTION|VECTOR"
    rb"|PLACEMENT(?:_[23]D)?|CALLOUT|SYMBOL|OCCURRENCE)|B_SPLINE_CURVE\w*|CURVE_REPLICA|POINT_\w+|PLANE"
    rb"|(?:ANNOTATION|PLANAR|COMPOSITE_TEXT|TEXT_LITERAL|CAMERA)\w*|(?:MEASURE|VALUE|DESCRIPTIVE|QUALIFIED|INTEGER|REAL"
    rb"|BOOLEAN|COMPOUND)_REPRESENTATION_ITEM"
)
"""What Open CASCADE makes faces of, in a representation and in a set, and what has none. It leaves out others."""

_OCCURRENCE = re.compile(
    rb"#(\d+)\s*=\s*NEXT_ASSEMBLY_USAGE_OCCURRENCE\s*\([^#]*#(\d+)\s*,\s*#(\d+)"
)
_SHAPE_OF = re.compile(rb"#(\d+)\s*=\s*PRODUCT_DEFINITION_SHAPE\s*\([^#)]*#(\d+)")
_HAS_SHAPE = re.compile(
    rb"(?<![A-Z0-9_])SHAPE_DEFINITION_REPRESENTATION\s*\(\s*#(\d+)\s*,\s*#(\d+)"
)
_PLACES = re.compile(rb"#(\d+)\s*=\s*AXIS2_PLACEMENT_3D")
_HOLDS = re.compile(rb"#(\d+)\s*=\s*\w*SHAPE_REPRESENTATION\s*\(\s*(?:''|\$)\s*,\s*\(([^()]*)\)")
_SAME = re.compile(rb"SHAPE_REPRESENTATION_RELATIONSHIP\s*\([^#()]*#(\d+)\s*,\s*#(\d+)")
_HAS_PLACE = re.compile(rb"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION\s*\(\s*#\d+\s*,\s*#(\d+)")

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
        n_lines: sets of curves, which have no surface.
        bare: what it calls the parts of an assembly that it has no shape of.
    """

    n_faces: int
    accuracy: float
    n_lines: int
    bare: tuple[str, ...] = ()


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
    plain = _STRING_OR_COMMENT.sub(lambda found: b"''" if found[0][:1] == b"'" else b" ", text)
    for entity, why in _UNREAD.items():
        if re.search(rb"(?<![A-Z0-9_])" + entity + rb"\s*\(", plain):
            raise _unread(entity, why)
    items = _kinds(plain, [one or other for one, other in _ITEMS.findall(plain)])
    members = _kinds(plain, _MEMBERS.findall(plain))
    _refuse_left_out(items, (_BODY, _LINES, _NO_SURFACE))
    _refuse_left_out(members, (_SURFACE, _NO_SURFACE))
    _refuse_unplaced(plain)
    n_faces = len(_FACE.findall(plain)) + _n_of(members, _SURFACE)
    if not n_faces:
        raise BadSyntax("the STEP file has no faces", valid="a solid, or a surface")
    bare = tuple(_name_of(text, number) for number in _bare_parts(plain))
    return StepFacts(n_faces, _accuracy(plain), _n_of(items, _LINES), bare)


def _unread(entity: bytes, why: str) -> BadSyntax:
    return BadSyntax(f"{entity.decode()} is not read: {why}", valid="solids of faces, in one file")


def _kinds(text: bytes, lists: list[bytes]) -> list[list[bytes]]:
    """The names of each entity in lists of references: one, or all that a complex entity has."""
    asked = {number for references in lists for number in _REFERENCE.findall(references)}
    return [
        [record[2]] if record[2] else _NAME.findall(record[3])
        for record in _RECORD.finditer(text)
        if record[1] in asked
    ]


def _refuse_left_out(kinds: list[list[bytes]], known: tuple[re.Pattern[bytes], ...]) -> None:
    for names in kinds:
        if not any(pattern.fullmatch(name) for pattern in known for name in names):
            raise _unread(b" ".join(names), "Open CASCADE leaves it out")


def _n_of(kinds: list[list[bytes]], pattern: re.Pattern[bytes]) -> int:
    return sum(any(map(pattern.fullmatch, names)) for names in kinds)


def _refuse_unplaced(text: bytes) -> None:
    """Refuses an occurrence of a part that nothing places; a file with MAPPED_ITEM may place it by that."""
    shape_of = dict(_SHAPE_OF.findall(text))
    placed = {shape_of.get(shape) for shape in _HAS_PLACE.findall(text)}
    occurrences = _OCCURRENCE.findall(text)
    bodies = {shape_of.get(shape) for shape, _ in _HAS_SHAPE.findall(text)}
    bodies.update(assembly for _, assembly, _ in occurrences)
    unplaced = [n for n, _, part in occurrences if n not in placed and part in bodies]
    if unplaced and b"MAPPED_ITEM" not in text:
        raise BadSyntax(
            f"#{unplaced[0].decode()} is a part of an assembly without a placement",
            valid="a CONTEXT_DEPENDENT_SHAPE_REPRESENTATION for each NEXT_ASSEMBLY_USAGE_OCCURRENCE",
        )


def _bare_parts(text: bytes) -> list[bytes]:
    """Occurrences of parts that have a place and no shape: so exporters write parts that are hidden or linked."""
    places, shape_of = set(_PLACES.findall(text)), dict(_SHAPE_OF.findall(text))
    bare = {n for n, items in _HOLDS.findall(text) if places.issuperset(_REFERENCE.findall(items))}
    bare -= {n for pair in _SAME.findall(text) if not bare.issuperset(pair) for n in pair}
    shown = {shape_of.get(shape) for shape, held in _HAS_SHAPE.findall(text) if held not in bare}
    occurrences = _OCCURRENCE.findall(text)
    shown.update(assembly for _, assembly, _ in occurrences)
    return [number for number, _, part in occurrences if part not in shown]


def _name_of(text: bytes, number: bytes) -> str:
    """The first name of an occurrence, as it is written; its number where it has none."""
    found = re.search(rb"#" + number + rb"\s*=\s*[A-Z_]+\s*\(\s*'([^']+)'", text)
    return repr(found[1].decode(errors="replace")) if found else f"#{number.decode()}"


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
