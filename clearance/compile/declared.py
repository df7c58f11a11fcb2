"""What kernels take and give: arrays by type and axes, numbers, and named tuples of these.

A kernel declares its arguments and its result by annotations in these terms; a named tuple declares its fields so.
`layout_of` says how a value lies in memory, for whoever writes it down (`calls`). Not for: numba's types (`lent`).
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np


class ArrayOf(NamedTuple):
    """An array in C order, of numbers of one type, with so many axes."""

    number: np.dtype
    n_axes: int


Floats = Annotated[np.ndarray, ArrayOf(np.dtype(np.float64), 1)]
Floats2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.float64), 2)]
Floats3 = Annotated[np.ndarray, ArrayOf(np.dtype(np.float64), 3)]
Floats4 = Annotated[np.ndarray, ArrayOf(np.dtype(np.float64), 4)]
Singles2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.float32), 2)]
Integers = Annotated[np.ndarray, ArrayOf(np.dtype(np.int64), 1)]
Integers2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.int64), 2)]
Shorts = Annotated[np.ndarray, ArrayOf(np.dtype(np.int32), 1)]
Shorts2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.int32), 2)]
Bits16 = Annotated[np.ndarray, ArrayOf(np.dtype(np.uint16), 1)]
Bytes = Annotated[np.ndarray, ArrayOf(np.dtype(np.uint8), 1)]
Signs = Annotated[np.ndarray, ArrayOf(np.dtype(np.int8), 1)]
Signs2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.int8), 2)]
Flags = Annotated[np.ndarray, ArrayOf(np.dtype(np.bool_), 1)]
Flags2 = Annotated[np.ndarray, ArrayOf(np.dtype(np.bool_), 2)]


class LentTo:
    """Marks a field that holds the address of a named tuple, not the tuple itself."""


class Layout(NamedTuple):
    """How a value lies in memory.

    Attributes:
        size, alignment: [bytes]
        leaves: (offset [bytes], code of `struct`) of each number, in order.
    """

    size: int
    alignment: int
    leaves: tuple[tuple[int, str], ...]


_NUMBERS = {int: "q", float: "d", bool: "?"}


def array_of(kind: Any) -> ArrayOf | None:
    """What an annotation says of an array; None if it is of something else."""
    if get_origin(kind) is Annotated:
        return next((each for each in get_args(kind)[1:] if isinstance(each, ArrayOf)), None)
    return None


def lent_kind(kind: Any) -> Any:
    """The named tuple whose address a field holds; None if it holds something else."""
    if get_origin(kind) is Annotated and LentTo in get_args(kind)[1:]:
        return get_args(kind)[0]
    return None


@functools.cache
def fields_of(kind: Any) -> tuple[Any, ...] | None:
    """The annotations of the items of a tuple, named or not; None if it is none."""
    if get_origin(kind) is tuple:
        return get_args(kind)
    if isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields"):
        hints = get_type_hints(kind, include_extras=True)
        return tuple(hints[name] for name in kind._fields)
    return None


@functools.cache
def holds_arrays(kind: Any) -> bool:
    """True for an array, and for a tuple that holds one."""
    fields = fields_of(kind)
    return array_of(kind) is not None if fields is None else any(map(holds_arrays, fields))


def is_lent(kind: Any) -> bool:
    """True for what a kernel is given by its address: a named tuple that holds arrays."""
    return hasattr(kind, "_fields") and holds_arrays(kind)


@functools.cache
def layout_of(kind: Any) -> Layout:
    """How a value of this kind lies in memory, as the compiled code reads it.

    Raises:
        TypeError: an annotation that says too little.
    """
    if kind in _NUMBERS:
        size = 1 if kind is bool else 8
        return Layout(size, size, ((0, _NUMBERS[kind]),))
    array = array_of(kind)
    if array is not None:
        n_words = 5 + 2 * array.n_axes
        return Layout(8 * n_words, 8, tuple((8 * i, "q") for i in range(n_words)))
    if lent_kind(kind) is not None:
        return Layout(8, 8, ((0, "q"),))
    fields = fields_of(kind)
    if fields is None:
        raise TypeError(f"{kind} is no array, number or tuple of these")
    return row_of([layout_of(field) for field in fields])


def row_of(layouts: list[Layout]) -> Layout:
    """Values behind one another, each where its alignment allows."""
    at, alignment = 0, 1
    leaves: list[tuple[int, str]] = []
    for each in layouts:
        at = -(-at // each.alignment) * each.alignment
        leaves += [(at + offset, code) for offset, code in each.leaves]
        at += each.size
        alignment = max(alignment, each.alignment)
    return Layout(-(-at // alignment) * alignment, alignment, tuple(leaves))


def format_of(layout: Layout) -> str:
    """The format by which `struct` writes such a value."""
    return "=" + "".join(_padded(layout))


def _padded(layout: Layout) -> Iterator[str]:
    at = 0
    for offset, code in layout.leaves:
        yield f"{offset - at}x{code}" if offset > at else code
        at = offset + (1 if code == "?" else 8)
    if layout.size > at:
        yield f"{layout.size - at}x"
