"""Every kind of constraint in a sketch of its own: it holds after solving, and its derivatives are
right."""

import math

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.constraints import KINDS, measured
from clearance.sketch.equations import Rows
from clearance.sketch.problem import tables_of


def entities(s, takes):
    random = np.random.default_rng(3)
    made = []
    for k, kind in enumerate(takes):
        x, y = 3.0 * k + random.uniform(0, 1, 2)
        if kind.what == "point":
            made.append(s.point(x, y))
        elif kind.what == "line":
            made.append(s.line(s.point(x, y), s.point(x + 2.0, y + 0.7 + 0.4 * k)))
        else:
            made.append(s.circle((x, y), 1.0 + 0.3 * k))
    return made


CASES = [(kind, k) for kind, forms in KINDS.items() for k in range(len(forms))]
DIMENSION = {"length": 1.7, "angle": 0.8, "ratio": 1.3, "": None}


def made(kind, k):
    s = Sketch()
    form = KINDS[kind][k]
    c = s.add(kind, *entities(s, form.types), value=DIMENSION[form.unit], name="tested")
    return s, c, form


@pytest.mark.parametrize(("kind", "k"), CASES)
def test_it_holds_after_solving(kind, k):
    s, c, form = made(kind, k)
    result = s.solve()
    assert result.solved, (kind, k)
    assert result.residual <= 1e-12 * 10
    if form.unit:
        assert measured(c, s._lists.numbers) == pytest.approx(DIMENSION[form.unit], rel=1e-12)


@pytest.mark.parametrize(("kind", "k"), CASES)
def test_derivatives_match_differences(kind, k):
    s, _c, _ = made(kind, k)
    t = tables_of(s)
    x = np.array(s._lists.numbers) + np.random.default_rng(1).uniform(
        -0.3, 0.3, len(s._lists.numbers)
    )
    rows = Rows(t.code, t.var, t.coef, t.value)
    slots = rows.slopes(x)
    analytic = np.zeros((t.code.size, x.size))
    for row, var in enumerate(t.var):
        for slot, i in enumerate(var):
            if i >= 0:
                analytic[row, i] += slots[row, slot]
    h = 1e-6
    for i in range(x.size):
        up, down = x.copy(), x.copy()
        up[i] += h
        down[i] -= h
        ahead, behind = (rows.errors(y) for y in (up, down))
        assert np.abs((ahead - behind) / (2 * h) - analytic[:, i]).max(initial=0.0) < 1e-8


PAPER = {
    ("distance", ("point", "point")): 1, ("distance", ("point", "line")): 1,
    ("distance", ("point", "circle")): 1, ("distance", ("line", "line")): 2,
    ("incident", ("point", "line")): 1, ("incident", ("point", "circle")): 1,
    ("coincident", ("point", "point")): 2, ("coincident", ("line", "line")): 2,
    ("tangent", ("line", "circle")): 1, ("tangent", ("circle", "circle")): 1,
    ("angle", ("line", "line")): 1, ("parallel", ("line", "line")): 1,
    ("concentric", ("point", "circle")): 2,
}  # fmt: skip


@pytest.mark.parametrize(("kind", "takes"), PAPER)
def test_valencies_are_those_of_table_1(kind, takes):
    k = next(k for k, f in enumerate(KINDS[kind]) if tuple(t.what for t in f.types) == takes)
    _, c, _ = made(kind, k)
    assert c.valency == PAPER[kind, takes]


def test_expressions_follow_their_parameters():
    s = Sketch()
    s.parameter("w", 3.0)
    a, b, c = s.point(0, 0), s.point(2, 0), s.point(1, 2)
    s.distance(a, b, "w", name="base")
    s.distance(a, c, "sqrt(base**2 + 1)"), s.distance(b, c, "2 * base / 3")
    s.distance(c, s.point(5, 5), driven=True, name="seen")
    assert s.solve().solved
    s.set("w", 4.0)
    assert s.solve().solved
    assert np.linalg.norm(c.position - a.position) == pytest.approx(math.sqrt(17.0), abs=1e-12)
    assert s.value("seen") == pytest.approx(np.linalg.norm(c.position - [5, 5]))
