"""Constructions whose drawing takes the wrong branch somewhere: the nearest branch that has a place is found."""

import itertools

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.beam import nearest_branch
from scripts.makers.point_sketches import constructed, sketched


def placed(s: Sketch) -> np.ndarray:
    return np.array([e.position for e in s.entities.values()])


def branch_of(s: Sketch) -> np.ndarray | None:
    drawn = np.array(s._lists.numbers)
    found = nearest_branch(s._engine().current(), 0, drawn)
    return None if found is None else found.reshape(-1, 2)


def off(x: np.ndarray, drawn: np.ndarray) -> float:
    """The sum of squared shifts where x is set down nearest to the drawing, by singular values."""
    a, b = x - x.mean(axis=0), drawn - drawn.mean(axis=0)
    u, _, vt = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1.0, np.linalg.det(u @ vt)]) @ vt
    return float(np.sum((a @ turn - b) ** 2))


def branches(points: np.ndarray, edges) -> list[np.ndarray]:
    """All places of points, each of which lies on two circles about earlier ones."""
    n, out = len(points), []
    near = {k: [a for a, b in edges if b == k] for k in range(2, n)}
    for signs in itertools.product((1.0, -1.0), repeat=n - 2):
        x = np.array(points)
        for k, sign in zip(range(2, n), signs, strict=True):
            a, b = near[k]
            r, q = (np.linalg.norm(points[k] - points[i]) for i in (a, b))
            d = x[b] - x[a]
            span = np.linalg.norm(d)
            along = (span * span + r * r - q * q) / (2.0 * span)
            height = r * r - along * along
            if height < 0.0:
                break
            up = np.array([-d[1], d[0]]) / span
            x[k] = x[a] + along * d / span + sign * np.sqrt(height) * up
        else:
            out.append(x)
    return out


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_nearest_of_all_branches(seed):
    """Seven points: 32 branches, fewer than are kept."""
    _, points, edges = constructed(7, 0.0, seed)
    drawn = points + np.random.default_rng(seed).normal(0.0, 0.4, points.shape)
    found = branch_of(sketched(points, drawn, edges))
    least = min(off(x, drawn) for x in branches(points, edges))
    assert found is not None and off(found, drawn) == pytest.approx(least, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("near", [6, None])
def test_constructions_drawn_off_are_solved_near_the_truth(near, seed):
    s, points, edges = constructed(100, 0.1, seed, near)
    drawn = placed(s)
    result = s.solve()
    x = placed(s)
    a, b = np.array(edges).T
    error = np.linalg.norm(x[a] - x[b], axis=1) - np.linalg.norm(points[a] - points[b], axis=1)
    assert result.solved and np.abs(error).max() <= 1e-12 * np.abs(x).max()
    assert result.movement <= 1.1 * np.sqrt(off(points, drawn))


def test_what_is_no_construction_of_points_from_distances_is_left_to_others():
    s = Sketch()
    p = [s.point(*q) for q in ((0, 0), (2, 0), (1, 1))]
    line = s.line(p[0], p[1])
    s.distance(p[0], p[1], 2.0), s.distance(p[2], line, 1.0), s.distance(p[2], p[0], 1.5)
    assert branch_of(s) is None
