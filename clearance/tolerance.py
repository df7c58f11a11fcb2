"""Every numeric tolerance of the package: its value, its unit and the reason for it.

Not for: thresholds that are exact by construction (predicates) and error bounds that are computed.
"""

UNIT_ROUNDOFF = 2.0**-53
"""Largest relative error of one rounded float64 operation."""

TESSELLATION = 1e-4
"""[m] How far a facet of a round shape may stand outside the true surface, by default: below the
repeatability of industrial arms (about 0.1 mm, ISO 9283 data sheets), so it never decides a verdict."""

ROTATION = 1e-6
"""[-] How far a given quaternion's norm or a matrix's R^T R may be from unity: YAML files carry six or more
digits; anything worse is a typing error, not a rounding."""

CROSS_CHECK = 1e-9
"""[-] Greatest difference between our clearance and FCL's, relative to the scene's size, that counts as
agreement: FCL's triangle kernel loses up to 1e-10 in millimetres on slender triangles."""

FLATNESS = 1e-9
"""[-] How far a polygon's vertices may be off its plane, relative to its radius, and how far it may bend
inward (sine of the angle), beside the rounding of its coordinates: a thousand times what a rigid motion in
float64 does to it near the origin, and a hundred times less than the rounding of coordinates in a float32 or
six-digit file, whose polygons are cut into triangles instead."""
