"""Profiles as files: our YAML, which holds everything, DXF and SVG for CAD and eyes, GeoJSON for others.

    format: clearance-profile-1
    name: hot_cell
    plane: {name: xy, origin: [0, 0, 0], axes: [[1, 0, 0], [0, 1, 0]]}
    bound: 0.00047            # m; contains all that is swept, exceeds it by at most this
    contours:                 # x, y [m], bulge = tan(sweep / 4), positive to the left; closed
      - [[0.1, 0.2, 0.0], [0.3, 0.2, 0.41]]

Lengths in metres throughout, DXF included (its header says so). Not for: curves that are not profiles, which
`clearance.planar.curve_file` reads.
"""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

from clearance.errors import BadInput, BadSyntax, MissingKey, Unwritable, at
from clearance.profiles.contour import Contour
from clearance.profiles.profile import Origin, Profile

FORMAT = "clearance-profile-1"
SUFFIXES = (".yaml", ".yml", ".dxf", ".svg", ".geojson", ".json")
FLAT = 1e-6
"""[m] How far the chords of a GeoJSON polygon may be from the arcs."""


def write_profile(profile: Profile, path: str | Path) -> None:
    """Writes a profile in the format of the suffix: .yaml, .dxf, .svg, .geojson or .json.

    Raises:
        BadInput: another suffix. Unwritable.
    """
    path = Path(path)
    require_suffix(path)
    makers = {".dxf": _dxf, ".svg": svg_text, ".geojson": geojson_text, ".json": geojson_text}
    text = makers.get(path.suffix.lower(), yaml_text)(profile)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Unwritable(f"cannot write here ({error.strerror})", where=str(path)) from None


def require_suffix(path: str | Path) -> None:
    """Nothing, if a profile can be written under this name.

    Raises: BadInput.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        given = suffix or "no suffix"
        raise BadInput(
            f"a profile file with {given}", where=str(path), valid=f"one of {', '.join(SUFFIXES)}"
        )


def yaml_text(profile: Profile) -> str:
    """The profile as YAML; reading it back gives the same numbers bit for bit."""
    from ruamel.yaml import YAML

    out = io.StringIO()
    yaml = YAML()
    yaml.default_flow_style = None
    yaml.width = 110
    yaml.dump({"format": FORMAT} | _tree(profile), out)
    return out.getvalue()


def _tree(profile: Profile) -> dict:
    tree: dict = {
        "name": profile.name,
        "plane": {
            "name": profile.plane,
            "origin": profile.plane_origin.tolist(),
            "axes": profile.plane_axes.tolist(),
        },
        "tolerance": profile.tolerance,
        "bound": profile.bound,
        "facets": profile.facets,
        "steps": profile.n_steps,
        "notes": list(profile.notes),
        "contours": [_rows(contour) for contour in profile.contours],
    }
    if profile.section is not None:
        tree["section"] = profile.section
    if profile.origin is not None:
        made = np.stack([profile.origin.link, profile.origin.step], axis=1)
        tree["origin"] = {"links": list(profile.origin.links), "link_and_step": made.tolist()}
    if profile.parts:
        tree["parts"] = {name: _tree(part) for name, part in profile.parts.items()}
    return tree


def _rows(contour: Contour) -> list[list[float]]:
    return np.column_stack([contour.vertices, contour.bulges]).tolist()


def is_profile(document) -> bool:
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
    plane = document.get("plane") or {}
    return Profile(
        contours=made,
        name=str(document.get("name", "")),
        plane=str(plane.get("name", "xy")),
        plane_origin=np.array(plane.get("origin", [0.0, 0.0, 0.0]), float),
        plane_axes=np.array(plane.get("axes", np.eye(3)[:2]), float),
        section=document.get("section"),
        tolerance=_length(document, "tolerance"),
        bound=_length(document, "bound"),
        facets=_length(document, "facets"),
        n_steps=int(document.get("steps", 0)),
        origin=_origin(document.get("origin"), sum(contour.n_pieces for contour in made)),
        parts={
            name: profile_of({"format": FORMAT} | part)
            for name, part in document.get("parts", {}).items()
        },
        notes=tuple(map(str, document.get("notes", ()))),
    )


def _contour(rows, place: str) -> Contour:
    try:
        table = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        table = np.zeros(0)
    if table.ndim != 2 or table.shape[1] != 3 or len(table) < 2 or not np.isfinite(table).all():
        raise BadSyntax("not a contour", where=place, valid="two or more rows of x, y, bulge [m]")
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
    made = np.array(entry["link_and_step"], dtype=np.int64).reshape(-1, 2)
    if len(made) != n_pieces:
        raise BadSyntax(
            f"{len(made)} entries for {n_pieces} pieces", where="origin", valid="one a piece"
        )
    return Origin(tuple(map(str, entry["links"])), made[:, 0].copy(), made[:, 1].copy())


def _dxf(profile: Profile) -> str:
    from clearance.profiles.dxf_out import dxf_text

    return dxf_text(profile)


def geojson_text(profile: Profile) -> str:
    """A GeoJSON-like feature collection [m]: one polygon or several with holes, arcs as chords within 1e-6 m."""
    from clearance.profiles.region import rings_of

    polygons: list[list] = []
    for ring, hole in rings_of(profile.region):
        closed = [*ring.tolist(), ring[0].tolist()]
        if hole:
            polygons[-1].append(closed)
        else:
            polygons.append([closed])
    properties = {
        "name": profile.name, "plane": profile.plane, "section": profile.section, "unit": "m",
        "bound": profile.bound + FLAT, "facets": profile.facets, "steps": profile.n_steps,
    }  # fmt: skip
    geometry = {"type": "MultiPolygon", "coordinates": polygons}
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    return json.dumps({"type": "FeatureCollection", "features": [feature]}) + "\n"


def svg_text(profile: Profile) -> str:
    """An SVG drawing, 1 unit = 1 mm, y upwards, even-odd filled."""
    low, high = profile.curve.box * 1000.0
    margin = 0.03 * float((high - low).max())
    low, high = low - margin, high + margin
    width, height = high - low
    stroke = 0.0012 * max(width, height)
    paths = " ".join(svg_path(contour, 1000.0) for contour in profile.contours)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.6g}mm" height="{height:.6g}mm" '
        f'viewBox="{low[0]:.9g} {-high[1]:.9g} {width:.9g} {height:.9g}">\n'
        f"<title>{_escaped(profile.name)}, {_escaped(profile.plane)}</title>\n"
        f"<desc>contains all that is swept; exceeds it by at most {profile.bound * 1000:.4g} mm</desc>\n"
        f'<path transform="scale(1 -1)" d="{paths}" fill="#dbe7f5" fill-rule="evenodd" '
        f'stroke="#1f5fbf" stroke-width="{stroke:.3g}"/>\n</svg>\n'
    )


def svg_path(contour: Contour, scale: float) -> str:
    """The contour as path data, lengths times `scale`."""
    words = ["M{:.9g} {:.9g}".format(*(contour.vertices[0] * scale))]
    following = np.roll(contour.vertices, -1, axis=0)
    chords = np.hypot(*(following - contour.vertices).T)
    for (x, y), bulge, chord in zip(following * scale, contour.bulges, chords, strict=True):
        if bulge == 0.0:
            words.append(f"L{x:.9g} {y:.9g}")
        else:
            radius = scale * chord * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
            words.append(f"A{radius:.9g} {radius:.9g} 0 0 {int(bulge > 0.0)} {x:.9g} {y:.9g}")
    return " ".join(words) + " Z"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
