"""A profile as an SVG drawing of its lines and arcs, in millimetres.

Not for: pictures of two outlines (`picture`).
"""

from __future__ import annotations

import numpy as np
from markupsafe import escape

from clearance.profiles.contour import Contour
from clearance.profiles.profile import Profile

FITTING = "max-width:100vw;max-height:100vh"
"""A browser shows all of it however many metres it is wide; who draws in millimetres reads width and height."""


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
