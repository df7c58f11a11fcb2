"""Conflicts are minimal, checked by solving without each member; repairs repair."""

import numpy as np
import pytest

from clearance.sketch import Sketch
from tests.sketch.patterns import again, truth


@pytest.mark.parametrize("seed", range(5))
def test_one_wrong_dimension(seed):
    s, p, points, _ = truth(14, seed)
    a, b = 3, 7
    s.distance(p[a], p[b], 1.06 * float(np.linalg.norm(points[a] - points[b])), name="wrong")
    drawn = list(s._lists.numbers)
    result = s.solve()
    assert result.status == "inconsistent" and "wrong" in result.conflicts
    assert s._lists.numbers == drawn
    others = [n for n in s.constraints if n not in result.conflicts]
    assert not again(s, others).solve().solved
    for name in result.conflicts:
        assert again(s, [*others, name]).solve().solved, name
    assert result.repairs[0].size <= min(r.size for r in result.repairs)
    for repair in result.repairs:
        assert again(s, changes=repair.changes).solve().solved, repair
    single = [r for r in result.repairs if list(r.changes) == ["wrong"]]
    right = float(np.linalg.norm(points[a] - points[b]))
    assert single and single[0].changes["wrong"] == pytest.approx(right, abs=1e-9)


def test_directions_that_contradict():
    s = Sketch()
    lines = [s.line((0, k), (1, k + 0.1 * k), name=f"l{k}") for k in range(4)]
    s.parallel(lines[0], lines[1], name="p01"), s.parallel(lines[1], lines[2], name="p12")
    s.parallel(lines[2], lines[3], name="p23"), s.angle(lines[0], lines[2], 0.3, name="skew")
    result = s.solve()
    assert result.status == "inconsistent" and sorted(result.conflicts) == ["p01", "p12", "skew"]


def test_a_failed_search_is_not_called_inconsistent():
    """K(3,3) that no place fits, though no chain is too short: P3 and P4 must be 1.9 apart, so that
    P0 and P1 are within 0.63, but P5 needs them 0.7 apart."""
    s = Sketch()
    points = [(0, 0), (3, 0), (1.5, 2.5), (0.5, 1), (2.5, 1.2), (1.4, -1)]
    p = [s.point(*q, name=f"P{k}") for k, q in enumerate(points)]
    for a, spans in enumerate(((1, 1, 1), (1, 1, 0.3), (1, 2.9, 1.7))):
        for b, span in enumerate(spans):
            s.distance(p[a], p[3 + b], span, name=f"d{a}{b}")
    drawn = list(s._lists.numbers)
    result = s.solve()
    assert not result.solved and result.status == "unsolved" and s._lists.numbers == drawn
    assert "no proof" in result.reason and "\n" not in result.reason
    assert set(result.searched) <= set(s.constraints) and result.searched


def test_a_construction_without_place_is_proved_by_its_branches():
    s = Sketch()
    a, b, c = s.point(0, 0, name="a"), s.point(4, 0, name="b"), s.point(1, 3, name="c")
    line, q = s.line(a, b, name="line"), s.point(1, 1, name="q")
    for p in (a, b, c):
        s.fix(p, name=f"fix_{p.name}")
    s.incident(q, line, name="on"), s.distance(q, c, 1.0, name="short")
    result = s.solve()
    assert result.status == "inconsistent" and "branch" in result.reason
    assert {"on", "short"} <= set(result.conflicts)
    assert result.repairs[0].changes == {"short": pytest.approx(3.0, abs=1e-9)}
    s.set("short", result.repairs[0].changes["short"])
    assert s.solve().solved


def touching_circles(apart, at=2.2):
    s = Sketch()
    o, q = s.point(0, 0, name="o"), s.point(at, 0, name="q")
    k, m = s.circle(o, 1.0, name="k"), s.circle(q, 1.0, name="m")
    s.fix(o), s.radius(k, 1.0, name="r"), s.radius(m, 0.5, name="r2")
    s.tangent(k, m, name="touch"), s.distance(o, q, apart, name="d")
    return s


def test_every_repair_repairs_and_leaves_every_circle_a_size():
    """Circles that touch from outside, with centres nearer than one radius: the other one would be below 0."""
    s = touching_circles(0.5)
    result = s.solve()
    assert result.status == "inconsistent" and result.repairs
    for repair in result.repairs:
        assert repair.size > 1e-6 and min(repair.changes.values()) > 1e-6, repair
        assert again(s, changes=repair.changes).solve().solved, repair


def test_the_reason_says_on_which_side_circles_touch():
    result = touching_circles(0.5).solve()
    assert "touch keeps k and m outside each other, as drawn; inside=True" in result.reason
    result = touching_circles(1.5, at=0.4).solve()
    assert "touch keeps one of k and m inside the other, as drawn; inside=False" in result.reason
    assert "touch keeps" not in long_sided_triangle(3.0)[0].solve().reason


def test_sides_that_no_branch_satisfies_are_a_conflict():
    s = Sketch()
    a, b = s.point(0, 0, name="a"), s.point(4, 0, name="b")
    line = s.line(a, b, name="line")
    p, q = s.point(1, 1, name="p"), s.point(3, -1, name="q")
    s.fix(a), s.fix(b), s.fix(p, name="p_fixed"), s.fix(q, name="q_fixed")
    s.same_side(p, q, line, name="side")
    result = s.solve()
    assert not result.solved and "side" in result.conflicts


def long_sided_triangle(length):
    s = Sketch()
    p = [s.point(*q) for q in ((0, 0), (1, 0.1), (0.4, 0.8))]
    s.distance(p[0], p[1], length, name="long")
    s.distance(p[1], p[2], 1.0, name="one"), s.distance(p[2], p[0], 1.0, name="other")
    return s, p


@pytest.mark.parametrize("length", [1.0, 3.0])
def test_a_result_tells_of_the_entities_that_there_were(length):
    s, p = long_sided_triangle(length)
    result, drawn = s.solve(), set(s.entities)
    s.distance(p[0], s.point(9.0, 9.0), 3.0)
    assert set(result.best) == set(result.freedom_of) == drawn
    assert set(result.errors) == {"long", "one", "other"} and result.plan
    assert result.status == ("well" if length == 1.0 else "inconsistent")
