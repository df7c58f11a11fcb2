"""Bad input is refused in one line that names what was wrong."""

import math

import numpy as np
import pytest

from clearance.errors import ClearanceError
from clearance.sketch import Sketch


def refused(call, *words):
    with pytest.raises(ClearanceError) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text and len(text) < 300
    for word in words:
        assert word in text, text


@pytest.fixture
def s():
    sketch = Sketch()
    sketch.point(0, 0, name="a"), sketch.point(1, 0, name="b"), sketch.circle((3, 3), 1.0, name="c")
    return sketch


def test_names(s):
    refused(lambda: s.point(0, 0, name="a"), "'a'", "taken")
    refused(lambda: s.distance("a", "bb", 1.0), "'bb'", "did you mean 'b'")
    refused(
        lambda: s.distance(s.entity("a"), Sketch().point(0, 0, name="z"), 1.0), "another sketch"
    )
    refused(lambda: s.set("width", 1.0), "width")
    s.distance("a", "b", 1.0, name="width")
    refused(lambda: s.distance("a", "c", 1.0, name="width"), "taken")
    refused(lambda: s.set("widht", 1.0), "did you mean 'width'")


def test_a_centre_of_another_sketch_is_refused(s):
    other = Sketch()
    far = other.segment((0, 0), (0, 9)).ends[1]
    for k in range(9):
        other.point(k, 0)
    last = other.point(5, 5, name="z")
    for center in (far, last):
        refused(lambda center=center: s.arc(center, s.entity("a"), s.entity("b")), "another sketch")


def test_a_segment_that_is_refused_leaves_a_sketch_that_solves(s):
    s.fix("a"), s.distance("a", "b", 2.0)
    assert s.solve().solved
    refused(lambda: s.segment((7, 7), (7, 7)), "coincide")
    assert s.solve().solved and math.dist(*(s.entity(e).position for e in "ab")) == 2.0


def test_a_change_that_some_dimensions_refuse_changes_nothing(s):
    s.parameter("w", 1.0)
    s.distance("a", "b", "w", name="width"), s.radius("c", "2 - w", name="r")
    assert s.solve().solved
    refused(lambda: s.set("w", 3.0), "radius r")
    refused(lambda: s.set("width", "w - 5"), "distance width")
    assert [s.value(name) for name in ("w", "width", "r")] == [1.0, 1.0, 1.0]
    s.set("w", 0.5)
    assert [s.value(name) for name in ("w", "width", "r")] == [0.5, 0.5, 1.5]
    assert s.solve().solved
    assert math.dist(*(s.entity(e).position for e in "ab")) == pytest.approx(0.5, rel=1e-12)


def test_a_driven_dimension_with_another_value_than_is_drawn_is_refused(s, tmp_path):
    s.distance("a", "b", name="width", driven=True)
    file = tmp_path / "drawn.yaml"
    s.save(file)
    assert Sketch.load(file).value("width") == s.value("width")
    text = file.read_text()
    drawn = repr(s.value("width"))
    assert text.count(f"value: {drawn}") == 1
    file.write_text(text.replace(f"value: {drawn}", "value: 0.45"))
    refused(lambda: Sketch.load(file), "distance width is driven", "0.45", "leave out `driven`")


def test_kinds(s):
    refused(lambda: s.radius(s.entity("a"), 1.0), "radius", "circle")
    refused(lambda: s.parallel("a", "b"), "parallel", "line-line")
    refused(lambda: s.add("distence", "a", "b"), "distence")
    refused(lambda: s.distance("a", "a", 1.0), "different entities")
    refused(lambda: s.add("parallel", "a", "b", value=3.0), "parallel")


@pytest.mark.parametrize(
    "value", [-1.0, 0.0, math.nan, math.inf, "1/0", "sqrt(-1)", "__import__('os')", "w", "1 +"]
)
def test_values(s, value):
    refused(lambda: s.distance("a", "b", value, name="width"), "width")
    assert "width" not in s.constraints


def test_degenerate(s):
    refused(lambda: s.line(s.entity("a"), s.point(0, 0, name="twin"), name="l"), "l")
    refused(lambda: s.circle((0, 0), 0.0, name="k"), "k", "0")
    line = s.line(s.entity("a"), s.entity("b"), name="edge")
    s.fix("a")
    s.coincident("a", "b")
    refused(s.solve, "edge")
    assert line.length == 1.0


def test_files(tmp_path):
    path = tmp_path / "s.yaml"
    refused(lambda: Sketch.load(path), "s.yaml")
    for text, word in (
        ("points: {a: [0]}", "points.a"), ("points: [1", "YAML"), ("pionts: {}", "points"),
        ("points: {a: [0, .nan]}", "points.a"),
        ("points: {a: [0, 0]}\nconstraints: [{kind: fix, of: [q]}]", "constraints[0]"),
        ("points: {a: [0, 0]}\nconstraints: [{kind: fix, off: [a]}]", "constraints[0]"),
        ("points: {a: [0, 0]}\nconstraints: [{kind: fix, of: [a], off: 1}]", "constraints[0]"),
        ("points: {a: [0, 0, 0]}", "points.a"),
    ):  # fmt: skip
        path.write_text(text)
        refused(lambda: Sketch.load(path), "s.yaml", word)


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
