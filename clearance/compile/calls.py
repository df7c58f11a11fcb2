"""Calling a kernel at its address: arguments are written down as `declared` says, results are read back.

A named tuple that holds arrays goes by its address (`written`). Arrays must lie in C order and have the declared
type, since the compiled code checks nothing. Not for: where the address comes from (`library`).
"""

from __future__ import annotations

import ctypes
import functools
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from clearance.compile.declared import (
    array_of,
    fields_of,
    format_of,
    holds_arrays,
    is_lent,
    layout_of,
    lent_kind,
    row_of,
)
from clearance.compile.library import address_of, free_memory
from clearance.compile.registered import DISABLED, Declaration


class KernelFault(RuntimeError):
    """A kernel has stopped where it must never come to: a fault of ours, never of the input."""


_Writer = Callable[[Any, list[Any], list[Any]], None]
"""Adds the words of a value to a list; what they point to goes into the second list."""


class Written:
    """A value as a kernel reads it, at `address`, for as long as this object lives.

    Its arrays are read and written where they lie; they must not be resized meanwhile. Where kernels run as they
    stand, the value itself is given instead.
    """

    __slots__ = ("_referenced", "address", "value")

    def __new__(cls, value: Any, kind: Any) -> Any:
        return value if DISABLED else super().__new__(cls)

    def __init__(self, value: Any, kind: Any) -> None:
        words: list[Any] = []
        referenced: list[Any] = [value]
        write, pack = _tuple_writer(kind)
        write(value, words, referenced)
        block = pack(*words)
        self._referenced = (referenced, ctypes.create_string_buffer(block, len(block)))
        self.value, self.address = value, ctypes.addressof(self._referenced[1])


@functools.cache
def _tuple_writer(kind: Any) -> tuple[_Writer, Callable[..., bytes]]:
    """What writes a tuple of this kind, and what packs the words."""
    return _writer_of(kind), struct.Struct(format_of(layout_of(kind))).pack


@functools.cache
def _writer_of(kind: Any) -> _Writer:
    array, lent, fields = array_of(kind), lent_kind(kind), fields_of(kind)
    if array is not None:
        return _array_writer(*array)
    if lent is not None:
        return functools.partial(_write_address, lent)
    if fields is None:
        return _write_number
    return functools.partial(_write_items, tuple(map(_writer_of, fields)))


def _argument_writer(kind: Any) -> _Writer:
    """The same for an argument: a named tuple with arrays goes by its address."""
    return functools.partial(_write_address, kind) if is_lent(kind) else _writer_of(kind)


def _write_number(value: Any, words: list[Any], referenced: list[Any]) -> None:
    words.append(value)


def _write_items(
    writers: Sequence[_Writer], value: Any, words: list[Any], referenced: list[Any]
) -> None:
    if len(value) != len(writers):
        raise TypeError(f"{len(value)} values are given where {len(writers)} are declared")
    for write, item in zip(writers, value, strict=True):
        write(item, words, referenced)


def _write_address(kind: Any, value: Any, words: list[Any], referenced: list[Any]) -> None:
    written = value if isinstance(value, Written) else Written(value, kind)
    referenced.append(written)
    words.append(written.address)


def _array_writer(number: np.dtype, n_axes: int) -> _Writer:
    def write(value: np.ndarray, words: list[Any], referenced: list[Any]) -> None:
        flags = value.flags
        if not (
            (value.dtype is number or value.dtype == number)
            and value.ndim == n_axes
            and flags.c_contiguous
        ):
            raise TypeError(
                f"an array of {value.dtype} with shape {value.shape} and strides {value.strides} is given: "
                f"needed is {number} with {n_axes} axes in C order"
            )
        size, item = value.size, value.itemsize
        if size and flags.writeable:
            address = addressof(character.from_buffer(value))  # a third of the time of `.ctypes`
        else:
            address = value.ctypes.data
        words.extend((0, 0, size, item, address, *value.shape, *value.strides))
        referenced.append(value)

    addressof, character = ctypes.addressof, ctypes.c_char
    return write


def entry_of(kernel: Declaration) -> _Call:
    """What calls a kernel with values as its annotations declare them."""
    return _Call(kernel)


def prepared(call: _Call, arguments: tuple) -> Callable:
    """What calls a kernel with these arguments, however often."""
    referenced: list[Any] = []
    block = call.written(arguments, referenced)
    words = ctypes.create_string_buffer(block, len(block))
    referenced.append(words)
    at, address = call.at, ctypes.addressof(words)

    def ask(referenced: list[Any] = referenced) -> Any:
        return at(address)

    return ask


class _Call:
    """Writes arguments, calls the address, reads the result."""

    def __init__(self, kernel: Declaration) -> None:
        self._kernel = kernel
        kinds = kernel.parameters.values()
        self._writers = tuple(map(_argument_writer, kinds))
        self._pack = struct.Struct(format_of(row_of([_layout(kind) for kind in kinds]))).pack
        self._read = None if kernel.result is None else _Reader(kernel.result)
        self._at = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(
            address_of(kernel)
        )

    def __call__(self, *arguments: Any) -> Any:
        referenced: list[Any] = []
        return self.at(self.written(arguments, referenced))

    def at(self, words: Any) -> Any:
        """The result of the call with arguments that lie there."""
        read = self._read
        if read is None:
            if self._at(words, None):
                self._stop()
            return None
        out = ctypes.create_string_buffer(read.size)
        if self._at(words, out):
            self._stop()
        return read(out)

    def written(self, arguments: tuple, referenced: list[Any]) -> bytes:
        """The arguments, written down; `referenced` keeps what they point to."""
        if len(arguments) != len(self._writers):
            raise TypeError(
                f"{self._kernel.symbol} is given {len(arguments)} arguments and takes {len(self._writers)}"
            )
        words: list[Any] = []
        for write, value in zip(self._writers, arguments, strict=True):
            write(value, words, referenced)
        return self._pack(*words)

    def _stop(self) -> None:
        free_memory()
        raise KernelFault(f"{self._kernel.symbol} came to a place that it must never reach")


def _layout(kind: Any) -> Any:
    """Of an argument: a named tuple with arrays goes by its address."""
    return layout_of(int) if is_lent(kind) else layout_of(kind)


class _Reader:
    """Reads a result that a kernel has written down; arrays are copied, then the kernel's memory is given back."""

    def __init__(self, kind: Any) -> None:
        layout = layout_of(kind)
        self._kind, self.size = kind, layout.size
        self._unpack = struct.Struct(format_of(layout)).unpack_from
        self._is_number = fields_of(kind) is None and array_of(kind) is None
        self._holds_arrays = holds_arrays(kind)

    def __call__(self, out: Any) -> Any:
        words = self._unpack(out)
        if self._is_number:
            return words[0]
        value = _value(self._kind, iter(words))
        if self._holds_arrays:
            free_memory()
        return value


def _value(kind: Any, words: Any) -> Any:
    array = array_of(kind)
    if array is not None:
        return _array_at(
            array.number, array.n_axes, [next(words) for _ in range(5 + 2 * array.n_axes)]
        )
    fields = fields_of(kind)
    if fields is None:
        return next(words)
    items = [_value(field, words) for field in fields]
    return kind(*items) if hasattr(kind, "_fields") else tuple(items)


def _array_at(number: np.dtype, n_axes: int, words: list[int]) -> np.ndarray:
    shape, strides = words[5 : 5 + n_axes], words[5 + n_axes :]
    if 0 in shape:
        return np.empty(shape, number)
    extent = sum((n - 1) * stride for n, stride in zip(shape, strides, strict=True)) + words[3]
    block = (ctypes.c_char * extent).from_address(words[4])
    return np.ndarray(shape, number, block, strides=strides).copy()
