"""The quick exact distances against brute force, and that a proof refuses what it does not prove."""

import numpy as np
import pytest

from tests.oracle import polygon_distance_sq
from tests.oracle.certificates import polygon_distances_sq, proven_sq
from tests.strategies import FAMILIES


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_equal_to_brute_force(name):
    p, q = FAMILIES[name](np.random.default_rng(6), 4 if name == "many_sided" else 60)
    quick = [sq for sq, _ in polygon_distances_sq(p, q)]
    assert quick == [polygon_distance_sq(*pair) for pair in zip(p, q, strict=True)]


def test_most_of_the_easy_families_are_proven():
    for name in ("anywhere", "needles", "degenerate"):
        p, q = FAMILIES[name](np.random.default_rng(7), 100)
        assert sum(proven for _, proven in polygon_distances_sq(p, q)) > 90


def test_by_hand():
    """Two triangles 2 apart, tip over a face; a wrong pair of features proves nothing."""
    face = [(-3, -3, 0), (3, -3, 0), (0, 3, 0)]
    tip = [(0, 0, 2), (1, 0, 5), (0, 1, 5)]
    square, length_sq = proven_sq(tuple(face), (tip[0],), face, tip)
    assert square == 4 * length_sq
    assert proven_sq(tuple(face), (tip[1],), face, tip) is None
    assert proven_sq((face[0],), (tip[0],), face, tip) is None
    assert proven_sq(tuple(face), ((0, 0, 0),), face, [(0, 0, 0), *tip[1:]]) is None
