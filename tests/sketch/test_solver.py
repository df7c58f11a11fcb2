"""Properties of solving, on sketches whose truth is known, and bit-exact ones: twice the sketch, and shifted."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from clearance.sketch import Sketch
from clearance.sketch.equations import Lengths, Linear
from clearance.sketch.graph.graph import DIRECTION
from scripts.makers.point_sketches import constructed, irreducible, shaken
from tests.sketch.patterns import distances, truth


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


SKETCHES = Path(__file__).parents[2] / "scenes" / "sketches"
FILES = (
    "bar_in_box",
    "extended_cluster",
    "under_constrained",
    "under_constrained_prism",
    "under_constrained_cycles",
    "midship_d",
)


def scaled(s, factor):
    """Multiplies every length of a sketch, drawn or dimension."""
    for k, role in enumerate(s._lists.roles):
        s._lists.numbers[k] *= 1.0 if role == DIRECTION else factor
    for c in s._lists.constraints:
        if c.given is not None and c.kind not in ("angle", "ratio"):
            c.given = c.number = c.number * factor
    for k, row in enumerate(s._lists.rows):
        is_turn = isinstance(row.equation, Linear) and s._lists.roles[row.equation.a] == DIRECTION
        if not is_turn and not isinstance(row.equation, Lengths):
            s._lists.rows[k] = row._replace(offset=row.offset * factor)
    s._solver = None
    return s


@pytest.mark.slow
@pytest.mark.parametrize("power", [1015])
@pytest.mark.parametrize("name", FILES)
def test_scaling_by_a_power_of_two_is_exact(name, power):
    s, t = (Sketch.load(SKETCHES / f"{name}.yaml") for _ in range(2))
    scaled(t, 2.0**power)
    assert s.solve().solved and t.solve().solved
    factor = np.where(np.array(s._lists.roles) == DIRECTION, 1.0, 2.0**power)
    assert (np.array(t._lists.numbers) == factor * np.array(s._lists.numbers)).all()


@pytest.mark.parametrize("seed", range(6))
def test_irreducible_clusters_off_by_20_percent(seed):
    points, edges = irreducible(36, seed)
    s, p = distances(points, shaken(points, 0.2, seed), edges)
    result = s.solve()
    assert result.solved and result.residual <= 1e-12 * 6.0
    x = np.array([q.position for q in p])
    for a, b in edges:
        span = np.linalg.norm(points[a] - points[b])
        assert np.linalg.norm(x[a] - x[b]) == pytest.approx(span, abs=1e-11)
    before = list(s._lists.numbers)
    assert s.solve().solved and s._lists.numbers == before


@pytest.mark.parametrize("sizes", [1e4, 1e8])
@pytest.mark.parametrize("seed", range(0, 12, 2))
def test_a_shift_changes_nothing(seed, sizes):
    """The drawn places are rounded so that they shift exactly; then every number is the same bit for bit
    as counted from the first place, hence every coordinate right to half a unit of its last digit."""
    _, points, edges = constructed(12, 0.0, seed)
    drawn = np.round(shaken(points, 0.1, seed) * 2.0**16) / 2.0**16
    shift = 2.0 ** np.round(np.log2(sizes * np.ptp(drawn, axis=0)))
    (s, p), (t, q) = (distances(points, places, edges) for places in (drawn, drawn + shift))
    assert s.solve().solved and t.solve().solved
    assert s._lists.numbers == t._lists.numbers
    for a, b in zip(p, q, strict=True):
        half = 0.5 * np.spacing(np.abs(b.position)) + np.spacing(np.abs(a.position))
        assert (np.abs((b.position - shift) - a.position) <= half).all()


def test_a_dragged_point_far_from_the_origin_goes_where_it_is_dragged():
    s = Sketch()
    p, q = s.point(1e8, 2e8), s.point(1e8 + 3.0, 2e8)
    s.distance(p, q, 3.0), s.fix(p)
    assert s.drag(q, (1e8, 2e8 + 5.0)).solved
    assert np.allclose(q.position - [1e8, 2e8], [0.0, 3.0], rtol=0, atol=1e-7)


def test_of_two_arcs_one_within_the_other_the_given_radii_say_which():
    """The drawing has the smaller circle larger."""
    s = Sketch()
    c, d = s.circle((0.0, 0.0), 1.05), s.circle((0.1, 0.0), 1.1)
    s.tangent(c, d, inside=True), s.radius(c, 1.2), s.radius(d, 1.0)
    assert s.solve().solved
    assert abs(np.linalg.norm(c.center.position - d.center.position) - 0.2) <= 1e-15
