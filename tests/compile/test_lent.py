"""What is lent within kernels stays where it is until the lender returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from clearance.compile.declared import Floats
from clearance.compile.decorators import KERNELS, inline, kernel
from clearance.compile.lending import lend


class Scaled(NamedTuple):
    numbers: Floats
    factor: float
    first: int


@inline
def total(scaled):
    """The sum of the numbers from `first` on, times the factor."""
    found = 0.0
    for i in range(scaled.first, len(scaled.numbers)):
        found += scaled.factor * scaled.numbers[i]
    return found


@kernel
def total_of(scaled: Scaled) -> float:
    return total(scaled)


@kernel
def totals_of_lent(numbers: Floats, n: int) -> float:
    """Lends several at once, reads the first of them last; compiled kernels are called in between."""
    first = lend(Scaled(numbers, 2.0, 1))
    second = lend(Scaled(numbers[1:], 3.0, 0))
    third = lend(Scaled(numbers.copy(), 5.0, 2))
    found = 0.0
    for _ in range(n):
        found = 100.0 * found + total_of(third)
        found = 100.0 * found + total_of(second)
        found = 100.0 * found + total_of(first) + total(lend(first))
    return found


@pytest.mark.slow
@pytest.mark.skipif(KERNELS == "python", reason="nothing is lent in Python")
def test_several_tuples_are_lent_at_once():
    numbers = np.array([1.0, 2.0, 3.0])
    assert total_of(Scaled(numbers, 2.0, 1)) == 10.0
    assert totals_of_lent(numbers, 1) == 100.0 * (100.0 * 15.0 + 15.0) + 20.0
