"""Faces that pierce one another or just miss: contact is told exactly, however near an edge the crossing is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import polygon_distance
from tests.examples import examples
from tests.oracle.polygons import polygon_distance_sq

BESIDE = (0.0, 1e-300, 1e-17, 1e-16, 1e-14, 1e-11, 1e-6, 1e-2, 0.5)


def convex(rng: np.random.Generator, n_corners: int, slenderness: float) -> np.ndarray:
    """(n, 3) a convex polygon in a coordinate plane, exactly flat."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, n_corners))
    corners = np.column_stack([np.cos(angles), slenderness * np.sin(angles), np.zeros(n_corners)])
    return corners[:, rng.permutation(3)]


@examples(300)
@given(
    st.integers(0, 2**32 - 1), st.integers(3, 7), st.sampled_from(BESIDE), st.booleans(),
    st.sampled_from([1.0, 1e-3, 1e-7]), st.sampled_from([0.0, 1.0, 1e4]),
)  # fmt: skip
def test_contact_of_a_piercing_face_is_exact(seed, n_corners, beside, outside, slenderness, away):
    """A triangle goes through the plane of a face beside a point of an edge, its corners far from the face."""
    rng = np.random.default_rng(seed)
    face = convex(rng, n_corners, slenderness)
    i = rng.integers(n_corners)
    corner, following = face[i], face[(i + 1) % n_corners]
    at = corner + rng.uniform(-0.1, 1.1) * (following - corner)
    out = at - face.mean(axis=0)
    at = at + (1.0 if outside else -1.0) * beside * out / max(np.linalg.norm(out), 1e-300)
    direction = rng.normal(size=3)
    piercing = np.array([at - direction, at + rng.uniform(0.5, 2.0) * direction, at + 3.0 * rng.normal(size=3)])
    shift = away * rng.integers(-4, 5, 3)
    face, piercing = face + shift, piercing + shift
    found = polygon_distance(face, piercing), polygon_distance(piercing, face)
    truth = polygon_distance_sq(face, piercing)
    for answer in found:
        assert answer.contact == (truth == 0)
        assert answer.distance == pytest.approx(float(truth) ** 0.5, rel=1e-12, abs=1e-15 * (1.0 + 4.0 * away))
