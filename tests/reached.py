"""Functions that only kernels can call, reached from a test by a kernel of their own."""

import functools
import inspect

import numba


@functools.cache
def reached(function):
    """`function` as Python can call it."""
    if numba.config.DISABLE_JIT:
        return function
    names = ", ".join(inspect.signature(function.py_func).parameters)
    return numba.njit(error_model="numpy")(
        eval(f"lambda {names}: function({names})", {"function": function})
    )
