"""Properties of solving, on sketches whose truth is known: points are placed first, dimensions
measured."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from clearance.sketch import Sketch
from tests.sketch.patterns import truth


@pytest.mark.parametrize("seed", range(6))
def test_least_movement_against_an_independent_optimiser(seed):

    s, p, _, edges = truth(8, seed, missing=2 + seed % 2, off=0.15)
    drawn = np.array([q.position for q in p]).ravel()
    spans = [c.number for c in s.constraints.values()]

    def gaps(x):
        y = x.reshape(-1, 2)
        return np.array(
            [np.linalg.norm(y[a] - y[b]) - d for (a, b), d in zip(edges, spans, strict=True)]
        )

    result = s.solve()
    reference = minimize(
        lambda x: float(np.sum((x - drawn) ** 2)), drawn, method="SLSQP",
        constraints={"type": "eq", "fun": gaps}, options={"maxiter": 500, "ftol": 1e-14},
    )  # fmt: skip
    assert np.abs(gaps(reference.x)).max() < 1e-8
    assert result.movement <= 1.001 * math.sqrt(reference.fun)


def test_changing_one_dimension_moves_only_what_depends_on_it():
    s = Sketch()
    p = [s.point(x, y) for x, y in ((0, 0), (2, 0), (2, 1), (4, 0.2), (4, 1.3))]
    s.fix(p[0]), s.fix(p[1])
    s.distance(p[0], p[2], 2.2), s.distance(p[1], p[2], 1.0)
    s.distance(p[2], p[3], 2.1), s.distance(p[1], p[3], 2.0)
    s.distance(p[3], p[4], 1.0, name="last"), s.distance(p[2], p[4], 2.0)
    s.solve()
    before = [q.position for q in p]
    s.set("last", 1.1)
    result = s.solve()
    assert [step.outcome for step in result.plan].count("done") == 1
    assert all((a == q.position).all() for a, q in zip(before[:4], p[:4], strict=True))


def test_drag_keeps_the_constraints_and_follows():
    s = Sketch()
    p = [s.point(*q) for q in ((0, 0), (1, 0), (1, 1), (0, 1))]
    for i in range(4):
        s.distance(p[i], p[(i + 1) % 4], 1.0)
    s.fix(p[0]), s.fix(p[1])
    result = s.drag(p[2], (1.6, 0.8))
    assert result.solved and result.residual < 1e-12
    assert p[2].position == pytest.approx([1.6, 0.8], abs=1e-4)


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 0.1])
def test_a_point_on_a_circle_is_dragged_from_its_far_side_to_the_nearest_place(off):
    """Where it is farthest from the pointer, no small step comes nearer."""
    s = Sketch()
    middle, end = s.point(0, 0), s.point(-math.cos(off), math.sin(off))
    s.fix(middle)
    s.distance(middle, end, 1.0)
    s.drag(end, (5.0, 0.0))
    assert np.allclose(end.position, (1.0, 0.0), atol=1e-6)


@pytest.mark.parametrize("seed", [43, 51, 56])
def test_a_circle_that_the_least_movement_takes_to_a_point_keeps_its_size(seed):
    """Its edge is to be farther from the point than a third of its radius gives."""
    places = np.random.default_rng(seed).normal(size=(2, 2))
    s = Sketch()
    point, circle = s.point(*places[0]), s.circle(tuple(places[1]), 0.5)
    value = float(np.hypot(*(places[0] - places[1]))) + 2.0
    s.distance(point, circle, value)
    assert s.solve().status == "under" and circle.radius > 0.49
    gap = np.hypot(*(point.position - circle.center.position)) - circle.radius
    assert gap == pytest.approx(value, abs=1e-12)
