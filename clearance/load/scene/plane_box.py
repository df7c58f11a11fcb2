"""The box that stands for a plane in a scene. Not for: where it is (`sdf.geometry`, `mjcf`)."""

from __future__ import annotations

PLANE_SIDE, PLANE_DEPTH = 40.0, 1.0
"""[m] A plane, which has no end and no thickness, as a box below it; arms work within 20 m of where they stand."""
