"""Random sketches of all kinds of constraints whose truth is known: entities are made to satisfy them, then
the drawing is shaken. Verdict, freedom and residual are compared with formulas that share no code."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clearance.sketch import Sketch
from tests.examples import examples
from tests.sketch.independent import Numbers
from tests.sketch.patterns import again

SOME = examples(25)


class Builder:
    """Adds entities one after another, each tied to those before by constraints that it satisfies."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        self.s = Sketch()
        a, b = self.s.point(0.0, 0.0), self.s.point(4.0, 0.3)
        self.s.distance(a, b)
        self.points, self.lines, self.circles = [a, b], [self.s.line(a, b)], []

    def pick(self, among):
        return among[self.random.integers(len(among))]

    def far_point(self):
        """A new point that is near no other and on no line."""
        while True:
            q = self.random.uniform(-6.0, 6.0, 2)
            gaps = [np.linalg.norm(q - p.position) for p in self.points]
            off = [abs(_height(q, k)) for k in self.lines]
            rims = [abs(np.linalg.norm(q - c.center.position) - c.radius) for c in self.circles]
            if min(gaps) > 1.0 and min(off) > 0.5 and min(rims, default=1.0) > 0.3:
                return q

    def point(self):
        p = self.s.point(*self.far_point())
        first = self.pick(self.points)
        others = [q for q in self.points if q is not first]
        self.s.distance(p, first)
        ways = [lambda: self.s.distance(p, self.pick(others))]
        ways.append(lambda: self.s.distance(p, self.pick(self.lines)))
        if self.circles:
            ways.append(lambda: self.s.distance(p, self.pick(self.circles)))
        self.pick(ways)()
        self.points.append(p)

    def point_on_line(self):
        line = self.pick(self.lines)
        foot = line.offset * np.array([-line.direction[1], line.direction[0]])
        p = self.s.point(*(foot + self.random.uniform(5.0, 9.0) * line.direction))
        self.s.incident(p, line), self.s.distance(p, self.pick(self.points[:2]))
        self.points.append(p)

    def line(self):
        """A line at an angle to another, at a distance from a point."""
        other, p = self.pick(self.lines), self.pick(self.points)
        kind = self.random.integers(3)
        turn = (self.random.uniform(0.4, 1.2), 0.0, 0.5 * np.pi)[kind]
        theta = np.arctan2(*other.direction[::-1]) + turn
        d, n = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        foot = p.position + self.random.uniform(1.0, 3.0) * n
        line = self.s.line(foot, foot + d)
        ways = (self.s.angle, self.s.parallel, self.s.perpendicular)
        ways[kind](other, line), self.s.distance(p, line)
        self.lines.append(line)

    def circle(self):
        """A circle that touches a line, about a new point."""
        line = self.pick(self.lines)
        center = self.far_point()
        c = self.s.circle(center, abs(_height(center, line)))
        self.s.tangent(line, c)
        p, q = self.random.permutation(len(self.points))[:2]
        self.s.distance(c.center, self.points[p]), self.s.distance(c.center, self.points[q])
        self.points.append(c.center), self.circles.append(c)

    def circle_by_circle(self):
        """A circle that touches another from outside, its radius given."""
        if not self.circles:
            return self.circle()
        other = self.pick(self.circles)
        turn = self.random.uniform(0.0, 2.0 * np.pi)
        r = self.random.uniform(0.3, 0.9)
        place = other.center.position + (other.radius + r) * np.array([np.cos(turn), np.sin(turn)])
        c = self.s.circle(place, r)
        self.s.tangent(other, c, inside=False), self.s.radius(c)
        self.s.distance(c.center, self.pick(self.points[:2]))
        self.circles.append(c)

    def mirrored(self):
        line, p = self.pick(self.lines), self.pick(self.points)
        h = _height(p.position, line)
        if abs(h) < 0.3:
            return self.point()
        q = self.s.point(
            *(p.position - 2.0 * h * np.array([-line.direction[1], line.direction[0]]))
        )
        self.s.symmetric(p, q, line)
        self.points.append(q)

    def middle(self):
        p, q = (self.points[k] for k in self.random.permutation(len(self.points))[:2])
        m = self.s.point(*(0.5 * (p.position + q.position)))
        self.s.midpoint(m, p, q)
        self.points.append(m)

    def grow(self, count):
        ways = (self.point, self.point_on_line, self.line, self.circle, self.circle_by_circle,
                self.mirrored, self.middle)  # fmt: skip
        for _ in range(count):
            self.pick(ways)()

    def shake(self, off):
        numbers = self.s._lists.numbers
        for k in range(len(numbers)):
            numbers[k] += self.random.uniform(-off, off) * (
                0.1 if self.s._lists.roles[k] == 2 else 1.0
            )


def _height(p, line):
    return float(np.array([-line.direction[1], line.direction[0]]) @ p - line.offset)


def _generic(s, least):
    """Whether the true place is regular: no singular value of the equations near the border of the rank."""
    numbers = Numbers(s)
    x, h = np.array(numbers.free), 1e-6
    columns = [
        (numbers.violations(x + h * e) - numbers.violations(x - h * e)) / (2 * h)
        for e in np.eye(x.size)
    ]
    values = np.linalg.svd(np.array(columns).T, compute_uv=False)
    return not ((values > 1e-6) & (values < least)).any()


def _checked(s, result):
    numbers = Numbers(s)
    size = max(abs(v) for v in numbers.free)
    assert result.solved, result.reason
    assert result.residual <= 1e-12 * max(size, 1.0) or result.redundant
    assert np.abs(numbers.violations(np.array(numbers.free))).max() <= 1e-10 * max(size, 1.0)
    return numbers.remaining_freedom()


@SOME
@given(st.integers(1, 7), st.integers(0, 10**6))
@example(4, 7)
@example(9, 1551)
def test_well_constrained(count, seed):
    b = Builder(seed)
    b.grow(count)
    if not _generic(b.s, 2e-2):
        return
    b.shake(0.01)
    result = b.s.solve()
    left, implied = _checked(b.s, result)
    assert result.freedom == left
    assert result.status == ("over" if implied else ("under" if left else "well"))


@SOME
@given(st.integers(2, 6), st.integers(0, 10**6), st.integers(1, 3))
@example(7, 72, 2)  # two middles of one pair: one locus, as near as rounding
def test_under_constrained(count, seed, missing):
    """Every dimension that is only measured instead of driving leaves a freedom."""
    b = Builder(seed)
    b.grow(count)
    if not _generic(b.s, 2e-2):
        return
    given_ones = [n for n, c in b.s.constraints.items() if c.given is not None and c.index > 3]
    t = again(b.s, driven=given_ones[:missing])
    random = np.random.default_rng(seed)
    for k in range(len(t._lists.numbers)):
        t._lists.numbers[k] += random.uniform(-0.01, 0.01) * (
            0.1 if t._lists.roles[k] == 2 else 1.0
        )
    result = t.solve()
    free, _ = _checked(t, result)
    assert result.freedom == free
    if free:
        assert result.status in ("under", "over")


@SOME
@given(st.integers(2, 6), st.integers(0, 10**6))
@example(3, 162)  # an exactly singular matrix on the way
@example(6, 318)
@pytest.mark.slow
def test_over_constrained(count, seed):
    """One dimension more than needed: implied when it is measured, a conflict when it is not."""
    b = Builder(seed)
    b.grow(count)
    if not _generic(b.s, 2e-2):
        return
    bound = [p for p in b.points if p not in b.points[:2]]
    if not bound:
        return
    tied = {frozenset(e.name for e in c.entities) for c in b.s.constraints.values()}
    pairs = [(p, q) for p in bound for q in b.points if p is not q]
    pairs = [pq for pq in pairs if frozenset(e.name for e in pq) not in tied]
    if not pairs:
        return
    p, q = pairs[seed % len(pairs)]
    if np.linalg.norm(p.position - q.position) < 0.3 or Numbers(b.s).remaining_freedom()[0]:
        return
    extra = b.s.distance(p, q, name="extra")
    b.shake(0.002)
    drawn = list(b.s._lists.numbers)
    result = b.s.solve()
    _checked(b.s, result)
    assert result.status == "over" and result.redundant
    b.s._lists.numbers[:] = drawn
    b.s.set("extra", 3.0 * extra.number + 20.0)
    result = b.s.solve()
    assert not result.solved and result.status in ("inconsistent", "unsolved")
    assert b.s._lists.numbers == drawn
    if result.status == "inconsistent":
        assert "extra" in result.conflicts
