"""Sketches as users draw them, roughly and with what they forget or say twice; the truth is counted by hand.

Every builder returns a sketch; the table says its verdict and its freedoms beyond placing the whole.
"""

import math

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.faults import DegenerateSketch


def ring(s, places, closed=True):
    """Points and the segments between them."""
    p = [s.point(*q) for q in places]
    ends = list(zip(p, p[1:] + p[:1], strict=True))
    return p, [s.segment(*e) for e in (ends if closed else ends[:-1])]


def rectangle(w=None, h=None, square=3, rough=0.1):
    s = Sketch()
    p, e = ring(s, [(0, 0), (4 + rough, rough), (4, 2.5), (-rough, 2.4)])
    for i in range(square):
        s.perpendicular(e[i], e[(i + 1) % 4], name=f"square{i}")
    if w:
        s.distance(p[0], p[1], w, name="w")
    if h:
        s.distance(p[1], p[2], h, name="h")
    return s, p, e


def rectangle_free():
    return rectangle()[0]


def rectangle_given():
    return rectangle(4.0, 2.0)[0]


def rectangle_four_right_angles():
    return rectangle(4.0, 2.0, square=4)[0]


def rectangle_and_its_diagonal():
    s, p, _ = rectangle(4.0, 3.0)
    s.distance(p[0], p[2], 5.0, name="diagonal")
    return s


def rectangle_and_a_wrong_diagonal():
    s, p, _ = rectangle(4.0, 3.0)
    s.distance(p[0], p[2], 5.5, name="diagonal")
    return s


def rectangle_by_parallels_and_equal_diagonals():
    """Three points, closed as a parallelogram; equal diagonals make it a rectangle."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0.2), (4.1, 2.0), (0, 2.1)])
    s.parallel(e[0], e[2]), s.parallel(e[1], e[3])
    s.equal_length(s.line(p[0], p[2]), s.line(p[1], p[3]))
    return s


def rectangle_level():
    """Horizontal and vertical sides, whose distances are given; a corner fixed."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0.2), (4.1, 2.0), (0, 2.1)])
    s.horizontal(e[0]), s.horizontal(e[2]), s.vertical(e[1]), s.vertical(e[3])
    s.fix(p[0]), s.distance(e[0], e[2], 2.0), s.distance(e[1], e[3], 4.0)
    return s


def rectangle_level_and_square():
    s = rectangle_level()
    lines = [e for e in s.entities.values() if e.what == "segment"]
    s.perpendicular(lines[0], lines[1], name="again")
    return s


def centred_rectangle():
    """Both diagonals have one middle, which is fixed: a parallelogram; a right angle, one side."""
    s = Sketch()
    p, e = ring(s, [(-2, -1), (2.1, -1), (2, 1.1), (-2, 1)])
    m = s.point(0, 0)
    s.fix(m), s.midpoint(m, p[0], p[2]), s.midpoint(m, p[1], p[3])
    s.perpendicular(e[0], e[1]), s.distance(p[0], p[1], 4.0)
    return s


def square_by_equal_sides():
    s, _, e = rectangle(3.0)
    s.equal_length(e[0], e[1])
    return s


def rhombus():
    s = Sketch()
    p, e = ring(s, [(0, 0), (2, 0.3), (2.9, 2), (1, 1.8)])
    for k in (1, 2, 3):
        s.equal_length(e[0], e[k])
    s.distance(p[0], p[1], 2.0)
    return s


def rhombus_whose_diagonals_cross_at_right_angles():
    s = rhombus()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.perpendicular(s.line(p[0], p[2]), s.line(p[1], p[3]), name="crossing")
    return s


def triangle_of_three_angles():
    """Two angles and a side; the third angle follows."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0), (1.2, 2.6)])
    for i in range(3):
        s.angle(e[i], e[(i + 1) % 3], 2.0 * math.pi / 3.0, name=f"angle{i}")
    s.distance(p[0], p[1], 4.0)
    return s


def triangle_of_three_wrong_angles():
    s = Sketch()
    _, e = ring(s, [(0, 0), (4, 0), (1.2, 2.6)])
    for i in range(3):
        s.angle(e[i], e[(i + 1) % 3], 2.0, name=f"angle{i}")
    return s


def triangle_that_cannot_close():
    s = Sketch()
    p, _ = ring(s, [(0, 0), (4, 0), (1.2, 2.6)])
    s.distance(p[0], p[1], 7.0, name="long")
    s.distance(p[1], p[2], 3.0, name="b"), s.distance(p[2], p[0], 3.0, name="c")
    return s


def triangle_with_its_medians_through_a_point():
    """Three medians meet: the third incidence follows."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0), (1.2, 2.6)])
    for k, span in enumerate((4.0, 4.1, 3.0)):
        s.distance(p[k], p[(k + 1) % 3], span)
    g = s.point(1.7, 0.9)
    for k in range(3):
        m = s.point(*(0.5 * (p[(k + 1) % 3].position + p[(k + 2) % 3].position)))
        s.midpoint(m, e[(k + 1) % 3])
        s.incident(g, s.line(p[k], m), name=f"median{k}")
    return s


def right_angle_in_a_half_circle():
    """Thales: a point on the circle over a diameter sees it at a right angle."""
    s = Sketch()
    a, b, c = s.point(-2, 0), s.point(2, 0), s.point(0.7, 1.8)
    m = s.point(0.1, 0)
    s.midpoint(m, a, b), s.distance(a, b, 4.0)
    k = s.circle(m, 2.1)
    s.incident(a, k), s.incident(c, k)
    s.perpendicular(s.line(a, c), s.line(b, c), name="thales")
    return s


def slot(given=True, level=False):
    s = Sketch()
    c, d = s.point(0, 0), s.point(3, 0.1)
    a = [s.point(x, y) for x, y in ((0, -1), (3, -1), (3, 1), (0, 1))]
    low, high = s.segment(a[0], a[1]), s.segment(a[2], a[3])
    left, right = s.arc(c, a[3], a[0]), s.arc(d, a[1], a[2])
    for line in (low, high):
        s.tangent(line, left), s.tangent(line, right)
    s.equal_radius(left, right)
    if given:
        s.radius(left, 0.9), s.distance(c, d, 3.2)
    if level:
        s.parallel(low, high, name="alike")
    return s


def slot_free():
    return slot(False)


def slot_given():
    return slot()


def slot_with_parallel_sides():
    """Equal radii make them parallel already."""
    return slot(level=True)


def keyhole():
    """A circle and a slot's end below it on two parallel tangents."""
    s = Sketch()
    c = s.circle((0, 0), 2.0)
    m = s.point(0.1, -5)
    a, b = s.point(-1, -5), s.point(1, -5)
    end = s.arc(m, a, b)
    p, q = s.point(-1, -1.7), s.point(1, -1.7)
    s.incident(p, c), s.incident(q, c)
    low, high = s.segment(p, a), s.segment(b, q)
    s.tangent(low, end), s.tangent(high, end), s.parallel(low, high)
    s.radius(c, 2.0), s.radius(end, 1.0), s.distance(c.center, m, 5.0)
    s.distance(c.center, low, 1.0)
    return s


def rounded_rectangle():
    """Four equal fillets; width, depth and radius are free."""
    from scenes.sketches.make_zones import rounded

    return rounded((0, 0), (6, 4), 0.5)


def rounded_rectangle_held():
    """Its sides are parallel already when their distances are given."""
    from scenes.sketches.make_zones import rounded

    return rounded((0, 0), (6, 4), 0.5, held=True)


def fillet_of_given_radius_in_a_given_corner(extra=False):
    s = Sketch()
    o, x, y = s.point(0, 0), s.point(5, 0), s.point(0, 4)
    e, f = s.line(o, x), s.line(o, y)
    s.fix(o), s.fix(x), s.fix(y)
    c = s.circle((1.2, 0.9), 1.0)
    s.tangent(e, c), s.tangent(f, c), s.radius(c, 1.1)
    if extra:
        s.distance(c.center, e, 1.1, name="height")
    return s


def fillet_and_its_height():
    return fillet_of_given_radius_in_a_given_corner(True)


def bracket():
    """An L of six sides, all at right angles, four lengths given."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (5, 0.1), (5, 1), (1, 1.1), (1, 4), (0, 4)])
    for i in range(5):
        s.perpendicular(e[i], e[i + 1])
    for k, span in ((0, 5.0), (1, 1.0), (4, 1.0), (5, 4.0)):
        s.distance(p[k], p[(k + 1) % 6], span)
    return s


def bracket_with_all_six_lengths():
    s = bracket()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.distance(p[2], p[3], 4.0, name="inner"), s.distance(p[3], p[4], 3.0, name="upper")
    return s


def bracket_with_a_wrong_inner_length():
    s = bracket()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.distance(p[2], p[3], 3.7, name="inner")
    return s


def bracket_with_holes():
    s = bracket()
    e = [k for k in s.entities.values() if k.what == "segment"]
    a, b = s.circle((4, 0.5), 0.2), s.circle((0.5, 3), 0.25)
    s.equal_radius(a, b), s.diameter(a, 0.5)
    s.distance(a.center, e[0], 0.5), s.distance(a.center, e[1], 1.0)
    s.distance(b.center, e[5], 0.5), s.distance(b.center, e[4], 1.0)
    return s


def mirrored_half():
    """Half an outline and its mirror image in a vertical axis; two dimensions lack."""
    s = Sketch()
    axis = s.line((0, 0), (0, 1))
    s.fix(axis)
    half = [s.point(x, y) for x, y in ((1, 0), (2, 1), (1.5, 3), (0.5, 3.2))]
    other = [s.point(-x + 0.1, y) for x, y in ((1, 0), (2, 1), (1.5, 3), (0.5, 3.2))]
    for p, q in zip(half, other, strict=True):
        s.symmetric(p, q, axis)
    for p, q in zip(half, half[1:], strict=False):
        s.distance(p, q)
    s.distance(half[0], axis, 1.0), s.distance(half[3], axis, 0.6)
    s.distance(half[1], axis, 2.0)
    return s


def mirrored_half_measured_on_both_sides():
    s = mirrored_half()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.distance(p[4], p[5], math.sqrt(2.0), name="other_side")
    return s


def gear(teeth=8, said_twice=False):
    """Tips and roots on two circles, every flank as long as the first, every tip too."""
    s = Sketch()
    m = s.point(0, 0)
    outer, inner = s.circle(m, 3.0), s.circle(m, 2.2)
    p = []
    for k in range(4 * teeth):
        r = 3.0 if k % 4 in (1, 2) else 2.2
        t = 2.0 * math.pi * (k + (0.03 if k % 3 else -0.02)) / (4 * teeth)
        q = s.point(r * math.cos(t), r * math.sin(t))
        s.incident(q, outer if r == 3.0 else inner)
        p.append(q)
    e = [s.segment(p[k], p[(k + 1) % len(p)]) for k in range(len(p))]
    for k in range(4, len(e)):
        if k < len(e) - 1 or said_twice:
            s.equal_length(e[k % 4], e[k])
    s.equal_length(e[0], e[2])
    s.radius(outer, 3.0), s.radius(inner, 2.2)
    return s


def gear_outline():
    """32 points on two circles have 32 turns, of which one places it; 28 equal lengths leave three: tip and
    flank of the teeth, and the last tooth's root, which is not like the others."""
    return gear()


def gear_with_all_teeth_alike():
    """Then the last root follows from the others, and is said to be like them: tip or root is left, and flank."""
    return gear(said_twice=True)


def four_bar():
    s = Sketch()
    p, _ = ring(s, [(0, 0), (1, 2), (4, 3), (5, 0)])
    for k, span in enumerate((2.0, 3.5, 3.0)):
        s.distance(p[k], p[k + 1], span)
    s.fix(p[0]), s.fix(p[3])
    return s


def four_bar_over_fixed_ends():
    """The two fixed ends have their distance already."""
    s = four_bar()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.distance(p[0], p[3], 5.0, name="base")
    return s


def slider_crank():
    s = Sketch()
    o, c, b = s.point(0, 0), s.point(1, 1), s.point(4, 0.1)
    rail = s.line((0, 0), (1, 0))
    s.fix(o), s.fix(rail), s.distance(o, c, 1.5), s.distance(c, b, 3.5), s.incident(b, rail)
    return s


def scissors():
    """Two equal bars that cross in their middles."""
    s = Sketch()
    a, b, c, d = (s.point(*q) for q in ((0, 0), (3, 2), (0, 2), (3, 0.1)))
    m = s.point(1.5, 1)
    s.midpoint(m, a, b), s.midpoint(m, c, d), s.distance(a, b, 3.6), s.distance(c, d, 3.6)
    return s


def scissors_whose_feet_are_level_as_well_as_the_tops():
    s = scissors()
    p = [e for e in s.entities.values() if e.what == "point"]
    s.horizontal(p[0], p[3]), s.horizontal(p[2], p[1], name="tops")
    return s


def peaucellier():
    """The inversor: seven bars of three lengths; its point runs on a straight line."""
    s = Sketch()
    o, q = s.point(0, 0), s.point(1.0, 0)
    c, d = s.point(3.5, 1.2), s.point(3.5, -1.2)
    b, p = s.point(2.0, 0.1), s.point(5.0, 0.1)
    s.fix(o), s.fix(q)
    for x, y, span in (
        (o, c, 3.7),
        (o, d, 3.7),
        (c, b, 1.9),
        (d, b, 1.9),
        (c, p, 1.9),
        (d, p, 1.9),
    ):
        s.distance(x, y, span)
    s.distance(q, b, 1.0)
    return s


def peaucellier_on_its_line():
    """That it runs on that line is a theorem, which no count sees."""
    s = peaucellier()
    p = [e for e in s.entities.values() if e.what == "point"]
    rail = s.line((0.5 * (3.7**2 - 1.9**2), 0.0), (0.5 * (3.7**2 - 1.9**2), 1.0))
    s.fix(rail), s.incident(p[5], rail, name="on_the_line")
    return s


def belt(apart=5.0):
    """Two pulleys and the two outer tangents with their tangent points."""
    s = Sketch()
    c, d = s.circle((0, 0), 1.0), s.circle((5, 0), 2.0)
    for sign in (-1, 1):
        a, b = s.point(-0.2, sign * 1.0), s.point(4.6, sign * 2.0)
        s.incident(a, c), s.incident(b, d)
        line = s.segment(a, b)
        s.tangent(line, c), s.tangent(line, d)
    s.radius(c, 1.0), s.radius(d, 2.0)
    if apart:
        s.distance(c.center, d.center, apart)
    return s


def belt_with_a_free_distance():
    return belt(None)


def chain_of_arcs():
    """An S of two arcs that meet in a point with one tangent: their centres and the joint lie in line."""
    s = Sketch()
    a, j, b = s.point(-1, 0), s.point(0, 0.02), s.point(1, 0)
    m, n = s.point(-0.5, 0), s.point(0.5, 0)
    one, two = s.arc(m, j, a), s.arc(n, j, b)
    s.tangent(one, two, inside=False)
    s.radius(one, 0.5), s.radius(two, 0.6)
    return s


def planets():
    """A sun, a ring and three planets that touch both, a third of a turn apart; sun and ring have one centre."""
    s = Sketch()
    m = s.point(0, 0)
    sun, rim = s.circle(m, 1.0), s.circle(m, 3.0)
    s.radius(sun, 1.0), s.radius(rim, 3.0)
    for k in range(3):
        t = 2.0 * math.pi * k / 3.0
        c = s.circle((2.1 * math.cos(t), 2.1 * math.sin(t)), 0.9)
        s.tangent(sun, c, inside=False), s.tangent(rim, c, inside=True)
    return s


def planets_of_equal_radius():
    """Their radius follows from sun and ring."""
    s = planets()
    c = [e for e in s.entities.values() if e.what == "circle"][2:]
    s.equal_radius(c[0], c[1], name="alike")
    return s


def incircle():
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0.1), (1.2, 2.6)])
    for k, span in enumerate((4.0, 4.1, 3.0)):
        s.distance(p[k], p[(k + 1) % 3], span)
    c = s.circle((1.6, 0.9), 0.6)
    for line in e:
        s.tangent(line, c)
    return s


def incircle_too_large():
    s = incircle()
    c = next(e for e in s.entities.values() if e.what == "circle")
    s.radius(c, 1.5, name="too_large")
    return s


def hexagon():
    """On a circle, all sides alike: six points have six turns; one places it, five equal sides."""
    s = Sketch()
    c = s.circle((0, 0), 2.0)
    p = []
    for k in range(6):
        t = math.pi * k / 3.0 + 0.05 * (-1) ** k
        p.append(s.point(2.0 * math.cos(t), 2.0 * math.sin(t)))
        s.incident(p[-1], c)
    e = [s.segment(p[k], p[(k + 1) % 6]) for k in range(6)]
    for k in range(1, 6):
        s.equal_length(e[0], e[k])
    return s


def hexagon_whose_sides_are_the_radius():
    s = hexagon()
    p = [e for e in s.entities.values() if e.what == "point"]
    c = next(e for e in s.entities.values() if e.what == "circle")
    s.radius(c, 2.0), s.distance(p[1], p[2], 2.0, name="side")
    return s


def coincident_chain():
    """Segments with ends of their own, joined one by one, the last joint said twice."""
    s = Sketch()
    e = []
    for k in range(3):
        t, u = 2.1 * k, 2.1 * (k + 1)
        ends = (s.point(math.cos(t), math.sin(t)), s.point(math.cos(u) + 0.05, math.sin(u)))
        e.append(s.segment(*ends))
        s.distance(*ends, 1.7)
    for k in range(3):
        s.coincident(e[k].ends[1], e[(k + 1) % 3].ends[0])
    return s


def coincident_twice():
    s = coincident_chain()
    e = [k for k in s.entities.values() if k.what == "segment"]
    s.coincident(e[1].ends[0], e[0].ends[1], name="again")
    return s


def lone_point():
    s = coincident_chain()
    s.point(5, 5)
    return s


def two_pieces():
    """Two rigid triangles: the second may lie anywhere."""
    s = Sketch()
    for x in (0.0, 6.0):
        p, _ = ring(s, [(x, 0), (x + 4, 0), (x + 1.2, 2.6)])
        for k, span in enumerate((4.0, 4.1, 3.0)):
            s.distance(p[k], p[(k + 1) % 3], span)
    return s


def parallel_rails():
    """Five parallel lines at equal given gaps, and the outer distance again."""
    s = Sketch()
    e = [s.line((0, k), (5, k + 0.05 * k)) for k in range(5)]
    for k in range(4):
        s.distance(e[k], e[k + 1], 1.0)
    s.distance(e[0], e[4], 4.0, name="outer")
    return s


def parallel_rails_with_a_wrong_outer_distance():
    s = parallel_rails()
    s.set("outer", 4.5)
    return s


def truss():
    """A triangulated girder of eight bays, top and bottom chord level."""
    s = Sketch()
    low = [s.point(k, 0.02 * k) for k in range(9)]
    high = [s.point(k + 0.5, 0.9) for k in range(8)]
    for a, b in zip(low, low[1:], strict=False):
        s.distance(a, b, 1.0), s.horizontal(a, b)
    for k, h in enumerate(high):
        s.distance(h, low[k], 1.0), s.distance(h, low[k + 1], 1.0)
    return s


def truss_with_a_level_top():
    s = truss()
    p = [e for e in s.entities.values() if e.what == "point"]
    for k in range(7):
        s.horizontal(p[9 + k], p[10 + k])
    return s


def desargues():
    """Two triangles in perspective from a point: the three meets of their sides lie on a line, by theorem."""
    s = Sketch()
    o = s.point(0, 0)
    turns, near, far = (0.3, 1.2, 2.3), (2.0, 1.5, 2.2), (4.0, 4.2, 3.6)
    a = [s.point(r * math.cos(t), r * math.sin(t)) for r, t in zip(near, turns, strict=True)]
    b = [s.point(r * math.cos(t), r * math.sin(t)) for r, t in zip(far, turns, strict=True)]
    for p, q in zip(a, b, strict=True):
        s.incident(p, s.line(o, q))
        s.distance(o, p), s.distance(o, q)
    s.distance(b[0], b[1]), s.distance(b[1], b[2])
    meets = []
    for i in range(3):
        j = (i + 1) % 3
        e, f = s.line(a[i], a[j]), s.line(b[i], b[j])
        m = np.linalg.solve(
            [[-e.direction[1], e.direction[0]], [-f.direction[1], f.direction[0]]],
            [e.offset, f.offset],
        )
        meets.append(s.point(*m))
        s.incident(meets[-1], e), s.incident(meets[-1], f)
    return s, meets


def desargues_points():
    return desargues()[0]


def desargues_line():
    s, meets = desargues()
    s.incident(meets[2], s.line(meets[0], meets[1]), name="desargues")
    return s


TRUTH = {
    rectangle_free: ("under", 2),
    rectangle_given: ("well", 0),
    rectangle_four_right_angles: ("over", 0),
    rectangle_and_its_diagonal: ("over", 0),
    rectangle_and_a_wrong_diagonal: ("inconsistent", None),
    rectangle_by_parallels_and_equal_diagonals: ("under", 2),
    rectangle_level: ("well", 0),
    rectangle_level_and_square: ("over", 0),
    centred_rectangle: ("under", 1),
    square_by_equal_sides: ("well", 0),
    rhombus: ("under", 1),
    rhombus_whose_diagonals_cross_at_right_angles: ("over", 1),
    triangle_of_three_angles: ("over", 0),
    triangle_of_three_wrong_angles: ("inconsistent", None),
    triangle_that_cannot_close: ("inconsistent", None),
    triangle_with_its_medians_through_a_point: ("over", 0),
    right_angle_in_a_half_circle: ("over", 1),
    slot_free: ("under", 2),
    slot_given: ("well", 0),
    slot_with_parallel_sides: ("over", 0),
    keyhole: ("well", 0),
    rounded_rectangle: ("under", 2),
    rounded_rectangle_held: ("well", 0),
    fillet_of_given_radius_in_a_given_corner: ("well", 0),
    fillet_and_its_height: ("over", 0),
    bracket: ("well", 0),
    bracket_with_all_six_lengths: ("over", 0),
    bracket_with_a_wrong_inner_length: ("inconsistent", None),
    bracket_with_holes: ("well", 0),
    mirrored_half: ("under", 1),
    mirrored_half_measured_on_both_sides: ("over", 1),
    gear_outline: ("under", 3),
    gear_with_all_teeth_alike: ("under", 2),
    four_bar: ("under", 1),
    four_bar_over_fixed_ends: ("over", 1),
    slider_crank: ("under", 1),
    scissors: ("under", 1),
    scissors_whose_feet_are_level_as_well_as_the_tops: ("over", 1),
    peaucellier: ("under", 1),
    peaucellier_on_its_line: ("over", 1),
    belt: ("well", 0),
    belt_with_a_free_distance: ("under", 1),
    chain_of_arcs: ("under", 2),
    planets: ("under", 2),
    planets_of_equal_radius: ("over", 2),
    incircle: ("well", 0),
    incircle_too_large: ("inconsistent", None),
    hexagon: ("under", 1),
    hexagon_whose_sides_are_the_radius: ("over", 0),
    coincident_chain: ("well", 0),
    coincident_twice: ("over", 0),
    lone_point: ("under", 2),
    two_pieces: ("under", 3),
    parallel_rails: ("over", 0),
    parallel_rails_with_a_wrong_outer_distance: ("inconsistent", None),
    truss: ("well", 0),
    truss_with_a_level_top: ("over", 0),
    desargues_points: ("well", 0),
    desargues_line: ("over", 0),
}


@pytest.mark.parametrize("drawn", TRUTH, ids=lambda f: f.__name__)
def test_verdict_and_freedom(drawn):
    status, freedom = TRUTH[drawn]
    s = drawn()
    result = s.solve()
    assert result.status == status, (result.redundant, result.reason)
    if freedom is None:
        check_conflict(s, result.conflicts)
        return
    assert result.residual <= 1e-12 * 10.0 or result.redundant
    assert result.freedom == freedom
    before = list(s._numbers)
    assert s.solve().solved and s._numbers == before
    for name in result.redundant:
        assert without(s, name).solve().freedom == freedom
    if status == "over":
        assert result.redundant


def without(s, *names):
    """The sketch without some constraints."""
    t = Sketch()
    for name, e in s.entities.items():
        if e.what == "point":
            t.point(*e.position, name=name)
    for name, e in s.entities.items():
        if e.what in ("line", "segment"):
            foot = e.offset * np.array([-e.direction[1], e.direction[0]])
            t.line(foot, foot + e.direction, name=name)
            t.entity(name).ends = tuple(t.entity(p.name) for p in e.ends) if e.ends else None
        elif e.what in ("circle", "arc"):
            t.circle(t.entity(e.center.name), e.radius, name=name)
    for name, c in s.constraints.items():
        if name not in names and not c.driven:
            value = c.number if c.given is not None else None
            t.add(c.kind, *(e.name for e in c.entities), value=value, name=name, **c.options)
    return t


def check_conflict(s, names):
    """No place is found for the conflict, from the drawing or near it, and one for it without any one member."""
    assert names
    rest = [n for n in s.constraints if n not in names]
    assert not found(s, rest, 3)
    for name in names:
        assert found(s, [*rest, name], 60), name


def found(s, names, attempts):
    """Whether the sketch without some constraints is solved, drawn as it is or shaken."""
    for k in range(attempts):
        t, random = without(s, *names), np.random.default_rng(k)
        t._numbers[:] = [v + random.uniform(-0.1, 0.1) * k for v in t._numbers]
        try:
            if t.solve().solved:
                return True
        except DegenerateSketch:
            continue
    return False
