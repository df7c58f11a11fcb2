"""Mechanisms, circles that touch and figures of projective geometry, drawn as users draw them."""

import math

import numpy as np

from clearance.sketch import Sketch
from tests.sketch.drawn_outlines import of_kind, ring


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
    c = of_kind(s, "circle")[0]
    s.radius(c, 1.5, name="too_large")
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
    e = of_kind(s, "segment")
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


def desargues_line():
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
    s.incident(meets[2], s.line(meets[0], meets[1]), name="desargues")
    return s
