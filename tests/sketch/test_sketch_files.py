"""Files keep a sketch; curves draw it."""

import numpy as np
import pytest

from clearance.sketch import Sketch


def slot():
    s = Sketch()
    s.parameter("r", 1.0)
    m, n = s.point(0, 0, name="m"), s.point(4.1, 0.1, name="n")
    p = [s.point(*q, name=f"p{k}") for k, q in enumerate(((0, -1), (4, -1), (4, 1), (0, 1)))]
    low, high = s.segment(p[0], p[1], name="low"), s.segment(p[2], p[3], name="high")
    s.arc(n, p[1], p[2], name="right")
    left = s.arc(m, p[3], p[0], name="left")
    s.fix(m, name="origin"), s.horizontal(m, n), s.distance(m, n, 4.0, name="pitch")
    s.radius(left, "r", name="radius"), s.horizontal(low), s.horizontal(high)
    s.vertical(m, p[0]), s.vertical(m, p[3]), s.vertical(n, p[1]), s.vertical(n, p[2])
    return s


def test_round_trip_is_exact(tmp_path):
    s = slot()
    assert s.solve().solved
    s.save(tmp_path / "slot.yaml")
    t = Sketch.load(tmp_path / "slot.yaml")
    for name, e in s.entities.items():
        if e.what == "point":
            assert (t.entity(name).position == e.position).all()
    assert list(t.constraints) and t.value("r") == 1.0 and t.constraint("radius").given == "r"
    t.set("r", 0.8)
    assert t.solve().solved and t.entity("right").radius == pytest.approx(0.8, abs=1e-12)


@pytest.mark.parametrize("driven", [False, True])
def test_dimensions_given_as_numpy_numbers_are_saved(tmp_path, driven):
    s = Sketch()
    a, b = s.point(np.float64(0.5), 0), s.point(np.float32(2.0), 1)
    c = s.circle(a, np.float64(1.5), name="c")
    s.distance(a, b, np.float64(1.8), name="span", driven=driven)
    s.radius(c, np.float64(1.5), name="r", driven=driven)
    s.parameter("w", np.float64(2.5))
    line = s.segment(s.point(3, 3), s.point(4, 5), name="edge")
    s.distance(a, line, name="gap", driven=driven)
    if not driven:
        s.set("span", np.int64(2))
    s.solve()
    s.save(tmp_path / "s.yaml")
    t = Sketch.load(tmp_path / "s.yaml")
    assert t.constraint("span").driven == driven and t.value("w") == 2.5
    assert t.value("span") == s.value("span") and t.entity("c").radius == s.entity("c").radius
    assert t.value("gap") == pytest.approx(s.value("gap"), rel=1e-14)


def test_curves_are_one_closed_contour():
    pytest.importorskip("clearance.planar.curve")
    s = slot()
    s.solve()
    curve = s.curves()
    assert curve.length == pytest.approx(8.0 + 2.0 * np.pi, rel=1e-9)
    assert curve.is_closed
