"""From a kernel to object files, through numba. Not for: what LLVM makes of its language (`objects`).

Every kernel is compiled as a C function `int64 symbol(arguments, result)` of two addresses; it returns 0, or 1
where it came to an exception. Other kernels call it at its symbol, which needs its declaration only.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import llvmlite.binding as llvm
from llvmlite import ir
from numba import cfunc, njit, types
from numba.extending import intrinsic, overload, register_jitable

from clearance.compile import registered
from clearance.compile.declared import holds_arrays
from clearance.compile.intrinsics import llvm_function
from clearance.compile.lent import Lent, address_of, argument_type, on_stack, type_of
from clearance.compile.objects import object_of
from clearance.compile.registered import Declaration

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True}
_INNER = {**_OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_registered = {"inlined": 0, "by_types": 0, "kernels": 0, "hooks": 0}


def register_all() -> None:
    """Tells numba of all functions that kernels may call."""
    for hook in registered.when_compiling[_registered["hooks"] :]:
        hook()
    _registered["hooks"] = len(registered.when_compiling)
    for function, force in registered.inlined[_registered["inlined"] :]:
        options = {"forceinline": True} if force else {}
        register_jitable(**_INNER, **options)(function)
    _registered["inlined"] = len(registered.inlined)
    for function in registered.by_types[_registered["by_types"] :]:
        _register_by_type(function)
    _registered["by_types"] = len(registered.by_types)
    for kernel in registered.kernels[_registered["kernels"] :]:
        _register(kernel)
    _registered["kernels"] = len(registered.kernels)


def _register_by_type(function: Any) -> None:
    """Lets kernels call what the type of the first argument has for itself."""

    @overload(function, jit_options={**_INNER, "forceinline": True}, strict=False)
    def call(first, *others):
        kind = first.kind if isinstance(first, Lent) else first
        return function.dispatch(kind.instance_class)


def _register(kernel: Declaration) -> None:
    """Lets kernels call this one at its symbol."""

    @overload(kernel, jit_options=_INNER, strict=False)
    def call(*arguments):
        ask = _asked(kernel)

        def implementation(*arguments):
            status, found = ask(arguments)
            if status != 0:
                raise RuntimeError("a kernel has stopped")
            return found

        return implementation


@functools.cache
def _asked(kernel: Declaration) -> Callable:
    """Calls a kernel: (status, result)."""
    kinds = tuple(map(argument_type, kernel.parameters.values()))
    block = types.Tuple(kinds)
    result = types.int64 if kernel.result is None else type_of(kernel.result)

    @intrinsic
    def ask(typing_context, arguments):
        if len(arguments) != len(kinds):
            raise TypeError(f"{kernel.symbol} takes {len(kinds)} arguments, {len(arguments)} given")
        for given, wanted in zip(arguments, kinds, strict=True):
            _require_fits(typing_context, kernel, given, wanted)

        def emit(context, builder, signature, values):
            items = [
                _as(context, builder, builder.extract_value(values[0], i), given, wanted)
                for i, (given, wanted) in enumerate(zip(arguments, kinds, strict=True))
            ]
            at = on_stack(builder, context.make_tuple(builder, block, items))
            with builder.goto_entry_block():
                out = builder.alloca(context.get_value_type(result))
            byte = ir.IntType(8).as_pointer()
            function = llvm_function(
                builder, kernel.symbol, ir.FunctionType(ir.IntType(64), [byte, byte])
            )
            status = builder.call(function, [builder.bitcast(at, byte), builder.bitcast(out, byte)])
            if kernel.result is None:
                found = context.get_constant(types.int64, 0)
            else:
                found = builder.load(out)
            pair = types.Tuple((types.int64, result))
            return context.make_tuple(builder, pair, [status, found])

        return types.Tuple((types.int64, result))(arguments), emit

    _know(kernel.symbol)
    return ask


def _require_fits(
    typing_context, kernel: Declaration, given: types.Type, wanted: types.Type
) -> None:
    if isinstance(wanted, Lent) and isinstance(given, types.BaseTuple):
        wanted = wanted.kind
    if given != wanted and typing_context.can_convert(given, wanted) is None:
        raise TypeError(f"{kernel.symbol} is given {given} for {wanted}")


def _as(context, builder, value, given: types.Type, wanted: types.Type):
    if isinstance(wanted, Lent):
        return address_of(context, builder, value, given, wanted)
    return context.cast(builder, value, given, wanted)


def _know(symbol: str) -> None:
    """Lets numba load its own copy of what calls a symbol, which nobody runs."""
    if llvm.address_of_symbol(symbol) is None:
        llvm.add_symbol(symbol, llvm.address_of_symbol("abort"))


@intrinsic
def _load(typing_context, pointer):
    def emit(context, builder, signature, values):
        kind = context.get_value_type(pointer.dtype)
        return builder.load(builder.bitcast(values[0], kind.as_pointer()))

    return pointer.dtype(pointer), emit


@intrinsic
def _store(typing_context, pointer, value):
    if typing_context.can_convert(value, pointer.dtype) is None and value != pointer.dtype:
        raise TypeError(f"the kernel gives {value} and declares {pointer.dtype}")

    def emit(context, builder, signature, values):
        found = context.cast(builder, values[1], value, pointer.dtype)
        builder.store(found, builder.bitcast(values[0], found.type.as_pointer()))

    return types.void(pointer, value), emit


_ENTRY = """
def entry(arguments, result):
    try:
        {keep}
    except Exception:
        return 1
    return 0
"""


def compiled(kernel: Declaration) -> Any:
    """numba's C function of a kernel."""
    register_all()
    kinds = tuple(map(argument_type, kernel.parameters.values()))
    result = types.int64 if kernel.result is None else type_of(kernel.result)
    function = njit(**_INNER)(kernel.function)
    given = ", ".join(f"given[{i}]" for i in range(len(kinds)))
    call = f"given = load(arguments); {'found = ' if kernel.result else ''}function({given})"
    keep = f"{call}; store(result, found)" if kernel.result is not None else call
    names = {"function": function, "load": _load, "store": _store}
    exec(_ENTRY.format(keep=keep), names)
    signature = types.int64(types.CPointer(types.Tuple(kinds)), types.CPointer(result))
    return cfunc(signature, error_model="numpy")(names["entry"])


class Made(NamedTuple):
    """An object file of a kernel, and the symbols of the kernels that it calls."""

    content: bytes
    called: tuple[str, ...]


def objects_of(kernel: Declaration, levels: Sequence[str]) -> list[Made]:
    """The object files of a kernel, for each level of processor.

    Raises:
        Exception: whatever numba says against it.
    """
    made = compiled(kernel)
    text, native = made.inspect_llvm(), made.native_name
    called = tuple(re.findall(r'(?m)^declare i64 @"?(clearance_\w+)"?\(', text))
    takers = _takers(called) if not _gives_arrays(kernel) else frozenset()
    return [Made(object_of(text, native, kernel.symbol, level, takers), called) for level in levels]


def _takers(called: Sequence[str]) -> frozenset[str]:
    """What a kernel that calls these takes memory by."""
    giving = (
        each.symbol for each in registered.kernels if each.symbol in called and _gives_arrays(each)
    )
    return frozenset({"clearance_take", *giving})


def _gives_arrays(kernel: Declaration) -> bool:
    return kernel.result is not None and holds_arrays(kernel.result)
