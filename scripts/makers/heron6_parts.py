"""The shapes of heron6, link by link, each in its link frame; sizes in metres.

A link is a few closed castings that overlap where they are bolted together: turned drums and tubes, and
plates cut to a profile (forks, a beam with a slot, a lifting eye, notched fingers), most of them concave.
"""

from __future__ import annotations

from scripts.makers.solids import Solid, arc, box, circle, extruded, ring, turned
from scripts.makers.urdf import Part

AMBER = (0.93, 0.58, 0.12)
GRAPHITE = (0.20, 0.21, 0.24)
SILVER = (0.80, 0.82, 0.85)
STEEL = (0.56, 0.60, 0.64)


def drum(
    radius: float, half: float, at: tuple[float, float, float] = (0, 0, 0), n: int = 32
) -> Solid:
    """A turned drum along y with chamfered rims."""
    c = min(0.12 * radius, 0.3 * half)
    profile = [(radius - c, -half), (radius, c - half), (radius, half - c), (radius - c, half)]
    return turned(profile, "y", at, n)


def fork(bridge: tuple[float, float], tip: float, gap: float, outer: float, half: float) -> Solid:
    """A fork open towards `tip` in x: two prongs at |y| in [gap, outer] joined by a bridge."""
    near, far = bridge
    c = 0.35 * (outer - gap) * (1 if tip > far else -1)
    if tip > far:
        outline = [
            (near, -outer + c),
            (near + c, -outer),
            (tip - c, -outer),
            (tip, -outer + c),
            (tip, -gap),
            (far, -gap),
            (far, gap),
            (tip, gap),
            (tip, outer - c),
            (tip - c, outer),
            (near + c, outer),
            (near, outer - c),
        ]
    else:
        outline = [
            (far, outer + c),
            (far + c, outer),
            (tip - c, outer),
            (tip, outer + c),
            (tip, gap),
            (near, gap),
            (near, -gap),
            (tip, -gap),
            (tip, -outer - c),
            (tip - c, -outer),
            (far + c, -outer),
            (far, -outer - c),
        ]
    return extruded(outline, -half, half)


def base_plate() -> Solid:
    """A square foot with cut corners and four bolt holes."""
    a, b = 0.19, 0.14
    outline = [(a, -b), (a, b), (b, a), (-b, a), (-a, b), (-a, -b), (-b, -a), (b, -a)]
    holes = [circle((x, y), 0.012, 10) for x in (-0.145, 0.145) for y in (-0.145, 0.145)]
    return extruded(outline, 0.0, 0.03, holes=holes)


def cheek(y: float) -> Solid:
    """One side plate of the shoulder yoke: a broad foot and a round head about axis 2."""
    outline = [
        (-0.115, 0.04),
        (0.115, 0.04),
        (0.105, 0.11),
        *arc((0, 0.2), 0.09, (-15, 195), 19),
        (-0.105, 0.11),
    ]
    return extruded(outline, y - 0.017, y + 0.017, "y")


def upper_beam() -> Solid:
    """The upper arm's tapered beam with a long slot through it."""
    outline = [*arc((0, 0), 0.068, (190, 350), 13), *arc((0, 0.44), 0.05, (5, 175), 15)]
    slot = [*arc((0, 0.15), 0.032, (180, 360), 9), *arc((0, 0.335), 0.024, (0, 180), 9)]
    return extruded(outline, -0.042, 0.042, "y", holes=[slot])


def lifting_eye() -> Solid:
    """An eye on the forearm for the in-cell crane."""
    outline = [(0.155, 0.035), (0.245, 0.035), *arc((0.2, 0.085), 0.026, (0, 180), 13)]
    return extruded(outline, -0.009, 0.009, "y", holes=[circle((0.2, 0.085), 0.014, 14)])


def finger() -> Solid:
    """The left finger: a relieved shank and a pad at y = 1 mm with a notch for bars and pipes."""
    outline = [
        (-0.008, 0.004),
        (0.02, 0.004),
        (0.026, 0.014),
        (0.042, 0.014),
        (0.05, 0.001),
        (0.066, 0.001),
        (0.075, 0.009),
        (0.084, 0.001),
        (0.1, 0.001),
        (0.1, 0.01),
        (0.06, 0.026),
        (0.02, 0.034),
        (-0.008, 0.034),
    ]
    return extruded(outline, -0.012, 0.012)


PARTS = (
    Part("base_link", "base_plate", base_plate(), STEEL, 4000),
    Part(
        "base_link",
        "base_column",
        turned(
            [(0.14, 0.015), (0.14, 0.05), (0.115, 0.09), (0.115, 0.2), (0.127, 0.21), (0.127, 0.24)]
        ),
        GRAPHITE,
    ),
    Part("base_link", "connector_box", box((-0.185, -0.05, 0.05), (-0.09, 0.05, 0.155)), STEEL),
    Part(
        "shoulder",
        "turntable",
        turned([(0.122, 0), (0.13, 0.008), (0.13, 0.048), (0.118, 0.06)]),
        AMBER,
    ),
    Part("shoulder", "cheek_left", cheek(0.095), AMBER),
    Part("shoulder", "cheek_right", cheek(-0.095), AMBER),
    Part("shoulder", "shoulder_motor", drum(0.064, 0.15, (0, 0, 0.2)), GRAPHITE),
    Part("upper_arm", "shoulder_hub", drum(0.083, 0.074), GRAPHITE),
    Part("upper_arm", "upper_beam", upper_beam(), AMBER),
    Part("upper_arm", "elbow_hub", drum(0.062, 0.052, (0, 0, 0.44)), GRAPHITE),
    Part("forearm", "elbow_fork", fork((0.085, 0.13), -0.05, 0.057, 0.088, 0.05), AMBER),
    Part("forearm", "elbow_motor", drum(0.042, 0.112), GRAPHITE),
    Part(
        "forearm",
        "forearm_tube",
        turned(
            [
                (0.064, 0.12),
                (0.07, 0.126),
                (0.07, 0.15),
                (0.053, 0.175),
                (0.05, 0.28),
                (0.046, 0.298),
            ],
            "x",
        ),
        AMBER,
    ),
    Part("forearm", "lifting_eye", lifting_eye(), STEEL, 4000),
    Part(
        "wrist_roll",
        "roll_tube",
        turned([(0.046, 0.002), (0.053, 0.01), (0.053, 0.045), (0.042, 0.06), (0.042, 0.14)], "x"),
        GRAPHITE,
    ),
    Part("wrist_roll", "wrist_fork", fork((0.12, 0.15), 0.252, 0.042, 0.062, 0.034), AMBER),
    Part("wrist_roll", "wrist_motor", drum(0.026, 0.075, (0.22, 0, 0), 24), GRAPHITE),
    Part("wrist_pitch", "wrist_hub", drum(0.038, 0.039, n=24), SILVER),
    Part(
        "wrist_pitch",
        "wrist_nose",
        turned([(0.03, 0.015), (0.03, 0.068), (0.037, 0.074), (0.037, 0.087)], "x", n=24),
        SILVER,
    ),
    Part(
        "gripper",
        "tool_flange",
        turned([(0.036, 0.001), (0.041, 0.005), (0.041, 0.02), (0.032, 0.026)], "x", n=24),
        GRAPHITE,
    ),
    Part("gripper", "palm", box((0.022, -0.078, -0.026), (0.06, 0.078, 0.026)), SILVER),
    Part(
        "gripper",
        "light_ring",
        ring([(0.05, 0.026), (0.06, 0.026), (0.06, 0.044), (0.05, 0.044)], "x"),
        STEEL,
    ),
    Part("finger_left", "finger_left", finger(), GRAPHITE, 3000),
    Part("finger_right", "finger_right", finger().mirrored_y(), GRAPHITE, 3000),
)
