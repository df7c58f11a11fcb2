"""Functions that only kernels can call, reached from a test by a kernel of their own."""

import functools

import numba


@functools.cache
def reached(function):
    """`function` as Python can call it."""
    if numba.config.DISABLE_JIT:
        return function
    return numba.njit(error_model="numpy")(lambda *args: function(*args))
