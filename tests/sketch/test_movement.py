"""Least movement with lines and circles, against an independent optimiser on positions and radii only."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from clearance.sketch import Sketch


def _optimum(drawn, gaps, slopes=None):
    constraint = {"type": "eq", "fun": gaps} | ({"jac": slopes} if slopes else {})
    found = minimize(
        lambda x: float(np.sum((x - drawn) ** 2)), drawn, jac=lambda x: 2.0 * (x - drawn),
        method="SLSQP", constraints=constraint, options={"maxiter": 100, "ftol": 1e-13},
    )  # fmt: skip
    assert np.abs(gaps(found.x)).max() < 1e-8
    return math.sqrt(found.fun)


def _height(p, a, b):
    d = (b - a) / np.linalg.norm(b - a)
    return d[0] * (p - a)[1] - d[1] * (p - a)[0]


@pytest.mark.parametrize("seed", range(5))
def test_a_tangent_circle_and_a_chain(seed):
    random = np.random.default_rng(seed)
    drawn = np.array([0.0, 0.0, 4.0, 0.2, 2.0, 1.3, 5.0, 2.5, 1.1])
    drawn = drawn + random.uniform(-0.15, 0.15, drawn.size)
    s = Sketch()
    a, b, c, d = (s.point(*drawn[k : k + 2]) for k in (0, 2, 4, 6))
    line, circle = s.line(a, b), s.circle(c, drawn[8])
    s.distance(a, b, 4.1), s.tangent(line, circle), s.distance(b, d, 2.4), s.distance(d, c, 3.1)

    def gaps(x):
        p, q, m, e = x[0:2], x[2:4], x[4:6], x[6:8]
        spans = [np.linalg.norm(p - q) - 4.1, np.linalg.norm(q - e) - 2.4]
        return np.array([*spans, np.linalg.norm(e - m) - 3.1, _height(m, p, q) - x[8]])

    result = s.solve()
    assert result.status == "under" and result.residual <= 1e-12 * 6.0
    moved = math.hypot(result.movement, circle.radius - drawn[8])
    assert moved <= 1.001 * _optimum(drawn, gaps)


@pytest.mark.parametrize("seed", range(3))
def test_the_files_of_figure_12(seed):
    from pathlib import Path

    names = ("under_constrained", "under_constrained_prism", "under_constrained_cycles")
    s = Sketch.load(Path(__file__).parents[2] / "scenes" / "sketches" / f"{names[seed]}.yaml")
    random = np.random.default_rng(seed)
    points = list(s.entities.values())
    for k in range(len(s._lists.numbers)):
        s._lists.numbers[k] += random.uniform(-0.05, 0.05)
    drawn = np.array(s._lists.numbers)
    ends = np.array([[points.index(e) for e in c.entities] for c in s.constraints.values()])
    spans = np.array([c.number for c in s.constraints.values()])
    each = np.arange(spans.size)

    def reaches(x):
        y = x.reshape(-1, 2)
        away = y[ends[:, 0]] - y[ends[:, 1]]
        return away, np.hypot(*away.T)

    def gaps(x):
        return reaches(x)[1] - spans

    def slopes(x):
        away, reach = reaches(x)
        out = np.zeros((spans.size, x.size // 2, 2))
        out[each, ends[:, 0]] = away / reach[:, None]
        out[each, ends[:, 1]] = -away / reach[:, None]
        return out.reshape(spans.size, -1)

    result = s.solve()
    assert result.status == "under"
    assert result.movement <= 1.001 * _optimum(drawn, gaps, slopes)
