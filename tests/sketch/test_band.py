"""The banded descent by itself: the order of columns, the factorisation, and the descent against dense."""

import numpy as np
import pytest

from clearance.sketch.effort import UNLIMITED
from clearance.sketch.problem import problem_of, tables_of
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.damped import BandedNormal
from clearance.sketch.solve.newton import StoppingRule
from clearance.sketch.solve.search import BANDED, solve_cluster
from tests.sketch.patterns import distances, irreducible, prism, shaken


def problem(points, drawn, edges):
    s, _ = distances(points, drawn, edges)
    x = np.array(s._lists.numbers)
    return problem_of(tables_of(s), x), x


def columns_of(p):
    return Columns(p.system, np.arange(1, p.system.kind.size), np.arange(p.tables.code.size))


def block(p, x, attempts=60):
    rule = StoppingRule(2e-16 * p.size, 1e-12 * p.size, attempts, UNLIMITED)
    return solve_cluster(columns_of(p), x, rule)


@pytest.mark.parametrize("seed", range(3))
def test_the_band_is_the_normal_matrix_and_is_solved_as_numpy_solves_it(seed):
    points, edges = irreducible(30, seed)
    p, x = problem(points, shaken(points, 0.1, seed), edges)
    columns = columns_of(p)
    normal, error, matrix = BandedNormal(columns), columns.errors(x), columns.matrix(x)
    more = np.random.default_rng(seed).uniform(0.1, 0.2, columns.n)
    band, right = normal.at(x, error)
    step = normal.solved(band, right, more[np.argsort(normal.place)])
    assert step == pytest.approx(
        np.linalg.solve(matrix.T @ matrix + np.diag(more), -matrix.T @ error), rel=1e-9
    )
    band[0, 3] = -1.0
    assert normal.solved(band, right, 0.0 * more) is None


def test_a_long_strip_has_a_narrow_band():
    points, edges = prism(40, 0)
    p, _ = problem(points, points, edges)
    columns = columns_of(p)
    normal = BandedNormal(columns)
    assert sorted(normal.place) == list(range(columns.n))
    half = round((normal.work / columns.n) ** 0.5)
    assert half <= 20  # a ring folded twice: four points abreast
    for a, b in edges:
        for i in range(2):
            apart = normal.place[2 * a + i] - normal.place[2 * b : 2 * b + 2]
            assert (np.abs(apart) < half).all()


@pytest.mark.parametrize("seed", range(3))
def test_descent_on_a_band_finds_a_root(seed):
    points, edges = irreducible(30, seed)
    assert 2 * len(points) >= BANDED
    p, x = problem(points, shaken(points, 0.1, seed), edges)
    y = block(p, x).reshape(-1, 2)
    for a, b in edges:
        span = np.linalg.norm(points[a] - points[b])
        assert np.linalg.norm(y[a] - y[b]) == pytest.approx(span, abs=1e-11)


def test_a_search_that_fails_leaves_the_numbers_alone():
    points, edges = irreducible(30, 1)
    p, x = problem(points, points, edges)
    p.system.value[:] *= np.random.default_rng(1).uniform(0.2, 3.0, p.system.value.size)
    before = x.copy()
    assert block(p, x, 1) is None and (x == before).all()


def test_the_search_is_the_same_every_time():
    points, edges = irreducible(30, 2)
    p, x = problem(points, shaken(points, 0.3, 4), edges)
    assert (block(p, x) == block(p, x)).all()
