"""Conflicts are minimal, checked by solving without each member; repairs repair."""

import numpy as np
import pytest

from clearance.sketch import Sketch

from .test_solver import truth


def rebuilt(s, leave_out=(), changes=None):
    """The sketch's points and distances anew, some left out, some with other values."""
    t = Sketch()
    for name, e in s.entities.items():
        t.point(*e.position, name=name)
    for name, c in s.constraints.items():
        if name not in leave_out:
            value = (changes or {}).get(name, c.number)
            t.distance(*(e.name for e in c.entities), value, name=name)
    return t


@pytest.mark.parametrize("seed", range(5))
def test_one_wrong_dimension(seed):
    s, p, points, _ = truth(14, seed)
    a, b = 3, 7
    s.distance(p[a], p[b], 1.06 * float(np.linalg.norm(points[a] - points[b])), name="wrong")
    drawn = list(s._numbers)
    result = s.solve()
    assert result.status == "inconsistent" and "wrong" in result.conflicts
    assert s._numbers == drawn
    others = [n for n in s.constraints if n not in result.conflicts]
    assert not rebuilt(s, others).solve().solved
    for name in result.conflicts:
        assert rebuilt(s, [*others, name]).solve().solved, name
    assert result.repairs[0].size <= min(r.size for r in result.repairs)
    assert rebuilt(s, changes=result.repairs[-1].changes).solve().solved


def test_triangle_inequality():
    s = Sketch()
    a, b, c = s.point(0, 0), s.point(1, 0), s.point(0.5, 0.5)
    (
        s.distance(a, b, 1.0, name="ab"),
        s.distance(b, c, 1.0, name="bc"),
        s.distance(a, c, 3.0, name="ac"),
    )
    s.distance(c, s.point(2, 2), 1.0, name="apart")
    result = s.solve()
    assert result.conflicts == ["ab", "bc", "ac"]
    assert result.repairs[0].size == pytest.approx(1.0 / np.sqrt(3.0), rel=1e-4)


def test_directions_that_contradict():
    s = Sketch()
    lines = [s.line((0, k), (1, k + 0.1 * k), name=f"l{k}") for k in range(4)]
    s.parallel(lines[0], lines[1], name="p01"), s.parallel(lines[1], lines[2], name="p12")
    s.parallel(lines[2], lines[3], name="p23"), s.angle(lines[0], lines[2], 0.3, name="skew")
    result = s.solve()
    assert result.status == "inconsistent" and sorted(result.conflicts) == ["p01", "p12", "skew"]


def test_redundant_is_told_from_inconsistent():
    s = Sketch()
    lines = [s.line((0, k), (1, k + 0.1 * k)) for k in range(3)]
    s.parallel(lines[0], lines[1]), s.parallel(lines[1], lines[2])
    s.parallel(lines[0], lines[2], name="implied")
    result = s.solve()
    assert result.status == "over" and result.redundant == ["implied"]
