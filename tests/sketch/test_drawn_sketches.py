"""Sketches as users draw them, roughly and with what they forget or say twice; the truth is counted by hand.

The table says of each drawing its verdict and its freedoms beyond placing the whole.
"""

import math

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.faults import DegenerateSketch
from tests.sketch.patterns import again


def ring(s, places):
    """Points and the segments between them."""
    p = [s.point(*q) for q in places]
    return p, [s.segment(*ends) for ends in zip(p, p[1:] + p[:1], strict=True)]


def of_kind(s, what):
    """The entities of a kind, in the order in which they were drawn."""
    return [e for e in s.entities.values() if e.what == what]


def rectangle_of_equal_sides():
    """Level and upright sides: opposite ones are as long as each other, though no count of equations sees it."""
    s = Sketch()
    p, e = ring(s, [(0, 0), (1.1, 0), (1, 1.2), (0, 1)])
    s.fix(p[0]), s.horizontal(e[0]), s.horizontal(e[2]), s.vertical(e[1]), s.vertical(e[3])
    s.equal_length(e[0], e[2], name="alike")
    s.distance(p[0], p[1], 1.5, name="w"), s.distance(p[1], p[2], 2.0, name="h")
    return s


def rectangle_of_equal_sides_and_a_wrong_one():
    s = rectangle_of_equal_sides()
    p = of_kind(s, "point")
    s.distance(p[2], p[3], 1.6, name="top")
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


def slot():
    s = Sketch()
    c, d = s.point(0, 0), s.point(3, 0.1)
    a = [s.point(x, y) for x, y in ((0, -1), (3, -1), (3, 1), (0, 1))]
    low, high = s.segment(a[0], a[1]), s.segment(a[2], a[3])
    left, right = s.arc(c, a[3], a[0]), s.arc(d, a[1], a[2])
    for line in (low, high):
        s.tangent(line, left), s.tangent(line, right)
    s.equal_radius(left, right), s.radius(left, 0.9), s.distance(c, d, 3.2)
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
    p = of_kind(s, "point")
    rail = s.line((0.5 * (3.7**2 - 1.9**2), 0.0), (0.5 * (3.7**2 - 1.9**2), 1.0))
    s.fix(rail), s.incident(p[5], rail, name="on_the_line")
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


def coincident_twice():
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
    s.coincident(e[1].ends[0], e[0].ends[1], name="again")
    return s


def two_pieces():
    """Two rigid triangles: the second may lie anywhere."""
    s = Sketch()
    for x in (0.0, 6.0):
        p, _ = ring(s, [(x, 0), (x + 4, 0), (x + 1.2, 2.6)])
        for k, span in enumerate((4.0, 4.1, 3.0)):
            s.distance(p[k], p[(k + 1) % 3], span)
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


def square_of_equal_sides():
    s = Sketch()
    p, e = ring(s, [(0, 0), (1.1, 0), (1, 1.2), (0, 1)])
    s.fix(p[0]), s.horizontal(e[0]), s.horizontal(e[2]), s.vertical(e[1]), s.vertical(e[3])
    for i in range(3):
        s.equal_length(e[i], e[i + 1])
    s.distance(p[0], p[1], 1.5, name="w")
    return s


def flat_four_bar():
    """Where its two branches meet the kernel has two motions; every solution near it has one."""
    s = Sketch()
    p = [s.point(x, 0.0) for x in (0.0, 1.0, 3.0, 2.0)]
    for i, j, span in ((0, 1, 1.0), (1, 2, 2.0), (2, 3, 1.0), (0, 3, 2.0)):
        s.distance(p[i], p[j], span)
    return s


def fillet_and_a_spoke():
    """An arc that touches two lines at an angle: its radius to a tangent point is perpendicular already."""
    s, half = Sketch(), 0.35 * math.pi
    reach = 1.0 / math.tan(half)
    d, e = np.array([1.0, 0.0]), np.array([math.cos(2.0 * half), math.sin(2.0 * half)])
    o, p, q = s.point(0.0, 0.0), s.point(*(5.0 * d)), s.point(*(4.0 * e))
    a, b, c = s.point(*(reach * d)), s.point(*(reach * e)), s.point(reach, 1.0)
    arc, one, other = s.arc(c, b, a), s.line(o, p), s.line(o, q)
    s.incident(a, one), s.incident(b, other)
    s.tangent(one, arc), s.tangent(other, arc), s.radius(arc, 1.0)
    s.perpendicular(s.line(c, a), one, name="square")
    return s


TRUTH = {
    planets: ("under", 2),
    square_of_equal_sides: ("over", 0),
    flat_four_bar: ("under", 1),
    fillet_and_a_spoke: ("over", 3),
    rectangle_of_equal_sides: ("over", 0),
    rectangle_of_equal_sides_and_a_wrong_one: ("inconsistent", None),
    triangle_that_cannot_close: ("inconsistent", None),
    triangle_with_its_medians_through_a_point: ("over", 0),
    slot: ("well", 0),
    peaucellier: ("under", 1),
    peaucellier_on_its_line: ("over", 1),
    incircle: ("well", 0),
    coincident_twice: ("over", 0),
    two_pieces: ("under", 3),
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
    before = list(s._lists.numbers)
    assert s.solve().solved and s._lists.numbers == before
    for name in result.redundant:
        assert again(s, [name]).solve().freedom == freedom
    if status == "over":
        assert result.redundant


def test_equal_sides_of_a_rectangle_are_implied_and_not_its_height():
    s = rectangle_of_equal_sides()
    assert s.solve().redundant == ["alike"]
    s.set("h", 3.0)
    result = s.solve()
    assert (result.status, result.redundant) == ("over", ["alike"])
    corners = [p.position for p in of_kind(s, "point")]
    np.testing.assert_allclose(corners, [(0, 0), (1.5, 0), (1.5, 3), (0, 3)], atol=1e-12)


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


@pytest.mark.parametrize("seed", range(16))
def test_a_rectangle_said_twice_is_solved_in_any_order(seed):
    """Without the constraint that the count takes for implied, the others may leave a freedom, and collapse."""
    result = rectangle_said_twice(seed).solve()
    assert result.status == "over" and result.freedom == 0, result.reason


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
        t, random = again(s, names), np.random.default_rng(k)
        t._lists.numbers[:] = [v + random.uniform(-0.1, 0.1) * k for v in t._lists.numbers]
        try:
            if t.solve().solved:
                return True
        except DegenerateSketch:
            continue
    return False
