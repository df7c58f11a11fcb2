"""Types of numba's, as the table of kernels and the files of a kernel name them: documented ones alone.

Not for: the types of a call without numba (`forms`), which must come to the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import types


def without_value(kind: types.Type) -> types.Type:
    """The type of an argument without its value, which numba would compile a form of the function for."""
    kind = types.unliteral(kind)
    return types.int64 if kind == types.int32 else kind


def holds_arrays(kind: types.Type) -> bool:
    """Whether it is an array, or a tuple that holds one."""
    if isinstance(kind, types.BaseTuple):
        return any(map(holds_arrays, kind))
    return isinstance(kind, types.Array)


def form_of_types(kinds: Sequence[types.Type]) -> tuple | None:
    """As `form_of` of arguments of these types; None where no argument is told so."""
    try:
        return tuple(map(_form_of_type, kinds))
    except TypeError:
        return None


def _form_of_type(kind: types.Type) -> object:
    if isinstance(kind, types.Array):
        if not kind.aligned:
            raise TypeError(kind)
        return np.dtype(str(kind.dtype)).char, kind.ndim, kind.layout, kind.mutable
    if isinstance(kind, types.BaseTuple):
        made = getattr(kind, "instance_class", None)
        name = "" if made is None else f"{made.__module__}.{made.__qualname__}"
        return (name, *map(_form_of_type, kind))
    if isinstance(kind, types.StructRef):
        return str(kind)
    if isinstance(kind, types.Number | types.Boolean):
        return np.dtype(str(kind)).char
    raise TypeError(kind)


def plain(kind: types.Type) -> types.Type:
    """The type without what the compiler knows of the value."""
    if isinstance(kind, types.BaseTuple):
        return types.BaseTuple.from_types(
            tuple(plain(item) for item in kind), getattr(kind, "instance_class", None)
        )
    return types.unliteral(kind)
