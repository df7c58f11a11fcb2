"""Object files of kernels: LLVM's passes and machine code. Not for: numba (`compiler`), libraries (`linking`)."""

from __future__ import annotations

import re
from collections.abc import Set
from typing import Any

import llvmlite.binding as llvm

from clearance.compile.memory import INSTEAD_OF_COUNTS, SOURCE

llvm.initialize_native_target()
llvm.initialize_native_asmprinter()

OF_THE_SYSTEM = {
    "abort", "calloc", "acos", "asin", "atan", "atan2", "cbrt", "ceil", "copysign", "cos", "exp", "expm1", "fma",
    "fmod", "floor", "free", "hypot", "ldexp", "frexp", "log", "log10", "log1p", "log2", "malloc",
    "memcpy", "memmove", "memset", "pow", "pthread_getspecific", "pthread_key_create", "pthread_setspecific",
    "rint", "round", "sin", "sinh", "sqrt", "tan", "tanh", "trunc", "TlsAlloc", "TlsGetValue", "TlsSetValue",
}  # fmt: skip
"""What an object may need of the system; anything else but our own symbols stops the build."""


GIVING_BACK = """
declare i64 @{symbol}_inner(ptr, ptr)
declare ptr @clearance_mark_memory()
declare void @clearance_release_memory(ptr)
define i64 @{symbol}(ptr %arguments, ptr %result) {{
  %mark = call ptr @clearance_mark_memory()
  %status = call i64 @{symbol}_inner(ptr %arguments, ptr %result)
  call void @clearance_release_memory(ptr %mark)
  ret i64 %status
}}
"""


def object_of(text: str, native: str, symbol: str, level: str, takers: Set[str]) -> bytes:
    """The object file of a kernel in LLVM's language, in which it is called `native`.

    Args:
        takers: what takes memory that is given back as the kernel returns; none where its result lies in it.

    Raises:
        RuntimeError: it needs something that is neither ours nor the system's.
    """
    for name in re.findall(r"(?m)^(?:define|declare) [^@]*@([\w.]+)\(", INSTEAD_OF_COUNTS):
        text = re.sub(rf"(?ms)^define [^\n]*@{re.escape(name)}\(.*?^}}\n", "", text)
        text = re.sub(rf"(?m)^declare [^\n]*@{re.escape(name)}\(.*\n", "", text)
    module = llvm.parse_assembly(text + INSTEAD_OF_COUNTS)
    for each in (*module.functions, *module.global_variables):
        if each.name == native:
            each.name, each.linkage = symbol, "external"
        elif not each.is_declaration:
            each.linkage = "internal"
    module.verify()
    return _machine_code(module, level, symbol, takers)


def memory_object(level: str) -> bytes:
    """The object file of what kernels call for memory."""
    return _machine_code(llvm.parse_assembly(SOURCE), level, "memory")


def _machine_code(module: Any, level: str, symbol: str, takers: Set[str] = frozenset()) -> bytes:
    machine = _machine(level)
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    after = llvm.create_new_module_pass_manager()  # ways out after exceptions that cannot be
    for name in ("ipsccp", "simplify_cfg", "dead_arg_elimination", "simplify_cfg",
                 "global_dead_code_eliminate", "strip_dead_prototype"):  # fmt: skip
        getattr(after, f"add_{name}_pass")()
    after.run(module, builder)
    needed = {each.name for each in module.functions if each.is_declaration}
    if takers & needed:
        module.get_function(symbol).name = f"{symbol}_inner"
        module.link_in(llvm.parse_assembly(GIVING_BACK.format(symbol=symbol)))
    strange = {
        name for name in needed - OF_THE_SYSTEM if not name.startswith(("llvm.", "clearance_"))
    }
    if strange:
        raise RuntimeError(f"{symbol} needs {', '.join(sorted(strange))}, which no library has")
    return machine.emit_object(module)


def _machine(level: str) -> Any:
    target = llvm.Target.from_triple(llvm.get_process_triple())
    cpu = level if level.startswith("x86-64") else ""
    return target.create_target_machine(cpu=cpu, opt=2, reloc="pic", codemodel="small")
