"""What a kernel is given must lie in memory as it declares; anything else is refused before it is called."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from clearance.compile.decorators import DISABLED
from clearance.kernels.search.polygon_pair import PolygonPairAnswers, nearest_polygons

pytestmark = pytest.mark.skipif(DISABLED, reason="nothing is compiled")

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def answers(n: int) -> PolygonPairAnswers:
    flags = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
    return PolygonPairAnswers(np.full(n, np.nan), np.zeros(n), np.zeros((n, 2, 3)), *flags)


def pairs(*heights: float) -> tuple[np.ndarray, np.ndarray]:
    """Squares over each other."""
    below = np.stack([SQUARE] * len(heights))
    return below, below + np.array([[[0.0, 0, height]] for height in heights])


def test_arrays_of_a_tuple_are_read_and_written_where_they_lie():
    found, (ps, qs) = answers(3), pairs(2.0, 0.25, 0.0)
    nearest_polygons(ps, qs, found)
    assert found.distance.tolist() == [2.0, 0.25, 0.0]
    assert found.contact.tolist() == [False, False, True]
    assert (found.points[:, 1, 2] - found.points[:, 0, 2]).tolist() == [2.0, 0.25, 0.0]


def test_a_prepared_call_reads_the_same_arrays_each_time_and_keeps_them():
    found, (ps, qs) = answers(1), pairs(2.0)
    ask = nearest_polygons.prepared(ps, qs, found)
    assert ask() is None and found.distance.tolist() == [2.0]
    qs -= [0.0, 0.0, 1.5]
    kept = weakref.ref(qs)
    del ps, qs
    gc.collect()
    assert kept() is not None
    ask()
    assert found.distance.tolist() == [0.5]


@pytest.mark.parametrize(
    "given",
    [
        np.zeros((2, 4, 3), np.float32), np.zeros((2, 4, 3), np.int64), np.zeros((4, 3)), np.zeros((1, 2, 4, 3)),
        np.zeros((2, 4, 3), order="F"), np.zeros((4, 4, 3))[::2], np.zeros((2, 4, 6))[:, :, ::2],
        np.zeros((2, 4, 3), np.dtype(np.float64).newbyteorder()),
    ],
    ids=["singles", "integers", "two axes", "four axes", "F order", "rows", "columns", "bytes swapped"],
)  # fmt: skip
def test_an_array_that_lies_otherwise_is_refused(given):
    found, (ps, _) = answers(2), pairs(1.0, 1.0)
    with pytest.raises(TypeError, match="needed is float64 with 3 axes in C order"):
        nearest_polygons(ps, given, found)
    assert np.isnan(found.distance).all()


@pytest.mark.parametrize("name", ["distance", "points", "contact"])
def test_an_array_within_a_tuple_that_lies_otherwise_is_refused(name):
    found, (ps, qs) = answers(4), pairs(1.0, 1.0)
    with pytest.raises(TypeError, match="in C order"):
        nearest_polygons(ps, qs, found._replace(**{name: getattr(found, name)[::2]}))


def test_too_few_arguments_and_items_are_refused():
    found, (ps, qs) = answers(1), pairs(1.0)
    with pytest.raises(TypeError, match="is given 2 arguments and takes 3"):
        nearest_polygons(ps, qs)
    with pytest.raises(TypeError, match="4 values are given where 5 are declared"):
        nearest_polygons(ps, qs, found[:4])
