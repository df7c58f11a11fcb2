"""Code of functions that only kernels call: linked into its callers, without an address of its own.

Of numba it uses what is not documented: `JITCodeLibrary._finalize_final_module`, what `get_executable` asks of a
library, `Compiler.compile_extra`, and environments by their names. Not for: kernels (`numba_private`).
"""

from __future__ import annotations

from collections.abc import Callable

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult
from numba.core.environment import lookup_environment


class LinkedCode(JITCodeLibrary):
    """What is compiled of a function that only kernels call: optimised, and linked into its callers.

    Nobody calls it at an address of its own, so no machine code is written of it: numba would do so for each
    function of a kernel, and for each again within its callers.
    """

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """No address."""
        return 0

    @property
    def codegen(self) -> LinkedCode:
        """What is told the function's environment."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """The kernel that it is linked into is told it (`tell_environments`)."""


class CompilerOfLinkedCode(Compiler):
    """numba's compiler, but for where it puts what it compiles."""

    def compile_extra(self, func: Callable) -> CompileResult:
        self.state.library = LinkedCode(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


def tell_environments(compiled: CompileResult) -> None:
    """Tells the code of a kernel the environments of the functions that are linked into it."""
    library = compiled.library
    for one in library._final_module.global_variables:
        environment = lookup_environment(one.name)
        if environment is not None and not one.is_declaration:
            library.codegen.set_env(one.name, environment)
