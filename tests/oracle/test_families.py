"""The oracle keeps its own laws on hostile input."""

import numpy as np
from hypothesis import given

from tests import oracle
from tests.examples import examples
from tests.strategies import boxes, lattice_polygons, polygon_pairs, poses


@given(polygon_pairs())
@examples(60)
def test_distance_is_symmetric_and_at_most_that_of_any_corners(pair):
    p, q = pair
    sq = oracle.polygon_distance_sq(p, q)
    assert sq == oracle.polygon_distance_sq(q, p)
    assert sq <= oracle.polygon_distance_sq(p[:1], q[-1:])
    assert sq <= oracle.polygon_distance_sq(p[:2], q[-2:])


@given(lattice_polygons(), lattice_polygons())
@examples(60)
def test_planar_polygons_do_not_depend_on_the_first_corner_or_the_direction(p, q):
    sq = oracle.polygon_distance_sq(p, q)
    assert oracle.polygon_distance_sq(np.roll(p, 1, axis=0), q[::-1]) == sq


@given(boxes(), boxes(), poses())
@examples(25)
def test_solids_are_never_farther_apart_than_their_surfaces(a, b, pose):
    surfaces = oracle.polyhedron_distance_sq(*a, *b, None, pose)
    solids = oracle.solid_distance_sq(*a, *b, None, pose)
    centre_inside = oracle.contains(pose[:3, 3], *a)
    assert solids in (surfaces, 0)
    assert not centre_inside or solids == 0
