"""Random Delaunay triangulations with slivers on their hull, some drawn the wrong way round: the plan's closed
steps find no place, least squares from the drawing does."""

import numpy as np
import pytest

from clearance.sketch.descent import ProblemPart, descend
from clearance.sketch.execution import at_unit
from clearance.sketch.folds import folds
from scripts.makers.point_sketches import slivered


def checked(seed, n):
    s, points, edges = slivered(n, 0.05, seed)
    result = s.solve()
    x = np.array([e.position for e in s.entities.values()])
    a, b = np.array(edges).T
    error = np.linalg.norm(x[a] - x[b], axis=1) - np.linalg.norm(points[a] - points[b], axis=1)
    assert result.solved, result.reason
    assert np.abs(error).max() <= 1e-12 * np.abs(x).max()
    return s, x


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 11, 16, 17, 19])
def test_patches_whose_plan_finds_no_place_are_solved_from_the_drawing(seed):
    checked(seed, 300)


def test_the_same_patch_is_solved_at_100():
    checked(19, 100)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 17])
def test_large_patches(seed):
    checked(seed, 1000)


def minimum():
    """A patch whose descent ends in a minimum that is no root: one sliver lies the wrong way."""
    s, _, _ = slivered(300, 0.05, 16)
    problem, x = at_unit(s._engine().current(), np.array(s._lists.numbers))
    work = ProblemPart(problem, 0)
    return work, descend(work, x)


@pytest.mark.slow
def test_a_minimum_has_no_slope_and_a_fold_leads_lower():
    work, place = minimum()
    assert np.abs(place.error).max() > 1e-9
    assert np.abs(place.slope(place.error)).max() <= 1e-3 * np.abs(place.error).max()
    lower = []
    for fold in folds(work, place)[:16]:
        x = place.x.copy()
        x[fold.variable : fold.variable + 2] = fold.goal
        lower.append(descend(work, x, 1e-4).total)
    assert min(lower) < 1e-6 * place.total


@pytest.mark.slow
def test_a_fold_keeps_two_distances():
    work, place = minimum()
    s = work.system
    for fold in folds(work, place)[:50]:
        x = place.x.copy()
        x[fold.variable : fold.variable + 2] = fold.goal
        rows = (s.var[work.rows][:, [0, 2]] == fold.variable).any(axis=1)
        changed = np.abs(work.at(x).error - place.error)
        assert np.sum(changed[rows] <= 1e-13) >= 2
        assert not changed[~rows].any()
