"""The compiler's types of what kernels take and give, foremost `Lent`: a named tuple by its address.

A tuple of twenty arrays is some two hundred numbers, and each call would hand over all of them: compiling a search
by value takes ten times as long. `Lent` is one word in every call; an attribute is loaded where it is read.
Imported by the compiler alone.
"""

from __future__ import annotations

import functools
import zlib
from typing import Any

from llvmlite import ir
from numba import from_dtype, types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    type_callable,
)

from clearance.compile import lending
from clearance.compile.declared import array_of, fields_of, is_lent, lent_kind

_NUMBERS = {int: types.int64, float: types.float64, bool: types.boolean}


class Lent(types.Type):
    """The address of a named tuple."""

    def __init__(self, kind: types.BaseTuple) -> None:
        self.kind = kind
        name = kind.instance_class.__name__
        super().__init__(f"Lent({name}{zlib.crc32(str(kind).encode()):08x})")


@register_model(Lent)
class _LentModel(models.OpaqueModel):
    pass


@functools.cache
def type_of(kind: Any) -> types.Type:
    """The compiler's type of a value of this kind, as it lies within others."""
    if kind in _NUMBERS:
        return _NUMBERS[kind]
    array = array_of(kind)
    if array is not None:
        return types.Array(from_dtype(array.number), array.n_axes, "C")
    lent = lent_kind(kind)
    if lent is not None:
        return Lent(type_of(lent))
    fields = fields_of(kind)
    if fields is None:
        raise TypeError(f"{kind} is no array, number or tuple of these")
    items = tuple(map(type_of, fields))
    return types.BaseTuple.from_types(items, kind if hasattr(kind, "_fields") else None)


def argument_type(kind: Any) -> types.Type:
    """The same of an argument: named tuples with arrays are lent."""
    return Lent(type_of(kind)) if is_lent(kind) else type_of(kind)


def _has_arrays(kind: types.Type) -> bool:
    if isinstance(kind, types.BaseTuple):
        return any(map(_has_arrays, kind))
    return isinstance(kind, types.Array)


def _within(kind: types.BaseTuple, name: str) -> tuple[int, types.Type]:
    """Place and type of an attribute as it is read: a named tuple with arrays is lent in turn."""
    place = kind.instance_class._fields.index(name)
    item = kind.types[place]
    is_tuple = isinstance(item, types.BaseTuple) and hasattr(item, "instance_class")
    return place, Lent(item) if is_tuple and _has_arrays(item) else item


@infer_getattr
class _LentAttributes(AttributeTemplate):
    key = Lent

    def generic_resolve(self, lent, name):
        if name in lent.kind.instance_class._fields:
            return _within(lent.kind, name)[1]
        return None


@lower_getattr_generic(Lent)
def _read(context, builder, lent, value, name):
    place, kind = _within(lent.kind, name)
    at = builder.bitcast(value, context.get_value_type(lent.kind).as_pointer())
    at = builder.gep(at, [ir.IntType(32)(0), ir.IntType(32)(place)], inbounds=True)
    if isinstance(kind, Lent):
        return builder.bitcast(at, context.get_value_type(kind))
    return builder.load(at)


def on_stack(builder, value):
    """Where a value lies while the function runs."""
    with builder.goto_entry_block():
        place = builder.alloca(value.type)
    builder.store(value, place)
    return place


def address_of(context, builder, value, given: types.Type, wanted: Lent):
    """The address of a named tuple that is lent already, or is put on the stack."""
    if isinstance(given, Lent):
        return builder.bitcast(value, context.get_value_type(wanted))
    return builder.bitcast(
        on_stack(builder, context.cast(builder, value, given, wanted.kind)),
        context.get_value_type(wanted),
    )


@type_callable(lending.lend)
def _lent(typing_context):
    return lambda value: value if isinstance(value, Lent) else Lent(types.unliteral(value))


@lower_builtin(lending.lend, types.Any)
def _lend(context, builder, signature, values):
    """In the frame of the caller: one of its own would end, and what comes next would lie in its place."""
    return address_of(context, builder, values[0], signature.args[0], signature.return_type)
