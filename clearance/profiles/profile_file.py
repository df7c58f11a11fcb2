"""Profiles as files: our YAML, which holds everything, DXF and SVG for CAD and eyes, GeoJSON for others.

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
from pathlib import Path

import numpy as np

from clearance.errors import BadInput, Unwritable
from clearance.profiles.contour import Contour
from clearance.profiles.geojson_out import geojson_text
from clearance.profiles.profile import Profile
from clearance.profiles.profile_read import FORMAT
from clearance.profiles.svg_out import svg_text

SUFFIXES = (".yaml", ".yml", ".dxf", ".svg", ".geojson", ".json")


def write_profile(profile: Profile, path: str | Path) -> None:
    """Writes a profile in the format of the suffix: .yaml, .dxf, .svg, .geojson or .json.

    Raises:
        BadInput: another suffix. Unwritable.
    """
    path = Path(path)
    require_suffix(path)
    text = _text(profile, path.suffix.lower())
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


def _text(profile: Profile, suffix: str) -> str:
    if suffix == ".dxf":
        from clearance.profiles.dxf_out import dxf_text

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
