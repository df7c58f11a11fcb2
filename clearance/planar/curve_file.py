"""Curves from files: DXF drawings, or YAML lists of arguments of `Curve`'s constructors.

    curves:
      - polyline: {points: [[0, 0], [1, 0], [1, 1]], closed: true}
      - bspline: {control: [[0, 0], [1, 2], [2, -1], [3, 0]], degree: 3}
      - chain:
          - line: {start: [0, 0], end: [1, 0]}
          - arc: {center: [1, 1], radius: 1, start: -1.5707963267948966, end: 0}

Angles in radians. Not for: writing curves.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from clearance.errors import (
    BadInput,
    BadSyntax,
    ClearanceError,
    MissingKey,
    UnknownKey,
    at,
    nearest_name,
)
from clearance.plain_yaml import yaml_file
from clearance.planar.curve import Curve
from clearance.planar.dxf import read_dxf

_FORMS: dict[str, tuple[Callable[..., Curve], tuple[str, ...], tuple[str, ...]]] = {
    "line": (Curve.line, ("start", "end"), ()),
    "polyline": (Curve.polyline, ("points",), ("closed",)),
    "bspline": (Curve.bspline, ("control",), ("degree", "knots", "weights")),
    "bezier": (Curve.bezier, ("control",), ("weights",)),
    "arc": (Curve.arc, ("center", "radius", "start", "end"), ()),
    "circle": (Curve.circle, ("center", "radius"), ()),
}


def read_curve(path: str | PathLike[str]) -> Curve:
    """The curve of a `.dxf`, `.yaml` or `.yml` file; several curves become its contours.

    Raises: MissingFile, BadSyntax, UnknownKey, MissingKey and what the constructors raise, with file and field.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".dxf":
        return read_dxf(path)
    if suffix not in (".yaml", ".yml"):
        raise BadSyntax(
            f"no file of curves, by its suffix {suffix or '(none)'}",
            where=str(path),
            valid=".dxf, .yaml or .yml",
        )
    with at(str(path)):
        return curve_of_document(yaml_file(Path(path), "a DXF or YAML file of curves"))


def curve_of_document(document: object) -> Curve:
    """The curve that the content of a YAML file says.

    Raises: As `read_curve`, with the field.
    """
    if not isinstance(document, dict) or not isinstance(document.get("curves"), list):
        raise MissingKey("no list of curves", where="curves", valid="a mapping `curves: [...]`")
    for key in document:
        if key != "curves":
            raise UnknownKey(f"{key!r}", valid="only `curves`")
    if not document["curves"]:
        raise MissingKey("an empty list", where="curves", valid="at least one curve")
    return Curve.contours(
        [_curve(entry, f"curves[{k}]") for k, entry in enumerate(document["curves"])]
    )


def _curve(entry: object, place: str) -> Curve:
    with at(place):
        if not isinstance(entry, dict) or len(entry) != 1:
            raise BadSyntax(
                f"{entry!r:.60}", valid=f"one of {', '.join(_FORMS)} or chain with its values"
            )
        form, values = next(iter(entry.items()))
        if form == "chain":
            if not isinstance(values, list):
                raise BadSyntax(f"{values!r:.60}", where="chain", valid="a list of curves")
            return Curve.chain([_curve(part, f"chain[{k}]") for k, part in enumerate(values)])
        if form not in _FORMS:
            raise UnknownKey(f"{form!r}", valid=nearest_name(str(form), [*_FORMS, "chain"]))
        with at(form):
            return _made(form, values)


def _made(form: str, values: object) -> Curve:
    make, needed, optional = _FORMS[form]
    if not isinstance(values, dict):
        raise BadInput(f"{values!r:.60}", valid=f"a mapping of {', '.join((*needed, *optional))}")
    for key in needed:
        if key not in values:
            raise MissingKey("nothing given", where=key, valid=f"{form} needs {', '.join(needed)}")
    for key in values:
        if key not in (*needed, *optional):
            raise UnknownKey(f"{key!r}", valid=nearest_name(str(key), (*needed, *optional)))
    try:
        return make(**values)
    except ClearanceError:
        raise
    except (
        TypeError,
        ValueError,
        OverflowError,
    ):  # text where numbers belong, lists of unlike lengths
        raise BadInput(f"{values!r:.60}", valid=f"numbers for {', '.join(needed)}") from None
