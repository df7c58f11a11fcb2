"""The obstacles that a case file cannot describe itself: valve, wall with ports, trough, bookend. Metres."""

from __future__ import annotations

from scripts.makers.polygon import Loop
from scripts.makers.solids import Solid, arc, circle, extruded, ring, turned


def valve_body() -> Solid:
    """A gate valve's body about z: two flanges, a waist, a belly; solid, the pipe runs through it."""
    profile = [
        (0.078, -0.10),
        (0.078, -0.08),
        (0.052, -0.08),
        (0.052, -0.065),
        (0.064, -0.035),
        (0.064, 0.035),
        (0.052, 0.065),
        (0.052, 0.08),
        (0.078, 0.08),
        (0.078, 0.10),
    ]
    return turned(profile)


def handwheel() -> Solid:
    """A spoked wheel in the plane x = 0: rim of 90 mm radius, hub, four spokes, four openings between them."""
    openings = [_opening(quarter) for quarter in range(4)]
    return extruded(circle((0, 0), 0.09, 40), -0.008, 0.008, "x", holes=openings)


def _opening(quarter: int) -> Loop:
    """A sector between hub, rim and two spokes, counter-clockwise."""
    middle = 90.0 * quarter + 45.0
    rim = arc((0, 0), 0.074, (middle - 37.0, middle + 37.0), 9)
    return [*rim, *arc((0, 0), 0.026, (middle + 22.0, middle - 22.0), 4)]


def port_wall() -> Solid:
    """The shield wall, 80 mm thick along x, 1.8 m wide, 1.6 m high: two round ports and a window opening."""
    outline = [(-0.9, 0.0), (0.9, 0.0), (0.9, 1.6), (-0.9, 1.6)]
    window = [(-0.35, 1.12), (0.35, 1.12), (0.35, 1.45), (-0.35, 1.45)]
    ports = [circle((0.0, 0.75), 0.17, 40), circle((0.58, 0.75), 0.12, 32)]
    return extruded(outline, -0.04, 0.04, "x", holes=[*ports, window])


def port_collar() -> Solid:
    """The steel ring about a port, along x, with an inner chamfer."""
    profile = [
        (0.165, -0.055),
        (0.2, -0.055),
        (0.2, 0.055),
        (0.165, 0.055),
        (0.155, 0.045),
        (0.155, -0.045),
    ]
    return ring(profile, "x", n=40)


def trough() -> Solid:
    """A sample trough open at the top and at both ends, along y."""
    outline = [
        (-0.11, 0.0),
        (0.11, 0.0),
        (0.13, 0.07),
        (0.122, 0.07),
        (0.103, 0.008),
        (-0.103, 0.008),
        (-0.122, 0.07),
        (-0.13, 0.07),
    ]
    return extruded(outline, -0.18, 0.18, "y")


def bookend() -> Solid:
    """A bent sheet, in (x, z): foot and upright with a fillet between them, 120 mm wide."""
    fillet = arc((0.02, 0.02), 0.016, (-90.0, -180.0), 7)
    outline = [(0.0, 0.0), (0.13, 0.0), (0.13, 0.004), *fillet, (0.004, 0.16), (0.0, 0.16)]
    return extruded(outline, -0.06, 0.06, "y")


MESHES = {
    "iiwa_pipe_rack": {"valve_body": valve_body, "handwheel": handwheel},
    "panda_shelf": {"bookend": bookend},
    "hot_cell": {"port_wall": port_wall, "port_collar": port_collar, "trough": trough},
}
"""Scene name to mesh name to the function that makes it."""
