"""Sketches where constraints only touch: held, though not in the first order. Their truth is by construction."""

import math

import numpy as np
import pytest

from clearance.sketch import Sketch


def verdict(s):
    result = s.solve()
    assert result.solved, result.reason
    return result.status, result.freedom, result.redundant


def fillet():
    """Two lines at an angle and an arc of radius 1 that touches both."""
    s, half = Sketch(), 0.35 * math.pi
    reach = 1.0 / math.tan(half)
    d, e = np.array([1.0, 0.0]), np.array([math.cos(2.0 * half), math.sin(2.0 * half)])
    o = s.point(0.0, 0.0, name="o")
    p, q = s.point(*(5.0 * d), name="p"), s.point(*(4.0 * e), name="q")
    a, b = s.point(*(reach * d), name="a"), s.point(*(reach * e), name="b")
    arc = s.arc(s.point(reach, 1.0, name="c"), b, a, name="round")
    one, other = s.line(o, p), s.line(o, q)
    s.incident(a, one), s.incident(b, other)
    s.tangent(one, arc, name="t1"), s.tangent(other, arc, name="t2")
    s.radius(arc, 1.0)
    return s


def test_one_contact_said_twice_is_implied():
    """The radius to the tangent point is perpendicular already."""
    s = fillet()
    spoke = s.line(s.entity("c"), s.entity("a"), name="spoke")
    s.perpendicular(spoke, s.entity("line1"), name="square")
    status, freedom, redundant = verdict(s)
    assert status == "over" and len(redundant) == 1
    assert freedom == verdict(fillet())[1]


def test_a_flat_four_bar_linkage_has_one_freedom():
    """Where its two branches meet the kernel has two motions; every solution near it has one."""
    s = Sketch()
    p = [s.point(x, 0.0) for x in (0.0, 1.0, 3.0, 4.0)]
    for i, j, span in ((0, 1, 1.0), (1, 2, 2.0), (2, 3, 1.0), (0, 3, 2.0)):
        s.distance(p[i], p[j], span)
    p[3].sketch._lists.numbers[p[3].variable] = 2.0
    p[2].sketch._lists.numbers[p[2].variable] = 3.0
    assert verdict(s) == ("under", 1, [])


def test_circles_that_touch_in_a_row():
    """Three circles in a chain on one line, each tangent to the next: the middle radius follows."""
    s = Sketch()
    x = s.line((0, 0), (1, 0), name="x")
    c = [s.circle((k, 0.01), r) for k, r in ((0.0, 1.0), (2.0, 0.9), (4.0, 1.1))]
    s.fix(x)
    for k in c:
        s.incident(k.center, x)
    s.tangent(c[0], c[1]), s.tangent(c[1], c[2])
    s.radius(c[0], 1.0), s.radius(c[2], 1.0), s.distance(c[0].center, c[2].center, 4.0)
    assert verdict(s) == ("well", 0, [])
    assert c[1].radius == pytest.approx(1.0)
    s.radius(c[1], 1.0, name="again")
    assert verdict(s)[:2] == ("over", 0)
