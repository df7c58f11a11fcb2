"""Bit-exact properties: twice the sketch, twice the solution; what is solved stays; nothing flips."""

from pathlib import Path

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.equations import Lengths, Linear
from clearance.sketch.graph.graph import DIRECTION
from scripts.makers.point_sketches import flipped, patch
from tests.examples import some_slow
from tests.sketch.patterns import distances, irreducible, shaken

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
@pytest.mark.parametrize("power", [-20, 1015])
@pytest.mark.parametrize("name", FILES)
def test_scaling_by_a_power_of_two_is_exact(name, power):
    s, t = (Sketch.load(SKETCHES / f"{name}.yaml") for _ in range(2))
    scaled(t, 2.0**power)
    assert s.solve().solved and t.solve().solved
    factor = np.where(np.array(s._lists.roles) == DIRECTION, 1.0, 2.0**power)
    assert (np.array(t._lists.numbers) == factor * np.array(s._lists.numbers)).all()


NAMES = [*FILES, "bar_length", "midship_b", "midship_c", "midship_e"]


@pytest.mark.parametrize("name", some_slow(NAMES, {"midship_b", "midship_c", "midship_d"}))
def test_solved_files_solve_to_themselves_bit_for_bit(name):
    s = Sketch.load(SKETCHES / f"{name}.yaml")
    assert s.solve().solved
    before = list(s._lists.numbers)
    assert s.solve().solved and s._lists.numbers == before


@pytest.mark.parametrize("seed", range(10))
def test_off_by_20_percent_all_are_solved_and_none_flips(seed):
    s, points, edges = patch(100, 0.2, seed)
    assert s.solve().solved
    assert flipped(s, points, edges) == 0


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
