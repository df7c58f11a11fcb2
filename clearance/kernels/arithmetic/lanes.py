"""Four numbers in one register: what a tree's four children share is computed for all at once.

`Lanes` stands among the operands of +, -, *, / and `abs` wherever a float may, so that formulas are written once;
where the compiler does not run, four numbers are a numpy array. The instructions are LLVM's vectors, which every
processor has in some width.
"""

import numpy as np

from clearance.compile.decorators import inline, when_compiling
from clearance.kernels.arithmetic.width import WIDTH as WIDTH

ALL = (1 << WIDTH) - 1
"""Marks of all lanes."""


def square_root(a):
    """The square root of a number, or of each lane."""
    return np.sqrt(a)


def larger(a, b):
    """`a` where it is above `b`, else `b`, also where `a` is NaN."""
    return where_positive(a - b, a, b)


def where_positive(test, a, b):
    """`a` where `test` is above 0, else `b`."""
    return np.where(test > 0.0, a, b)[()]


def lanes_of(a, b, c, d):
    """Four numbers in lanes."""
    return np.array([a, b, c, d])


def lanes_at(array, row):
    """Row `row` of an (n, 4) array of float32 or float64 that lies in one piece."""
    return array[row].astype(np.float64)


def number_at(array, row, place):
    """One of the four of `lanes_at`."""
    return float(array[row, place])


def marks_within(lanes, most):
    """Bits of the lanes that are at most `most`."""
    return int((lanes <= most) @ (1 << np.arange(WIDTH)))


def first_of(marks):
    """The first lane whose bit is set, of marks that are not 0."""
    return (int(marks) & -int(marks)).bit_length() - 1


def lane(lanes, place):
    """One of the four."""
    return lanes[place]


def _tell_compiler():
    from clearance.kernels.arithmetic import lanes_in_llvm

    lanes_in_llvm.stand_for(globals())


when_compiling.append(_tell_compiler)


@inline(force=True)
def how_many(marks):
    """How many bits are set."""
    return (marks & 1) + (marks >> 1 & 1) + (marks >> 2 & 1) + (marks >> 3 & 1)


@inline(force=True)
def _if_marked(lanes, marks, place):
    return lane(lanes, place) if marks & (1 << place) else np.inf


@inline(force=True)
def least_of(lanes, marks):
    """The least of the lanes whose bits are set in `marks`, infinite if none is."""
    return min(
        min(_if_marked(lanes, marks, 0), _if_marked(lanes, marks, 1)),
        min(_if_marked(lanes, marks, 2), _if_marked(lanes, marks, 3)),
    )
