"""Makes the sketch files of this folder: the examples of Kwon, Lee and Lee 2001.

    python scenes/sketches/make_sketches.py

Points are placed first and dimensions measured or taken from named parameters; then the drawn
positions are
moved off by a fixed sequence, so that every file has something to solve. Lengths [m].
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from picture import write_svg

from clearance.sketch import Sketch

HERE = Path(__file__).parent
BREADTH, DEPTH, BOTTOM, TANK, BILGE, DECK = 16.0, 19.0, 2.0, 2.4, 1.8, 11.0


def jitter(sketch: Sketch, amount: float, seed: int = 5) -> None:
    """Moves every point that is not fixed by up to `amount`."""
    random = np.random.default_rng(seed)
    fixed = {e.name for c in sketch.constraints.values() if c.kind == "fix" for e in c.entities}
    for e in sketch.entities.values():
        if e.what == "point" and e.name not in fixed:
            for k in (0, 1):
                sketch._lists.numbers[e.variable + k] += amount * random.uniform(-1.0, 1.0)


class Midship:
    """The midship section, starboard half drawn and port half mirrored in the centre line.

    `stage` is the paper's: b hull and tanks, c girders, d stiffeners, e all; until e some
    dimensions lack.
    """

    def __init__(self, stage: str) -> None:
        self.stage = stage
        self.s = Sketch()
        self.port: dict[str, str] = {}

    def has(self, stage: str) -> bool:
        return self.stage >= stage

    def at(self, name: str, x: float, y: float):
        return self.s.point(x, y, name=name)

    def mirror(self, *names: str) -> None:
        """Port points of the given starboard ones."""
        for name in names:
            p = self.s.entity(name)
            x, y = p.position
            q = self.at(f"{name}_p", -x, y)
            self.s.symmetric(p, q, self.s.entity("center"), name=f"sym_{name}")

    def member(self, name: str, a: str, b: str, *, both: bool = True):
        """A segment and its mirror image; the starboard one."""
        line = self.s.segment(self.s.entity(a), self.s.entity(b), name=name)
        if both:
            ends = [f"{e}_p" if f"{e}_p" in self.s.entities else e for e in (a, b)]
            self.s.segment(*map(self.s.entity, ends), name=f"{name}_p")
        return line

    def hull(self) -> None:
        s = self.s
        for name, value in (
            ("B", BREADTH),
            ("D", DEPTH),
            ("h", BOTTOM),
            ("w", TANK),
            ("r", BILGE),
            ("t", DECK),
        ):
            s.parameter(name, value)
        keel = self.at("keel", 0, 0)
        s.fix(keel, name="origin")
        top = self.at("crown", 0, BOTTOM)
        center = s.segment(keel, top, name="center")
        s.vertical(center, name="upright")
        s.distance(keel, top, "h", name="double_bottom")
        self.at("bilge_low", BREADTH - BILGE, 0), self.at("bilge_high", BREADTH, BILGE)
        self.at("deck_edge", BREADTH, DEPTH), self.at("coaming", BREADTH - TANK, DEPTH)
        self.at("margin", BREADTH - TANK, BOTTOM), self.at("margin_out", BREADTH, BOTTOM)
        self.mirror("bilge_low", "bilge_high", "deck_edge", "coaming", "margin", "margin_out")
        low, side = (
            self.member("bottom", "keel", "bilge_low"),
            self.member("side", "bilge_high", "deck_edge"),
        )
        deck, wall = (
            self.member("deck", "deck_edge", "coaming"),
            self.member("wall", "coaming", "margin"),
        )
        inner = self.member("inner", "crown", "margin")
        s.horizontal(low, name="flat"), s.vertical(side, name="wall_sided")
        s.horizontal(deck, name="deck_flat"), s.vertical(wall, name="bulkhead")
        s.horizontal(inner, name="inner_flat")
        s.incident(s.entity("margin_out"), side, name="margin_on_side")
        s.horizontal(s.entity("margin"), s.entity("margin_out"), name="margin_flat")
        s.distance(s.entity("deck_edge"), center, "B", name="half_breadth")
        if self.has("c"):
            s.distance(s.entity("deck_edge"), low, "D", name="depth")
            s.distance(s.entity("margin"), side, "w", name="tank_width")
        for end, sign in (("", 1.0), ("_p", -1.0)):
            c = self.at(f"bilge_center{end}", sign * (BREADTH - BILGE), BILGE)
            ends = [s.entity(f"bilge_low{end}"), s.entity(f"bilge_high{end}")]
            arc = s.arc(c, *(ends if sign > 0 else ends[::-1]), name=f"bilge{end}")
            s.vertical(c, ends[0], name=f"bilge_tangent_low{end}")
            if sign > 0:
                s.horizontal(c, ends[1], name="bilge_tangent_high")
                s.radius(arc, "r", name="bilge_radius")

    def girders(self) -> None:
        """Vertical girders between bottom and inner bottom, and the second deck in the wing
        tank."""
        s = self.s
        for k, x in enumerate((4.0, 8.0), 1):
            low, high = f"girder{k}_low", f"girder{k}_high"
            self.at(low, x, 0), self.at(high, x, BOTTOM)
            self.mirror(low, high)
            line = self.member(f"girder{k}", low, high)
            s.vertical(line, name=f"girder{k}_upright")
            s.incident(s.entity(low), s.entity("bottom"), name=f"girder{k}_on_bottom")
            s.incident(s.entity(high), s.entity("inner"), name=f"girder{k}_on_inner")
            if self.has("d"):
                s.distance(s.entity(low), s.entity("center"), x, name=f"girder{k}_place")
        self.at("shelf_in", BREADTH - TANK, DECK), self.at("shelf_out", BREADTH, DECK)
        self.mirror("shelf_in", "shelf_out")
        shelf = self.member("shelf", "shelf_in", "shelf_out")
        s.horizontal(shelf, name="shelf_flat")
        s.incident(s.entity("shelf_in"), s.entity("wall"), name="shelf_on_wall")
        s.incident(s.entity("shelf_out"), s.entity("side"), name="shelf_on_side")
        s.distance(s.entity("shelf_in"), s.entity("bottom"), "t", name="shelf_height")

    def stiffeners(self) -> None:
        """Short members on the bottom, the inner bottom and the side."""
        s = self.s
        where = [("bottom", "y", 2.0), ("bottom", "y", 6.0), ("side", "x", 6.0), ("side", "x", 8.5)]
        where += [("wall", "x", 5.0), ("side", "x", 13.0), ("wall", "x", 15.0)]
        for k, (plate, along, place) in enumerate(where, 1):
            root, tip = f"stiffener{k}_root", f"stiffener{k}_tip"
            base = {
                "bottom": (place, 0.0),
                "side": (BREADTH, place),
                "wall": (BREADTH - TANK, place),
            }[plate]
            step = {"bottom": (0.0, 0.5), "side": (-0.5, 0.0), "wall": (0.5, 0.0)}[plate]
            self.at(root, *base), self.at(tip, base[0] + step[0], base[1] + step[1])
            self.mirror(root, tip)
            line = self.member(f"stiffener{k}", root, tip)
            (s.vertical if along == "y" else s.horizontal)(line, name=f"stiffener{k}_set")
            s.incident(s.entity(root), s.entity(plate), name=f"stiffener{k}_on_{plate}")
            s.distance(s.entity(root), s.entity(tip), 0.5, name=f"stiffener{k}_height")
            if self.has("e") or k % 2:
                datum = "center" if plate == "bottom" else "bottom"
                s.distance(s.entity(root), s.entity(datum), place, name=f"stiffener{k}_place")

    def brackets(self) -> None:
        """A rigid bracket touching three plates (numeric, c) and a brace of four bars
        (extended)."""
        s = self.s
        x = BREADTH - TANK
        corners = {"knee_a": (x, 17.4), "knee_b": (BREADTH, 18.4), "knee_c": (14.7, DEPTH)}
        for name, place in corners.items():
            self.at(name, *place)
        for (a, p), (b, q) in _pairs(list(corners.items())):
            s.distance(s.entity(a), s.entity(b), round(math.dist(p, q), 6), name=f"{a}_{b}")
        for name, plate in zip(corners, ("wall", "side", "deck"), strict=True):
            s.incident(s.entity(name), s.entity(plate), name=f"{name}_on_{plate}")
        bars = {
            "brace_a": ((x, 3.1), "wall"),
            "brace_b": ((15.62, BOTTOM), "inner"),
            "brace_c": ((BREADTH, 9.96), "side"),
            "brace_d": ((13.97, DECK), "shelf"),
        }
        for name, (place, plate) in bars.items():
            self.at(name, *place)
            s.incident(s.entity(name), s.entity(plate), name=f"{name}_on_{plate}")
        for a, b in (
            ("brace_a", "brace_b"),
            ("brace_b", "brace_c"),
            ("brace_c", "brace_d"),
            ("brace_d", "brace_a"),
        ):
            s.distance(
                s.entity(a),
                s.entity(b),
                round(math.dist(bars[a][0], bars[b][0]), 6),
                name=f"{a}_{b}",
            )
        self.mirror(*corners, *bars)
        for plate in ("bottom", "side", "inner"):
            line = s.entity(plate)
            place = 0.5 * (line.ends[0].position + line.ends[1].position)
            s.midpoint(self.at(f"butt_{plate}", *place), line, name=f"butt_of_{plate}")


def _pairs(items: list) -> list:
    return [(items[i], items[j]) for i in range(len(items)) for j in range(i + 1, len(items))]


def midship(stage: str) -> Sketch:
    """The midship section at one of the paper's stages b to e."""
    m = Midship(stage)
    m.hull()
    if m.has("c"):
        m.girders()
    if m.has("d"):
        m.stiffeners()
    if m.has("e"):
        m.brackets()
    return m.s


def bar_in_box(*, length_known: bool) -> Sketch:
    """Fig. 4: a bar of thickness t in a box W by H, its length given (three contacts) or not
    (four)."""
    s = Sketch()
    for name, value in (("W", 10.0), ("H", 6.0), ("t", 1.0)):
        s.parameter(name, value)
    lines = {
        "left": ((0, 0), (0, 1)),
        "bottom": ((0, 0), (1, 0)),
        "right": ((10, 0), (10, 1)),
        "top": ((0, 6), (1, 6)),
    }
    left, bottom, right, top = (s.line(*ends, name=name) for name, ends in lines.items())
    s.distance(left, right, "W", name="width")
    s.distance(bottom, top, "H", name="height")
    s.fix(left, name="left_fixed")
    s.fix(bottom, name="bottom_fixed")
    d = np.array([math.cos(0.5), math.sin(0.5)])
    m = np.array([-d[1], d[0]])
    if length_known:
        s.parameter("L", 10.0)
        foot = np.array([0.5, 0.3])
        ends = [
            s.line(foot + k * d, foot + k * d + m, name=n)
            for k, n in ((0.0, "near"), (10.0, "far"))
        ]
        s.distance(*ends, "L", name="length")
        places = [foot, foot + 10.0 * d, foot + 10.0 * d + m, foot + m]
        p = [s.point(*q, name=f"P{i}") for i, q in enumerate(places)]
        for i, end in ((0, 0), (3, 0), (1, 1), (2, 1)):
            s.incident(p[i], ends[end], name=f"P{i}_on_{ends[end].name}")
        s.distance(p[0], p[3], "t", name="thickness")
        s.distance(p[3], p[1], "sqrt(L**2 + t**2)", name="diagonal")
        s.distance(p[1], p[2], "t", name="thickness_far")
        contacts = ((0, bottom), (1, right), (3, left))
    else:
        foot = np.array([1.0, 0.3])
        places = [foot, foot + 9.0 * d, foot + 9.0 * d + m, foot + m]
        p = [s.point(*q, name=f"P{i}") for i, q in enumerate(places)]
        sides = [s.line(p[i], p[(i + 1) % 4], name=f"bar{i}") for i in range(4)]
        s.distance(sides[0], sides[2], "t", name="thickness")
        s.perpendicular(sides[0], sides[1], name="square_far")
        s.perpendicular(sides[0], sides[3], name="square_near")
        s.distance(p[0], p[1], driven=True, name="length")
        contacts = ((0, bottom), (1, right), (2, top), (3, left))
    for i, wall in contacts:
        s.incident(p[i], wall, name=f"P{i}_on_{wall.name}")
    return s


def extended_cluster() -> Sketch:
    """Fig. 11: three bodies and a line joined by eight edges; no smaller part is rigid."""
    s = Sketch()
    centers = {"A": (0.0, 0.0), "B": (6.0, 0.5), "C": (2.5, 5.0)}
    place, point = {}, {}
    for k, (name, c) in enumerate(centers.items()):
        for i in range(3):
            angle = 2.0 * math.pi * i / 3.0 + 0.4 * k
            key = f"{name}{i}"
            place[key] = np.array(c) + 1.3 * np.array([math.cos(angle), math.sin(angle)])
            point[key] = s.point(*place[key], name=key)
    inside = [(f"{n}{i}", f"{n}{(i + 1) % 3}") for n in centers for i in range(3)]
    between = [("A0", "C0"), ("A1", "C2"), ("B1", "C0"), ("B0", "C1"), ("A0", "B2")]
    for a, b in inside + between:
        s.distance(point[a], point[b], float(np.linalg.norm(place[a] - place[b])), name=f"{a}{b}")
    line = s.line((-2.0, -2.5), (8.0, -1.5), name="L6")
    for key in ("A2", "B2", "C1"):
        s.distance(point[key], line, name=f"{key}L6")
    jitter(s, 0.05)
    return s


def under_constrained() -> Sketch:
    """Fig. 12: 18 points, 30 distances, six degrees of freedom left: a ring of six triangles."""
    s = Sketch()
    place, point = {}, {}
    for k in range(6):
        middle = 4.0 * np.array([math.cos(math.pi * k / 3.0), math.sin(math.pi * k / 3.0)])
        for i in range(3):
            angle = math.pi * k / 3.0 + 2.0 * math.pi * i / 3.0 + 0.3
            key = f"P{3 * k + i + 1}"
            place[key] = middle + 1.1 * np.array([math.cos(angle), math.sin(angle)])
            point[key] = s.point(*place[key], name=key)
    names = list(place)
    edges = [(3 * k + i, 3 * k + (i + 1) % 3) for k in range(6) for i in range(3)]
    for k in range(6):
        j = (k + 1) % 6
        edges += [(3 * k, 3 * j), (3 * k + 1, 3 * j + 2)]
    for a, b in edges:
        span = float(np.linalg.norm(place[names[a]] - place[names[b]]))
        s.distance(point[names[a]], point[names[b]], span, name=f"d{a + 1}_{b + 1}")
    jitter(s, 0.1)
    return s


def under_constrained_prism() -> Sketch:
    """The counts of Fig. 12 without a body to begin with: two rings of nine, spokes and three chords."""
    s, n = Sketch(), 9
    random = np.random.default_rng(0)
    turn = 2.0 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    place = np.concatenate([3.0 * ring, 4.5 * ring]) + random.uniform(-0.2, 0.2, (2 * n, 2))
    point = [s.point(*q, name=f"P{i}") for i, q in enumerate(place, 1)]
    edges = [(k, (k + 1) % n) for k in range(n)] + [(n + k, n + (k + 1) % n) for k in range(n)]
    edges += [(k, n + k) for k in range(n)] + [(0, 4), (2, 6), (12, 16)]
    for a, b in edges:
        span = float(np.linalg.norm(place[a] - place[b]))
        s.distance(point[a], point[b], span, name=f"d{a + 1}_{b + 1}")
    jitter(s, 0.1)
    return s


def under_constrained_cycles() -> Sketch:
    """The counts of Fig. 12 and the course of Fig. 16: three times four points tied to two others (a rigid figure
    but for one distance, without a triangle), in a ring of two distances each."""
    s = Sketch()
    place, point = {}, {}
    shape = [(-1.5, 0.0), (1.5, 0.2), (0.1, -1.6), (0.2, -0.5), (-0.1, 0.7), (0.1, 1.8)]
    random = np.random.default_rng(3)
    for k in range(3):
        turn = 2.0 * math.pi * k / 3.0
        middle = 6.0 * np.array([math.cos(turn), math.sin(turn)])
        for i, q in enumerate(shape):
            key = f"P{6 * k + i + 1}"
            place[key] = middle + np.array(q) + random.uniform(-0.15, 0.15, 2)
            point[key] = s.point(*place[key], name=key)
    edges = [(6 * k + a, 6 * k + b) for k in range(3) for a in (0, 1) for b in (2, 3, 4, 5)]
    for k in range(3):
        j = (k + 1) % 3
        edges += [(6 * k + 2, 6 * j + 3), (6 * k + 4, 6 * j + 5)]
    names = list(place)
    for a, b in edges:
        span = float(np.linalg.norm(place[names[a]] - place[names[b]]))
        s.distance(point[names[a]], point[names[b]], span, name=f"d{a + 1}_{b + 1}")
    jitter(s, 0.1)
    return s


CHANGES = {"B": 16.6, "D": 19.4, "h": 2.2, "w": 2.5, "r": 1.9, "t": 11.2}
"""[m] The design change (f): breadth, depth, double bottom, wing tank, bilge radius, second deck."""


def pictures() -> None:
    """Draws the solved stages (b) to (e), and (f) after the design change."""
    folder = HERE / "pictures"
    for stage in "bcde":
        sketch = Sketch.load(HERE / f"midship_{stage}.yaml")
        result = sketch.solve()
        title = f"({stage}) {result.status}, freedom {result.freedom}"
        write_svg(sketch, folder / f"midship_{stage}.svg", title=title)
    for name, value in CHANGES.items():
        sketch.set(name, value)
    result = sketch.solve()
    write_svg(
        sketch, folder / "midship_f.svg", title=f"(f) six dimensions changed, {result.status}"
    )


def main() -> None:
    for stage in "bcde":
        sketch = midship(stage)
        jitter(sketch, 0.04)
        sketch.save(HERE / f"midship_{stage}.yaml")
    bar_in_box(length_known=True).save(HERE / "bar_in_box.yaml")
    bar_in_box(length_known=False).save(HERE / "bar_length.yaml")
    extended_cluster().save(HERE / "extended_cluster.yaml")
    under_constrained().save(HERE / "under_constrained.yaml")
    under_constrained_prism().save(HERE / "under_constrained_prism.yaml")
    under_constrained_cycles().save(HERE / "under_constrained_cycles.yaml")
    pictures()


if __name__ == "__main__":
    main()
