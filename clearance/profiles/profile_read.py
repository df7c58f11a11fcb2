"""Profiles read from our YAML, everything checked that is used."""

from __future__ import annotations

from typing import TypeGuard

import numpy as np

from clearance.errors import BadSyntax, MissingKey, at
from clearance.profiles.contour import Contour
from clearance.profiles.profile import Origin, Profile

FORMAT = "clearance-profile-1"


def is_profile(document: object) -> TypeGuard[dict]:
    """Whether a YAML document claims to be a profile of ours."""
    return isinstance(document, dict) and "contours" in document and "format" in document


def profile_of(document: dict) -> Profile:
    """The profile in a YAML document.

    Raises:
        BadSyntax, MissingKey: what is missing or wrong, with its field.
    """
    if document.get("format") != FORMAT:
        raise BadSyntax(f"format {document.get('format')!r:.40}", where="format", valid=FORMAT)
    contours = document["contours"]
    if not isinstance(contours, list) or not contours:
        raise MissingKey("no contours", where="contours", valid="a list of contours")
    with at("contours"):
        made = tuple(_contour(rows, f"[{k}]") for k, rows in enumerate(contours))
    plane = _mapping(document, "plane")
    with at("plane"):
        origin = _table(plane.get("origin", [0.0, 0.0, 0.0]), (3,), "origin", "x, y, z [m]")
        axes = _table(plane.get("axes", np.eye(3)[:2]), (2, 3), "axes", "two directions")
    return Profile(
        contours=made,
        name=str(document.get("name", "")),
        plane=str(plane.get("name", "xy")),
        plane_origin=origin,
        plane_axes=axes,
        section=_section(document),
        tolerance=_length(document, "tolerance"),
        bound=_length(document, "bound"),
        facets=_length(document, "facets"),
        n_steps=int(_length(document, "steps")),
        origin=_origin(document.get("origin"), sum(contour.n_pieces for contour in made)),
        parts=_parts(document),
        notes=_notes(document),
    )


def _notes(document: dict) -> tuple[str, ...]:
    notes = document.get("notes") or []
    if not isinstance(notes, list):
        raise BadSyntax(f"{notes!r:.40}", where="notes", valid="a list of text")
    return tuple(map(str, notes))


def _parts(document: dict) -> dict[str, Profile]:
    found = {}
    parts = _mapping(document, "parts")
    with at("parts"):
        for name in parts:
            part = _mapping(parts, name)
            with at(str(name)):
                if "contours" not in part:
                    raise MissingKey("no contours", where="contours", valid="a list of contours")
                found[str(name)] = profile_of({"format": FORMAT} | part)
    return found


def _mapping(document: dict, key: str) -> dict:
    value = document.get(key) or {}
    if not isinstance(value, dict):
        raise BadSyntax(f"{value!r:.40}", where=str(key), valid="names with values")
    return value


def _table(rows, shape: tuple[int, ...], place: str, valid: str) -> np.ndarray:
    """Finite numbers of a shape, -1 for any length."""
    try:
        table = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        table = np.zeros(0)
    fits = table.ndim == len(shape) and all(
        wanted in (-1, size) for wanted, size in zip(shape, table.shape, strict=True)
    )
    if not fits or not np.isfinite(table).all():
        raise BadSyntax(f"{rows!r:.40}", where=place, valid=valid)
    return table


def _section(document: dict) -> float | None:
    value = document.get("section")
    if value is None:
        return None
    return float(_table(value, (), "section", "a height [m]"))


def _contour(rows, place: str) -> Contour:
    table = _table(rows, (-1, 3), place, "two or more rows of x, y, bulge [m]")
    if len(table) < 2:
        raise BadSyntax("a single vertex", where=place, valid="two or more rows of x, y, bulge [m]")
    if not (np.abs(table[:, 2]) < 1.0).all():
        raise BadSyntax("a bulge of 1 or more", where=place, valid="arcs of less than half a turn")
    return Contour(table[:, :2].copy(), table[:, 2].copy())


def _length(document: dict, key: str) -> float:
    value = document.get(key, 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < np.inf:
        raise BadSyntax(f"{value!r:.40}", where=key, valid="a length [m], 0 or more")
    return float(value)


def _origin(entry, n_pieces: int) -> Origin | None:
    if entry is None:
        return None
    valid = "links, and the number of a link and a step for each piece"
    links = entry.get("links") if isinstance(entry, dict) else None
    if not isinstance(links, list) or not links:
        raise BadSyntax(f"{entry!r:.40}", where="origin", valid=valid)
    with at("origin"):
        made = _table(entry.get("link_and_step"), (-1, 2), "link_and_step", valid).astype(np.int64)
    if len(made) != n_pieces:
        raise BadSyntax(
            f"{len(made)} entries for {n_pieces} pieces", where="origin", valid="one a piece"
        )
    if not ((made >= 0).all() and (made[:, 0] < len(links)).all()):
        raise BadSyntax("a link or step that there is not", where="origin", valid=valid)
    return Origin(tuple(map(str, links)), made[:, 0].copy(), made[:, 1].copy())
