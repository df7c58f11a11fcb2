"""`distance` keeps arrays for the pairs it was asked about: that changes no answer, and keeps no solid alive."""

import gc
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import clearance as cl
from clearance.query.one_pair import cached_pair
from tests.made_cases import at, ball
from tests.strategies import rotations


def reported(near):
    """An answer bit by bit, with its counters."""
    numbers = [near.distance, near.error_bound, *near.point_a, *near.point_b]
    return [float(x).hex() for x in numbers] + [near.face_a, near.face_b, near.contact, near.tally]


def poses(n):
    """Apart, touching and crossing, in turn."""
    random = np.random.default_rng(8)
    away = random.normal(size=(n, 3)) * np.array([3.0, 0.9, 0.3, 2.0])[np.arange(n) % 4, None]
    return [at(*x, turned=r) for x, r in zip(away, rotations(random, n), strict=True)]


def test_an_answer_does_not_depend_on_what_was_asked_before():
    a, b = ball(1.0, 2), cl.box((1.0, 0.5, 0.2))
    again = [reported(cl.distance(a, b, pose_b=pose)) for pose in poses(40)]
    fresh = [
        reported(cl.distance(ball(1.0, 2), cl.box((1.0, 0.5, 0.2)), pose_b=pose))
        for pose in poses(40)
    ]
    assert again == fresh
    assert {near[10] for near in again} == {True, False}


def test_threads_do_not_disturb_each_other():
    a, b = ball(1.0, 2), cl.box((1.0, 0.5, 0.2))
    alone = [reported(cl.distance(a, b, pose_b=pose)) for pose in poses(40)]
    start = threading.Barrier(4)

    def ask(_):
        start.wait()
        return [reported(cl.distance(a, b, pose_b=pose)) for pose in poses(40)]

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(ask, range(4))) == [alone] * 4


def test_a_solid_that_is_let_go_takes_its_arrays_along():
    a, b = cl.box((1.0, 1.0, 1.0)), cl.box((2.0, 1.0, 1.0))
    pair = cached_pair(a, b)
    assert cached_pair(a, b) is pair and cached_pair(b, a) is not pair
    gone, solid = weakref.ref(pair), weakref.ref(b)
    del b, pair
    gc.collect()
    assert solid() is None and gone() is None
