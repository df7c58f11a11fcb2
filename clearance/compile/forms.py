"""The types of a call's arguments, told without the compiler: which form of a kernel they need.

Arguments that are told alike are typed alike by the compiler; the reverse need not hold. Not for: whether that
form is compiled (`ready_kernel`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.compile.heap import HeapHandle

_WHOLE = 2**63


class _Unknown(Exception):
    """Something that only the compiler can type."""


def form_of(arguments: Sequence[object]) -> tuple | None:
    """What tells the types of some arguments; None where only the compiler can say."""
    try:
        return tuple(map(_form, arguments))
    except _Unknown:
        return None


def _form(value: object) -> object:
    kind = type(value)
    if kind is np.ndarray:
        return _array(value)
    if issubclass(kind, tuple):
        if kind is tuple:
            return ("", *map(_form, value))
        return (f"{kind.__module__}.{kind.__qualname__}", *map(_form, value))
    return _scalar(value)


def _array(value: np.ndarray) -> tuple:
    flags = value.flags
    if value.dtype.kind not in "biuf" or not value.dtype.isnative or not flags.aligned:
        raise _Unknown
    layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
    return value.dtype.char, value.ndim, layout, flags.writeable


def _scalar(value: object) -> str:
    kind = type(value)
    if kind is float:
        return "d"
    if kind is bool:
        return "?"
    if kind is int:
        if not -_WHOLE <= value < _WHOLE:
            raise _Unknown
        return "l"
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        return value.dtype.char
    if isinstance(value, HeapHandle):
        return value.form
    raise _Unknown
