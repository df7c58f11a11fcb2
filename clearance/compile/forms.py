"""The types of a call's arguments, told without the compiler: which form of a kernel they need.

Arguments that are told alike are typed alike by the compiler; the reverse need not hold. Not for: whether that
form is compiled (`ready_kernel`).
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from clearance.compile.heap import HeapHandle

_WHOLE = 2**63

_C_CONTIGUOUS, _F_CONTIGUOUS, _ALIGNED, _WRITEABLE = 0x1, 0x2, 0x100, 0x400
"""Bits of `ndarray.flags.num`, as numpy's C interface documents them (`NPY_ARRAY_…`)."""


class _UnknownForm(Exception):
    """Something that only the compiler can type."""


def form_of(arguments: Sequence[object]) -> tuple | None:
    """What tells the types of some arguments; None where only the compiler can say."""
    try:
        return tuple(map(_form, arguments))
    except _UnknownForm:
        return None


def _form(value: Any) -> object:
    kind = type(value)
    if kind is np.ndarray:
        found = _array_of(value.dtype, value.ndim, value.flags.num)
        if found is None:
            raise _UnknownForm
        return found
    if issubclass(kind, tuple):
        if kind is tuple:
            return ("", *map(_form, value))
        return (_name_of(kind), *map(_form, value))
    return _scalar(value)


@functools.cache
def _name_of(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


@functools.lru_cache(maxsize=4096)
def _array_of(dtype: np.dtype, n_dimensions: int, flags: int) -> tuple | None:
    """The form of an array, by numpy's own flags, of which there are few; None where only the compiler can say."""
    if dtype.kind not in "biuf" or not dtype.isnative or not flags & _ALIGNED:
        return None
    layout = "C" if flags & _C_CONTIGUOUS else "F" if flags & _F_CONTIGUOUS else "A"
    return dtype.char, n_dimensions, layout, bool(flags & _WRITEABLE)


def _scalar(value: object) -> str:
    kind = type(value)
    if kind is float:
        return "d"
    if kind is bool:
        return "?"
    if kind is int:
        if not -_WHOLE <= value < _WHOLE:
            raise _UnknownForm
        return "l"
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        return value.dtype.char
    if isinstance(value, HeapHandle):
        return value.form
    raise _UnknownForm
