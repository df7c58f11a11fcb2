"""The banded descent by itself: the order of columns, the factorisation, and the descent against dense."""

import numpy as np
import pytest

from clearance.kernels.sketch.solve import damped as sketch_damped
from clearance.kernels.sketch.solve.motion import (
    ClusterPlace,
    NumericCluster,
    StoppingRule,
    Unknowns,
)
from clearance.kernels.sketch.solve.search import BANDED, solve_block
from clearance.sketch.problem import problem_of, tables_of
from tests.reached import reached
from tests.sketch.patterns import distances, irreducible, prism, shaken


def problem(points, drawn, edges):
    s, _ = distances(points, drawn, edges)
    x = np.array(s._lists.numbers)
    return problem_of(tables_of(s), x), x


def block(p, x, attempts=60):
    rows = np.arange(p.tables.code.size)
    vertices = np.arange(1, p.system.kind.size)
    alone = np.full(p.system.kind.size, -1)
    y = x.copy()
    rule = StoppingRule(2e-16 * p.size, 1e-12 * p.size, attempts)
    place = ClusterPlace(y, np.zeros((0, 2)))
    return solve_block(p.system, NumericCluster(vertices, rows, alone), place, rule), y


@pytest.mark.parametrize("seed", range(3))
def test_band_solves_what_numpy_solves(seed):
    random = np.random.default_rng(seed)
    n, w = 30, 7
    lower = np.tril(random.uniform(-1, 1, (n, n)))
    lower[np.subtract.outer(np.arange(n), np.arange(n)) >= w] = 0.0
    lower[np.diag_indices(n)] = random.uniform(1, 2, n)
    matrix = lower @ lower.T
    band = np.zeros((n, w))
    for k in range(w):
        band[: n - k, k] = np.diag(matrix, k)
    right = random.uniform(-1, 1, n)
    answer = right.copy()
    assert reached(sketch_damped._solve_band)(band.copy(), answer)
    assert answer == pytest.approx(np.linalg.solve(matrix, right), rel=1e-9)
    band[3, 0] = -1.0
    assert not reached(sketch_damped._solve_band)(band, right)


@pytest.mark.slow
def test_a_long_strip_has_a_narrow_band():
    points, edges = prism(40, 0)
    p, _ = problem(points, points, edges)
    s, rows = p.system, np.arange(p.tables.code.size)
    vertices = np.arange(1, s.kind.size)
    first = np.full(s.kind.size, -1)
    first[1:] = 2 * np.arange(vertices.size)
    cluster = NumericCluster(vertices, rows, np.full(s.kind.size, -1))
    unknowns = Unknowns(cluster, first, 2 * vertices.size)
    nodes = reached(sketch_damped.nodes_of)(s, unknowns)
    half, column = reached(sketch_damped.narrow)(unknowns, nodes)
    assert sorted(column) == list(range(0, unknowns.n, 2))  # a permutation of the points
    assert half <= 16  # a ring folded twice: four points abreast
    for a, b in edges:
        assert abs(first[a + 1] - first[b + 1]) + 2 <= half


@pytest.mark.parametrize("seed", range(3))
def test_descent_on_a_band_finds_a_root(seed):
    points, edges = irreducible(30, seed)
    assert 2 * len(points) >= BANDED
    p, x = problem(points, shaken(points, 0.1, seed), edges)
    done, y = block(p, x)
    assert done
    y = y.reshape(-1, 2)
    for a, b in edges:
        span = np.linalg.norm(points[a] - points[b])
        assert np.linalg.norm(y[a] - y[b]) == pytest.approx(span, abs=1e-11)


def test_a_search_that_fails_leaves_the_numbers_alone():
    points, edges = irreducible(30, 1)
    p, x = problem(points, points, edges)
    p.system.value[:] *= np.random.default_rng(1).uniform(0.2, 3.0, p.system.value.size)
    done, y = block(p, x, 1)
    assert not done and (y == x).all()


def test_the_search_is_the_same_every_time():
    points, edges = irreducible(30, 2)
    p, x = problem(points, shaken(points, 0.3, 4), edges)
    assert (block(p, x)[1] == block(p, x)[1]).all()
