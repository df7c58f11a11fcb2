"""Checks the order of arrays that kernels rely on.

A kernel that bisects an array, or stops at the first entry that is too far, gives a wrong answer in silence if the
array is not in order. Each such array passes here once. Not for: what a user gives (`world.timing`).
"""

import numpy as np


def ascending(values: np.ndarray, *, strictly: bool = True) -> np.ndarray:
    """The values (n,), once they are checked to increase strictly, or not to decrease.

    Raises:
        AssertionError: they are not in order, which is a fault of this package.
    """
    steps = np.diff(values)
    assert (steps > 0).all() if strictly else (steps >= 0).all(), "not in ascending order"
    return values


def parents_first(parents: np.ndarray) -> np.ndarray:
    """The index of the parent of each of (n,) links, checked to come before the link; -1 for a root.

    Raises:
        AssertionError: one comes after it, which is a fault of this package.
    """
    before = (parents >= -1) & (parents < np.arange(len(parents)))
    assert before.all(), "a link comes before its parent"
    return parents
