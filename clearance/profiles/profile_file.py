"""Profiles as files: our YAML, which has everything, DXF and SVG for CAD and eyes, GeoJSON for others.

    format: clearance-profile-1
    name: hot_cell
    plane: {name: xy, origin: [0, 0, 0], axes: [[1, 0, 0], [0, 1, 0]]}
    bound: 0.00047            # m; contains all that is swept, exceeds it by at most this
    contours:                 # x, y [m], bulge = tan(sweep / 4), positive to the left; closed
      - [[0.1, 0.2, 0.0], [0.3, 0.2, 0.41]]

Lengths in metres throughout, DXF included (its header says so). Not for: reading them (`profile_read`).
"""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import numpy as np
from markupsafe import escape

from clearance.errors import BadInput
from clearance.extras import importing
from clearance.files import write_file
from clearance.planar.dxf import OWN_TAG, SWEPT
from clearance.profiles.contour import Contour
from clearance.profiles.profile import Profile
from clearance.profiles.profile_read import FORMAT

SUFFIXES = (".yaml", ".yml", ".dxf", ".svg", ".geojson", ".json")

FLAT = 1e-6
"""[m] How far the chords of a GeoJSON polygon may be from the arcs."""

FITTING = "max-width:100vw;max-height:100vh"
"""A browser shows all of an SVG drawing however wide; who draws in millimetres reads width and height."""

METRES = 6
"""$INSUNITS of the DXF reference."""


def write_profile(profile: Profile, path: str | Path) -> None:
    """Writes a profile in the format of the suffix: .yaml, .dxf, .svg, .geojson or .json.

    Raises:
        BadInput: another suffix. Unwritable.
    """
    path = Path(path)
    require_suffix(path)
    write_file(path, _text(profile, path.suffix.lower()).encode())


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


def _text(profile: Profile, suffix: str) -> str:
    if suffix == ".dxf":
        return dxf_text(profile)
    if suffix == ".svg":
        return svg_text(profile)
    return yaml_text(profile) if suffix in (".yaml", ".yml") else geojson_text(profile)


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
        "contains": profile.content, "notes": list(profile.notes),
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
        f'viewBox="{low[0]:.9g} {-high[1]:.9g} {width:.9g} {height:.9g}" style="{FITTING}">\n'
        f"<title>{escape(profile.name)}, {escape(profile.plane)}</title>\n"
        f"<desc>{escape('; '.join((profile.promise, *profile.notes)))}</desc>\n"
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


def dxf_text(profile: Profile) -> str:
    """The text of a DXF R2010 drawing, by ezdxf; the same profile gives the same text.

    A contour is a closed LWPOLYLINE with bulges. Each link's own profile is on a layer of its name. Bounds and
    notes are custom properties of the drawing.

    Raises:
        Unavailable: ezdxf is missing.
    """
    with importing("dxf", "a DXF drawing"):
        import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    try:  # else the file would have the time of writing and fresh GUIDs
        ezdxf.options.write_fixed_meta_data_for_testing = True
        return _text_of(ezdxf.new("R2010", setup=False), profile)
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def _text_of(drawing, profile: Profile) -> str:
    drawing.header["$INSUNITS"] = METRES
    drawing.header["$MEASUREMENT"] = 1
    drawing.header["$LUPREC"] = 8
    for line in (profile.promise, *profile.notes):
        drawing.header.custom_vars.append(OWN_TAG, line)
    for layer, part in {SWEPT: profile, **profile.parts}.items():
        drawing.layers.add(layer_name(layer))
        _draw(drawing, part, layer_name(layer))
    out = io.StringIO()
    drawing.write(out)
    return out.getvalue()


def _draw(drawing, profile: Profile, layer: str) -> None:
    space = drawing.modelspace()
    for contour in profile.contours:
        space.add_lwpolyline(_rows(contour), format="xyb", close=True, dxfattribs={"layer": layer})


def layer_name(link: str) -> str:
    """A link's name without the characters that DXF forbids in layers."""
    return re.sub(r'[<>/\\":;?*|=`]', "_", link)
