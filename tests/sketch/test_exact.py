"""Bit-exact properties: twice the sketch, twice the solution; what is solved stays; nothing flips."""

from pathlib import Path

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.equations import Lengths, Linear
from clearance.sketch.graph.graph import DIRECTION
from scripts.makers.point_sketches import constructed, irreducible, shaken
from tests.sketch.patterns import distances

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
