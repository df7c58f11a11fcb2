"""Profiles into DXF, through ezdxf: one closed LWPOLYLINE with bulges a contour, in metres, the header says so.

Each link's own profile, if there is one, is on a layer of its name. Reading is `clearance.planar.dxf`'s.
"""

from __future__ import annotations

import io
import re

import numpy as np

from clearance.extras import importing
from clearance.profiles.profile import Profile

METRES = 6
"""$INSUNITS of the DXF reference."""


def dxf_text(profile: Profile) -> str:
    """The text of a DXF R2010 drawing; the same profile gives the same text.

    Raises:
        Unavailable: ezdxf is missing.
    """
    with importing("dxf", "a DXF drawing"):
        import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    try:  # else the file would hold the time of writing and fresh GUIDs
        ezdxf.options.write_fixed_meta_data_for_testing = True
        return _text_of(ezdxf.new("R2010", setup=False), profile)
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def _text_of(drawing, profile: Profile) -> str:
    drawing.header["$INSUNITS"] = METRES
    drawing.header["$MEASUREMENT"] = 1
    drawing.header["$LUPREC"] = 8
    for layer, part in {"SWEPT": profile, **profile.parts}.items():
        drawing.layers.add(layer_name(layer))
        _draw(drawing, part, layer_name(layer))
    out = io.StringIO()
    drawing.write(out)
    return out.getvalue()


def _draw(drawing, profile: Profile, layer: str) -> None:
    space = drawing.modelspace()
    for contour in profile.contours:
        rows = np.column_stack([contour.vertices, contour.bulges]).tolist()
        space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs={"layer": layer})


def layer_name(link: str) -> str:
    """A link's name without the characters that DXF forbids in layers."""
    return re.sub(r'[<>/\\":;?*|=`]', "_", link)
