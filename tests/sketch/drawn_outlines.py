"""Outlines as users draw them, roughly and with what they forget or say twice: one builder a sketch."""

import math

import numpy as np

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


def rectangle_and_its_diagonal():
    s, p, _ = rectangle(4.0, 3.0)
    s.distance(p[0], p[2], 5.0, name="diagonal")
    return s


def rectangle_and_a_wrong_diagonal():
    s, p, _ = rectangle(4.0, 3.0)
    s.distance(p[0], p[2], 5.5, name="diagonal")
    return s


def rectangle_of_equal_sides(width=1.5, top=None):
    """Level and upright sides: opposite ones are as long as each other, though no count of equations sees it."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (1.1, 0), (1, 1.2), (0, 1)])
    s.fix(p[0]), s.horizontal(e[0]), s.horizontal(e[2]), s.vertical(e[1]), s.vertical(e[3])
    s.equal_length(e[0], e[2], name="alike")
    s.distance(p[0], p[1], width, name="w"), s.distance(p[1], p[2], 2.0, name="h")
    if top:
        s.distance(p[2], p[3], top, name="top")
    return s


def rectangle_of_equal_sides_and_a_wrong_one():
    return rectangle_of_equal_sides(top=1.6)


def square_of_equal_sides():
    s = Sketch()
    p, e = ring(s, [(0, 0), (1.1, 0), (1, 1.2), (0, 1)])
    s.fix(p[0]), s.horizontal(e[0]), s.horizontal(e[2]), s.vertical(e[1]), s.vertical(e[3])
    for i in range(3):
        s.equal_length(e[i], e[i + 1])
    s.distance(p[0], p[1], 1.5, name="w")
    return s


def parallelogram_of_equal_sides():
    s = Sketch()
    p, e = ring(s, [(0, 0), (1.1, 0), (1.4, 1.1), (0.3, 1)])
    s.fix(p[0]), s.horizontal(e[0]), s.parallel(e[0], e[2]), s.parallel(e[1], e[3])
    s.equal_length(e[0], e[2], name="alike")
    s.distance(p[0], p[1], 1.0, name="w"), s.distance(p[1], p[2], 1.0, name="h")
    s.angle(e[0], e[3], 1.2, name="lean")
    return s


def rectangle_said_twice(seed):
    """A rectangle of given sides, and up to three more constraints that hold there, all in an order by chance."""
    random = np.random.default_rng(seed)
    (w, h), s = random.uniform(0.5, 3.0, 2), Sketch()
    size = random.uniform(0.5, 3.0, 2)
    rough = random.uniform(-0.15, 0.15, (4, 2))
    p, e = ring(s, np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * size + rough)
    square = random.integers(0, 2)
    angles = [(s.perpendicular, e[i], e[i + 1]) for i in range(3)] + [(s.horizontal, e[0])]
    sides = [(s.horizontal if i % 2 == 0 else s.vertical, e[i]) for i in range(4)]
    said = [*(angles if square else sides), (s.distance, *p[:2], w), (s.distance, *p[1:3], h)]
    more = [
        (s.equal_length, e[0], e[2]),
        (s.equal_length, e[1], e[3]),
        (s.distance, p[0], p[2], float(np.hypot(w, h))),
        (s.distance, p[2], p[3], w),
        (s.distance, p[0], e[2], h),
        (s.parallel, e[1], e[3]),
    ]
    said += [more[k] for k in random.choice(6, random.integers(1, 4), replace=False)]
    for k in random.permutation(len(said)):
        add, *given = said[k]
        add(*given)
    return s


def triangle_of_three_angles():
    """Two angles and a side; the third angle follows."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (4, 0), (1.2, 2.6)])
    for i in range(3):
        s.angle(e[i], e[(i + 1) % 3], 2.0 * math.pi / 3.0, name=f"angle{i}")
    s.distance(p[0], p[1], 4.0)
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


def slot_given():
    return slot()


def fixed_rounded_rectangle():
    """Its sides are parallel already when their distances are given."""
    from scenes.sketches.make_zones import rounded

    return rounded((0, 0), (6, 4), 0.5, held=True)


def bracket():
    """An L of six sides, all at right angles, four lengths given."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (5, 0.1), (5, 1), (1, 1.1), (1, 4), (0, 4)])
    for i in range(5):
        s.perpendicular(e[i], e[i + 1])
    for k, span in ((0, 5.0), (1, 1.0), (4, 1.0), (5, 4.0)):
        s.distance(p[k], p[(k + 1) % 6], span)
    return s


def bracket_with_a_wrong_inner_length():
    s = bracket()
    p = of_kind(s, "point")
    s.distance(p[2], p[3], 3.7, name="inner")
    return s
