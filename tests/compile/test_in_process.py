"""Kernels that the library has not are compiled in this process, and called as those of the library are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from clearance.compile.calls import KernelFault
from clearance.compile.declared import Floats, Floats2
from clearance.compile.decorators import DISABLED, inline, kernel
from clearance.compile.lending import lend
from tests.compile.kernel_memory import mark

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(DISABLED, reason="nothing is compiled"),
]


class Rows(NamedTuple):
    places: Floats2
    sums: Floats
    n: int


@kernel
def halved(number: float) -> float:
    return 0.5 * number


@kernel
def summed(rows: Rows) -> Rows:
    sums = rows.sums.copy()
    for i in range(rows.n):
        sums[i] += halved(rows.places[i].sum())
    return Rows(rows.places.copy(), sums, rows.n)


@kernel
def refusing(number: float) -> float:
    if number > 1.0:
        raise ValueError
    return number


@kernel
def asking(number: float) -> float:
    return refusing(number) + 1.0


@inline
def rows_of(n):
    return Rows(np.empty((n, 2)), np.zeros(n), n)


@inline
def filled(rows, number):
    for i in range(rows.n):
        rows.places[i, 0] = rows.places[i, 1] = number + i


@kernel
def lent(n: int) -> float:
    one, two = lend(rows_of(n)), lend(rows_of(2 * n))
    filled(one, 1.0)
    filled(two, 100.0)
    return one.places.sum() + two.places.sum()


ROWS = Rows(np.arange(6.0).reshape(3, 2), np.ones(3), 3)


def test_a_result_with_arrays_is_the_callers_own_and_the_memory_is_given_back():
    before = mark()
    found = summed(ROWS)
    summed(ROWS)
    assert found.sums.tolist() == [1.5, 3.5, 5.5]
    assert (found.places == ROWS.places).all() and found.n == 3
    assert mark() == before


def test_an_exception_stops_a_kernel_and_what_calls_it():
    assert asking(0.5) == 1.5
    before = mark()
    for stopped in (refusing, asking):
        with pytest.raises(KernelFault, match=stopped.symbol):
            stopped(2.0)
        assert mark() == before


def test_a_tuple_that_is_lent_stays_where_it_is():
    assert lent(3) == 2 * (1 + 2 + 3) + 2 * (600 + 15)


def test_a_kernel_that_declares_too_little_is_refused():
    @kernel
    def unclear(number) -> float:
        return number

    with pytest.raises(TypeError, match="does not declare number"):
        unclear(1.0)
