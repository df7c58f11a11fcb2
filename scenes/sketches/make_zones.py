"""Writes the sketches that profiles are fitted with: run `python scenes/sketches/make_zones.py`.

Free dimensions are the driven ones. Lengths in metres, in the coordinates of the plane they are made for.
"""

from __future__ import annotations

import math
from pathlib import Path

from clearance.sketch import Sketch

HERE = Path(__file__).parent


def rounded(
    low: tuple[float, float], high: tuple[float, float], fillet: float, *, held: bool = False
) -> Sketch:
    """A rectangle with sides along x and y and four equal fillets; width and depth are free."""
    s = Sketch()
    (x0, y0), (x1, y1), r = low, high, fillet
    ends = [(x0 + r, y0), (x1 - r, y0), (x1, y0 + r), (x1, y1 - r),
            (x1 - r, y1), (x0 + r, y1), (x0, y1 - r), (x0, y0 + r)]  # fmt: skip
    p = [s.point(*place, name=f"p{i}") for i, place in enumerate(ends)]
    middles = [(x1 - r, y0 + r), (x1 - r, y1 - r), (x0 + r, y1 - r), (x0 + r, y0 + r)]
    c = [s.point(*place, name=f"c{i}") for i, place in enumerate(middles)]
    names = ("front", "right", "back", "left")
    sides = [s.segment(p[2 * i], p[2 * i + 1], name=name) for i, name in enumerate(names)]
    arcs = [s.arc(c[i], p[2 * i + 1], p[(2 * i + 2) % 8], name=f"corner{i}") for i in range(4)]
    s.horizontal(sides[0], name="front_level")
    s.vertical(sides[1], name="right_upright")
    s.parallel(sides[0], sides[2], name="back_level")
    s.parallel(sides[1], sides[3], name="left_upright")
    for i in range(4):
        s.tangent(arcs[i], sides[i], name=f"corner{i}_in")
        s.tangent(arcs[i], sides[(i + 1) % 4], name=f"corner{i}_out")
    for i in range(1, 4):
        s.equal_radius(arcs[0], arcs[i], name=f"corner{i}_alike")
    s.radius(arcs[0], fillet, name="fillet")
    _dimension(s, sides[1], sides[3], x1 - x0, "width", held)
    _dimension(s, sides[0], sides[2], y1 - y0, "depth", held)
    return s


def d_cell(x: float, radius: float) -> Sketch:
    """A D: a straight back at x, two straight sides and half a circle in front; radius and length are free."""
    s = Sketch()
    length = 2.0 * radius
    places = {
        "a": (x, -radius),
        "b": (x + length, -radius),
        "c": (x + length, radius),
        "d": (x, radius),
    }
    p = {name: s.point(*place, name=name) for name, place in places.items()}
    middle = s.point(x + length, 0.0, name="middle")
    low, back, high = (
        s.segment(p[i], p[j], name=n)
        for i, j, n in (("a", "b", "low"), ("d", "a", "rear"), ("c", "d", "high"))
    )
    front = s.arc(middle, p["b"], p["c"], name="front")
    s.vertical(back, name="rear_upright")
    s.perpendicular(low, back, name="low_level")
    s.parallel(low, high, name="high_level")
    s.tangent(front, low, name="front_in")
    s.tangent(front, high, name="front_out")
    s.distance(back, middle, length, name="length", driven=True)
    s.radius(front, radius, name="radius", driven=True)
    return s


def bar(middle: tuple[float, float], width: float, height: float) -> Sketch:
    """A rectangle of free width and given height, free to turn: the bar that is to pass an opening."""
    s = Sketch()
    x, y, u, v = *middle, 0.5 * width, 0.5 * height
    corners = [(x - u, y - v), (x + u, y - v), (x + u, y + v), (x - u, y + v)]
    p = [s.point(*place, name=f"p{i}") for i, place in enumerate(corners)]
    sides = [s.segment(p[i], p[(i + 1) % 4], name=f"side{i}") for i in range(4)]
    for i in range(3):
        s.perpendicular(sides[i], sides[i + 1], name=f"square{i}")
    s.distance(p[0], p[1], width, name="width", driven=True)
    s.distance(p[1], p[2], height, name="height")
    return s


def opening(middle: tuple[float, float], radius: float) -> Sketch:
    """A round opening, held where it is."""
    s = Sketch()
    center = s.point(*middle, name="middle")
    s.fix(center, name="middle_fixed")
    s.radius(s.circle(center, radius, name="rim"), radius, name="rim_radius")
    return s


def _dimension(s: Sketch, one, two, value: float, name: str, held: bool) -> None:
    s.distance(one, two, value, name=name, driven=not held)


def main() -> None:
    """Writes all of them."""
    sketches = {
        "keep_in_zone": rounded((-0.45, -0.25), (1.15, 0.25), 0.08),
        "d_cell": d_cell(-0.3, 0.5),
        "port_bar": bar((0.0, 0.75), 0.15, 0.10),
        "port_opening": opening((0.0, 0.75), 0.17 * math.cos(math.pi / 40)),
        "port_too_small": opening((0.0, 0.75), 0.09),
    }
    for name, sketch in sketches.items():
        sketch.save(HERE / f"{name}.yaml")


if __name__ == "__main__":
    main()
