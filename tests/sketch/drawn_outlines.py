"""Outlines as users draw them, roughly and with what they forget or say twice: one builder a sketch."""

import math

from clearance.sketch import Sketch


def ring(s, places, closed=True):
    """Points and the segments between them."""
    p = [s.point(*q) for q in places]
    ends = list(zip(p, p[1:] + p[:1], strict=True))
    return p, [s.segment(*e) for e in (ends if closed else ends[:-1])]


def of_kind(s, what):
    """The entities of a kind, in the order in which they were drawn."""
    return [e for e in s.entities.values() if e.what == what]


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
    lines = of_kind(s, "segment")
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
    p = of_kind(s, "point")
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


def fixed_rounded_rectangle():
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
    p = of_kind(s, "point")
    s.distance(p[2], p[3], 4.0, name="inner"), s.distance(p[3], p[4], 3.0, name="upper")
    return s


def bracket_with_a_wrong_inner_length():
    s = bracket()
    p = of_kind(s, "point")
    s.distance(p[2], p[3], 3.7, name="inner")
    return s


def bracket_with_holes():
    s = bracket()
    e = of_kind(s, "segment")
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
    p = of_kind(s, "point")
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
