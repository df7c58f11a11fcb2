"""Sides, other roots, the nearest root and branch, degenerate outcomes by name."""

import itertools
import math

import numpy as np
import pytest

from clearance.sketch import DegenerateSketch, Sketch
from clearance.sketch.beam import nearest_branch
from scripts.makers.point_sketches import constructed, sketched


def base():
    s = Sketch()
    a, b = s.point(0, 0, name="a"), s.point(4, 0, name="b")
    s.fix(a), s.fix(b)
    return s, a, b, s.line(a, b, name="line")


@pytest.mark.parametrize("seed", range(3))
def test_same_side_holds_from_any_drawing(seed):
    random = np.random.default_rng(seed)
    s, a, b, line = base()
    p, q = (s.point(*random.uniform(-3, 3, 2)) for _ in range(2))
    s.distance(p, a, 2.0), s.distance(p, b, 3.0)
    s.distance(q, p, 2.5), s.distance(q, b, 2.2)
    s.same_side(p, q, line)
    result = s.solve()
    assert result.solved and p.position[1] * q.position[1] > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_same_side_takes_another_root_of_a_numeric_cluster(seed):
    """K(3,3) with two points fixed, and a side on which only other roots have their last point."""
    s, p = k33(seed, fixed=True)
    here, others = p[1].position, s.solve().alternatives
    there = max((other[p[1].name] for other in others), key=lambda q: np.linalg.norm(q - here))
    middle, away = 0.5 * (here + there), there - here
    s, p = k33(seed, fixed=True)
    line = s.line(middle, middle + np.array([-away[1], away[0]]), name="line")
    flag = s.point(*(there + away), name="flag")
    s.fix(line), s.fix(flag), s.same_side(flag, p[1], line)
    result = s.solve()
    assert result.solved and result.residual <= 1e-11
    assert (p[1].position - middle) @ away > 0.0
    for c in s.constraints.values():
        if c.kind == "distance":
            span = np.linalg.norm(c.entities[0].position - c.entities[1].position)
            assert span == pytest.approx(c.number, abs=1e-11)


def _file(name):
    from pathlib import Path

    return Path(__file__).parents[2] / "scenes" / "sketches" / f"{name}.yaml"


def k33(seed, fixed=False):
    random = np.random.default_rng(seed)
    points = random.uniform(0, 3, (6, 2))
    s = Sketch()
    p = [s.point(*q) for q in points]
    for q in (p[0], p[3]) if fixed else ():
        s.fix(q)
    for a in range(3):
        for b in range(3 + (fixed and a == 0), 6):
            s.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])))
    return s, p


@pytest.mark.parametrize("seed", range(4))
def test_alternatives_hold_differ_and_include_every_way_back(seed):
    s, p = k33(seed)
    result = s.solve()
    names = [q.name for q in p]
    here = np.array([q.position for q in p])
    for other in result.alternatives:
        x = np.array([other[n] for n in names])
        for c in s.constraints.values():
            i, j = (names.index(e.name) for e in c.entities)
            assert np.linalg.norm(x[i] - x[j]) == pytest.approx(c.number, abs=1e-11)
        gaps, mine = (np.linalg.norm(y[:, None] - y[None], axis=2) for y in (x, here))
        assert np.abs(x - here).max() > 1e-6 and gaps.shape == mine.shape
    moves = [np.linalg.norm(np.array([o[n] for n in names]) - here) for o in result.alternatives]
    assert moves == sorted(moves)


def test_the_nearest_root_is_taken():
    """From a drawing near either root of the bar's length, that one comes out, though both are far."""
    s = Sketch.load(_file("bar_length"))
    s.solve()
    found = {round(s.value("length"), 4)}
    other = s.solve().alternatives[0]
    t = Sketch.load(_file("bar_length"))
    for k in range(4):
        at = t.entity(f"P{k}").variable
        t._lists.numbers[at : at + 2] = [float(v) for v in other[f"P{k}"]]
    for k in range(4):
        line = t.entity(f"bar{k}")
        t._lists.numbers[line.variable : line.variable + 2] = [float(v) for v in other[f"bar{k}"]]
    assert t.solve().solved
    found.add(round(t.value("length"), 4))
    assert found == {10.8149, 12.5679}


def test_a_circle_that_shrinks_to_nothing_is_named():
    s = Sketch()
    c = s.circle((1.0, 0.5), 0.4, name="wheel")
    end = s.point(2.0, 0.1, name="end")
    s.fix(c.center), s.coincident(c.center, end), s.incident(end, c, name="rim")
    with pytest.raises(DegenerateSketch, match="wheel"):
        s.solve()


def crossed(between_tips):
    """Two triangles on one base, both drawn above it, and how far their tips are apart."""
    s = Sketch()
    p = [s.point(*q) for q in ((0, 0), (1, 0), (0.5, 0.9), (0.5, 0.8))]
    for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3)):
        s.distance(p[i], p[j], 1.0)
    s.distance(p[2], p[3], between_tips)
    return s, p


def test_a_dimension_too_many_that_holds_on_another_branch_only_takes_that_branch():
    s, p = crossed(math.sqrt(3.0))
    result = s.solve()
    assert (result.status, result.redundant) == ("over", ["distance6"])
    assert any("distance6" in part for part in result.over_constrained)
    base = p[0].position[1]
    assert (p[2].position[1] - base) * (p[3].position[1] - base) == pytest.approx(-0.75)
    solved = list(s._lists.numbers)
    assert s.solve().solved and s._lists.numbers == solved


def between_directions(start, corner, end):
    """[rad] the angle between the directions from start to corner and from end to start."""
    u, v = corner.position - start.position, start.position - end.position
    return math.acos(float(u @ v) / (np.linalg.norm(u) * np.linalg.norm(v)))


def drawn_with_an_angle(drawn, wanted):
    """A fixed segment ab and a segment ca, drawn at an angle from it, where another is wanted."""
    s = Sketch()
    a, b, c = s.point(0, 0), s.point(1, 0), s.point(-1.3 * math.cos(drawn), 1.3 * math.sin(drawn))
    ab, ca = s.segment(a, b), s.segment(c, a)
    s.fix(a), s.fix(b)
    s.angle(ab, ca, wanted, name="A"), s.angle(ab, ca, driven=True, name="measured")
    return s, (a, b, c)


@pytest.mark.parametrize("drawn", [0.1, 0.8, 2.356, 3.0])
@pytest.mark.parametrize("wanted", [0.05, 0.5, 1.5, 2.6, 3.09])
def test_an_angle_is_between_directions_however_far_a_line_turns(drawn, wanted):
    s, (a, b, c) = drawn_with_an_angle(drawn, wanted)
    assert s.solve().solved
    assert between_directions(a, b, c) == pytest.approx(wanted, abs=1e-9)
    assert s.value("measured") == pytest.approx(wanted, abs=1e-9)
    assert c.position[1] > 0.0


def test_an_angle_that_only_a_reversed_segment_has_is_not_solved():
    s, (_, b, c) = drawn_with_an_angle(2.356, 0.5)
    s.vertical(b, c)
    c_as_drawn = c.position.copy()
    result = s.solve()
    assert result.status == "unsolved" and result.searched == ["A"] and "A" in result.reason
    assert np.array_equal(c.position, c_as_drawn)


def placed(s: Sketch) -> np.ndarray:
    return np.array([e.position for e in s.entities.values()])


def branch_of(s: Sketch) -> np.ndarray | None:
    drawn = np.array(s._lists.numbers)
    found = nearest_branch(s._engine().current(), 0, drawn)
    return None if found is None else found.reshape(-1, 2)


def off(x: np.ndarray, drawn: np.ndarray) -> float:
    """The sum of squared shifts where x is set down nearest to the drawing, by singular values."""
    a, b = x - x.mean(axis=0), drawn - drawn.mean(axis=0)
    u, _, vt = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1.0, np.linalg.det(u @ vt)]) @ vt
    return float(np.sum((a @ turn - b) ** 2))


def branches(points: np.ndarray, edges) -> list[np.ndarray]:
    """All places of points, each of which lies on two circles about earlier ones."""
    n, out = len(points), []
    near = {k: [a for a, b in edges if b == k] for k in range(2, n)}
    for signs in itertools.product((1.0, -1.0), repeat=n - 2):
        x = np.array(points)
        for k, sign in zip(range(2, n), signs, strict=True):
            a, b = near[k]
            r, q = (np.linalg.norm(points[k] - points[i]) for i in (a, b))
            d = x[b] - x[a]
            span = np.linalg.norm(d)
            along = (span * span + r * r - q * q) / (2.0 * span)
            height = r * r - along * along
            if height < 0.0:
                break
            up = np.array([-d[1], d[0]]) / span
            x[k] = x[a] + along * d / span + sign * np.sqrt(height) * up
        else:
            out.append(x)
    return out


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_nearest_of_all_branches(seed):
    """Seven points: 32 branches, fewer than are kept."""
    _, points, edges = constructed(7, 0.0, seed)
    drawn = points + np.random.default_rng(seed).normal(0.0, 0.4, points.shape)
    found = branch_of(sketched(points, drawn, edges))
    least = min(off(x, drawn) for x in branches(points, edges))
    assert found is not None and off(found, drawn) == pytest.approx(least, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("near", [6, None])
def test_constructions_drawn_off_are_solved_near_the_truth(near, seed):
    s, points, edges = constructed(100, 0.1, seed, near)
    drawn = placed(s)
    result = s.solve()
    x = placed(s)
    a, b = np.array(edges).T
    error = np.linalg.norm(x[a] - x[b], axis=1) - np.linalg.norm(points[a] - points[b], axis=1)
    assert result.solved and np.abs(error).max() <= 1e-12 * np.abs(x).max()
    assert result.movement <= 1.1 * np.sqrt(off(points, drawn))


def test_what_is_no_construction_of_points_from_distances_is_left_to_others():
    s = Sketch()
    p = [s.point(*q) for q in ((0, 0), (2, 0), (1, 1))]
    line = s.line(p[0], p[1])
    s.distance(p[0], p[1], 2.0), s.distance(p[2], line, 1.0), s.distance(p[2], p[0], 1.5)
    assert branch_of(s) is None
