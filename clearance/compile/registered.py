"""What the compiler must know of: the functions that are compiled into kernels, and what else it is told.

Also where kernels come from in this process. Not for: kernels (`decorators`).
"""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable
from typing import Any, NamedTuple, get_type_hints

KERNELS = os.environ.get("CLEARANCE_KERNELS", "built")
"""Where kernels come from: `built`, `jit` or `python`."""

DISABLED = KERNELS == "python"
"""True where the functions run in Python as they stand."""

CHECKS_BOUNDS = os.environ.get("NUMBA_BOUNDSCHECK") == "1"
"""True where every index is checked."""


class Inlined(NamedTuple):
    """A function that is compiled into its callers."""

    function: Callable
    force: bool


inlined: list[Inlined] = []
"""All that `inline` has seen, for the compiler."""

when_compiling: list[Callable[[], None]] = []
"""What the compiler calls before it compiles: whoever has something to say to it alone."""


def inline(function: Callable | None = None, *, force: bool = False) -> Any:
    """A function that kernels compile in, and that Python runs as it stands.

    Args:
        force: True for what inner loops call: merged into its callers whatever it costs in code size.
    """
    if function is None:
        return functools.partial(inline, force=force)
    inlined.append(Inlined(function, force))
    return function


by_types: list[Any] = []
"""All that `by_type` has seen, for the compiler."""


def by_type(function: Callable) -> Any:
    """A function that each type of its first argument has for itself: `register` gives it one, as of `functools`.

    Kernels compile in that of the type they have, which costs nothing.
    """
    made = functools.singledispatch(function)
    by_types.append(made)
    return made


class Declaration:
    """What a kernel declares.

    Attributes:
        function: as it stands in Python. symbol: its name in the library.
    """

    def __init__(self, function: Callable) -> None:
        functools.update_wrapper(self, function)
        self.function = function
        room = function.__module__.removeprefix("clearance.kernels.")
        self.symbol = f"clearance_{room}_{function.__name__}".replace(".", "_")

    @functools.cached_property
    def parameters(self) -> dict[str, Any]:
        """Name and annotation of each argument.

        Raises:
            TypeError: one has none.
        """
        hints = get_type_hints(self.function, include_extras=True)
        names = inspect.signature(self.function).parameters
        missing = [name for name in names if name not in hints]
        if missing:
            raise TypeError(f"{self.symbol} does not declare {', '.join(missing)}")
        return {name: hints[name] for name in names}

    @functools.cached_property
    def result(self) -> Any:
        """The annotation of the result; None for nothing."""
        kind = get_type_hints(self.function, include_extras=True).get("return")
        return None if kind is type(None) else kind


kernels: list[Declaration] = []
"""All kernels that `decorators.kernel` has made."""
