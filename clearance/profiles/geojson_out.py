"""A profile as GeoJSON-like text, for programs that know polygons only. Not for: arcs kept as arcs (`dxf_out`)."""

from __future__ import annotations

import json

from clearance.profiles.profile import Profile

FLAT = 1e-6
"""[m] How far the chords of a GeoJSON polygon may be from the arcs."""


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
