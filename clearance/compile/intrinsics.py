"""What intrinsics of kernels are made with. Imported when something is compiled, and not before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba.extending import overload


def stands_for(function: Callable, compiled: Callable) -> None:
    """Lets kernels call an intrinsic where their source calls a function of Python."""

    @overload(function, jit_options={"forceinline": True}, strict=False)
    def call(*arguments):
        return lambda *arguments: compiled(*arguments)


def elements_at(context, builder, kind, array, indices: Sequence[Any]) -> list[Any]:
    """Emits the addresses of numbers of an array, counted from its first: no check, no strides."""
    first = context.make_array(kind)(context, builder, array).data
    word = ir.IntType(64)
    places = [i if isinstance(i, ir.Value) else word(i) for i in indices]
    return [builder.gep(first, [place], inbounds=True) for place in places]


def llvm_function(builder, name: str, kind: ir.FunctionType) -> Any:
    """A function of LLVM's or of another module, by its name."""
    found = builder.module.globals.get(name)
    return found if found is not None else ir.Function(builder.module, kind, name)
