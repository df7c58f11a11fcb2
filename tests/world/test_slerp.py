"""Orientations between orientations, against the arc of sines and against turns by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.world.slerp import aligned, arcs_between, slerp
from tests.examples import examples

HALF = np.sqrt(0.5)


def units(random, n):
    q = random.normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def by_sines(p, q, s):
    """The arc on the sphere, of quaternions that are neither nearly alike nor opposite."""
    q = -q if p @ q < 0.0 else q
    angle = np.arccos(p @ q)
    return (np.sin((1 - s) * angle) * p + np.sin(s * angle) * q) / np.sin(angle)


@examples(100)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
def test_equal_to_the_arc_of_sines(seed, share):
    random = np.random.default_rng(seed)
    p, q = units(random, 2)
    if abs(p @ q) > 0.999:
        return
    found = slerp(p, q, share)
    sign = -1.0 if p @ q < 0.0 and share == 1.0 else 1.0  # the end is as it was given
    assert np.abs(sign * found - by_sines(p, q, share)).max() < 1e-13
    assert np.linalg.norm(found) == pytest.approx(1.0, abs=1e-14)


def test_both_ends_to_the_last_bit():
    random = np.random.default_rng(1)
    p, q = units(random, 50), units(random, 50)
    assert (slerp(p, q, 0.0) == p).all()
    assert (slerp(p, q, 1.0) == q).all()


@pytest.mark.parametrize("turn", [0.0, 1e-300, 1e-12, 1e-9, 1e-5, 1.0, 3.0, np.pi])
@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
def test_a_turn_about_z_by_hand(turn, share):
    p = np.array([0.0, 0.0, 0.0, 1.0])
    q = np.array([0.0, 0.0, np.sin(turn / 2), np.cos(turn / 2)])
    for sign in (1.0, -1.0) if turn < np.pi else (1.0,):
        x, y, z, w = slerp(p, sign * q, share)
        assert (x, y) == (0.0, 0.0)
        assert z == pytest.approx(np.sin(share * turn / 2), rel=1e-15, abs=0.0)
        assert w == pytest.approx(np.cos(share * turn / 2), rel=1e-15)


def test_half_a_turn_goes_the_way_of_the_signs():
    """Exactly 180 degrees, both ways: deterministic, and the same from the other end."""
    p, q = np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0, 0.0])
    assert slerp(p, q, 0.5) == pytest.approx([0.0, HALF, 0.0, HALF])
    assert slerp(p, -q, 0.5) == pytest.approx([0.0, -HALF, 0.0, HALF])
    assert (arcs_between(p, q) == [0.0, 1.0, 0.0, np.pi]).all()
    assert (arcs_between(p, -q) == [0.0, -1.0, 0.0, np.pi]).all()
    assert slerp(q, p, 0.25) == pytest.approx(slerp(p, q, 0.75))


@examples(100)
@given(st.integers(0, 2**32 - 1), st.integers(0, 12))
def test_aligned_neighbours_are_nearest_and_the_same(seed, n):
    random = np.random.default_rng(seed)
    q = units(random, n)
    if random.random() < 0.3:
        q = np.eye(4)[random.integers(0, 4, n)] * random.choice([-1.0, 1.0], (n, 1))
    found = aligned(q)
    assert (np.abs(found) == np.abs(q)).all()
    assert ((found == q).all(axis=1) | (found == -q).all(axis=1)).all()
    assert ((found[:-1] * found[1:]).sum(axis=1) >= -1e-15).all()
    assert (aligned(found) == found).all()
    if n:
        assert (found[0] == q[0]).all()
        arcs, again = arcs_between(q[:-1], q[1:]), arcs_between(found[:-1], found[1:])
        assert (arcs == again).all()
