"""The decorators of compiled functions: `kernel` for what Python or other kernels call, `inline` for their parts.

A kernel is arithmetic over memory that its caller gives. It declares its arguments and its result by annotations
(`declared`). It is compiled when the package is built and found by its symbol (`library`); a kernel calls another
one in the same way. `CLEARANCE_KERNELS` says otherwise: `jit` compiles each kernel in this process when it is
first called, `python` runs all as they stand.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from clearance.compile.manifest import is_current
from clearance.compile.registered import CHECKS_BOUNDS as CHECKS_BOUNDS
from clearance.compile.registered import DISABLED as DISABLED
from clearance.compile.registered import KERNELS as KERNELS
from clearance.compile.registered import Declaration, kernels
from clearance.compile.registered import by_type as by_type
from clearance.compile.registered import inline as inline
from clearance.compile.registered import when_compiling as when_compiling
from clearance.compile.sources import digest_of_imported


class Kernel(Declaration):
    """A compiled function as Python has it: called with what its annotations declare."""

    @functools.cached_property
    def entry(self) -> Any:
        """What is called: the arguments are written down, the result is read."""
        from clearance.compile.calls import entry_of

        return entry_of(self)

    def __call__(self, *arguments: Any) -> Any:
        return self.entry(*arguments)

    def prepared(self, *arguments: Any) -> Callable:
        """The call with these arguments, written down once: it reads and writes the same arrays each time."""
        from clearance.compile.calls import prepared

        return prepared(self.entry, arguments)


if KERNELS == "built":
    # the hash is taken before any kernel is imported: what is called later must fit it
    is_current(digest_of_imported, [])


def kernel(function: Callable) -> Any:
    """A function that is compiled on its own: called from Python, or by other kernels at its symbol.

    IEEE arithmetic: division by zero gives inf or NaN as in numpy. It runs without the GIL. What it makes with
    `np.empty` and the like lives until it returns; arrays in its result are copied for Python.
    """
    if DISABLED:
        vars(function)["prepared"] = functools.partial(functools.partial, function)
        return function
    made = Kernel(function)
    kernels.append(made)
    return made
