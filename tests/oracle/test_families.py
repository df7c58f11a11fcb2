"""The families of hostile input are what they say, by the oracle; and the oracle keeps its own
laws on them."""

import numpy as np
import pytest
from hypothesis import given

from tests import oracle
from tests.examples import examples
from tests.strategies import FAMILIES, boxes, lattice_polygons, polygon_pairs, poses

CONTACT = {
    "shared_vertex": 1.0,
    "shared_edge": 1.0,
    "vertex_on_face": 2 / 3,
    "crossing_plates": 1.0,
}


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_families_are_seeded_finite_and_in_bulk(name):
    p, q = FAMILIES[name](np.random.default_rng(3), 50)
    again, _ = FAMILIES[name](np.random.default_rng(3), 50)
    assert p.shape[::2] == (50, 3) and q.shape[::2] == (50, 3)
    assert min(p.shape[1], q.shape[1]) >= 3
    assert np.isfinite(p).all() and np.isfinite(q).all()
    assert np.array_equal(p, again)


@pytest.mark.parametrize("name", sorted(CONTACT))
def test_contact_is_as_frequent_as_the_family_says(name):
    pairs = list(zip(*FAMILIES[name](np.random.default_rng(4), 90), strict=True))
    share = np.mean([oracle.polygons_touch(p, q) for p, q in pairs])
    assert abs(share - CONTACT[name]) < 0.16


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
