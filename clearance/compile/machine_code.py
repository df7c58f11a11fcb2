"""Machine code of an earlier run, put into memory and called without the compiler.

The code is what numba has compiled, byte for byte. It calls Python, libm and numba's run time (reference counts,
arrays in and out), which is a few small libraries of numba's that stand on their own. Not for: which code is right
for a call (`ready_kernel`), and what is believed of a file (`kept_files`).

| here | of numba, beyond its documented interface |
|---|---|
| `_library` | `_helperlib`, `_dynfunc` and `_nrt_python` can be loaded without the package |
| `_symbols` | what compiled code calls their functions, None and the exceptions of Python |
| `_unpickled` | `numba_unpickle(data, length, digest)` gives a constant of compiled code back |
| `Entry.environments` | an `Environment` holds a function's constants; a variable of the code points to it |
"""

from __future__ import annotations

import builtins
import ctypes
import functools
import pickle
import struct
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any, NamedTuple

import llvmlite.binding as llvm

from clearance.compile.machine import numba_folder


class Entry(NamedTuple):
    """One compiled form of a kernel.

    Attributes:
        code: an object file.
        wrapper: the name of the function in it that Python calls.
        function: the name of the one that kernels call.
        environments: name and constants of each.
        place: module and name of what it was compiled from.
        stamp: stands for the types of arguments and result, in the table of kernels.
    """

    code: bytes
    wrapper: str
    function: str
    environments: tuple[tuple[str, tuple[Any, ...]], ...]
    place: tuple[str, str]
    stamp: int


class LoadedEntry(NamedTuple):
    """An entry in memory: what Python calls, and the address that kernels call."""

    call: Any
    address: int
    stamp: int


def load(entry: Entry) -> LoadedEntry | None:
    """The entry in memory, for as long as the process lives; None where something that it calls is not there."""
    _symbols()
    engine = _engine()  # which opens what this process has loaded to the next question
    if any(llvm.address_of_symbol(name) is None for name in undefined_symbols(entry.code)):
        return None
    engine.add_object_file(llvm.ObjectFileRef.from_data(entry.code))
    engine.finalize_object()
    module = sys.modules[entry.place[0]]
    environments = []
    for name, constants in entry.environments:
        environment = _library("_dynfunc").Environment(module.__dict__)
        environment.consts.extend(constants)
        at = engine.get_global_value_address(name)
        ctypes.c_void_p.from_address(at).value = id(environment)
        environments.append(environment)
    call = _library("_dynfunc").make_function(
        module,
        entry.place[1],
        "",
        engine.get_function_address(entry.wrapper),
        environments[0],
        (engine, environments),
    )
    _alive.append(call)
    return LoadedEntry(call, engine.get_function_address(entry.function), entry.stamp)


_alive: list[Any] = []


def undefined_symbols(code: bytes) -> list[str]:
    """The names that an object file (ELF, 64 bits, little endian) needs from elsewhere."""
    assert code[:6] == b"\x7fELF\x02\x01"
    at, size, n_sections = (
        struct.unpack_from("<Q", code, 40)[0],
        *struct.unpack_from("<HH", code, 58),
    )
    found = []
    for i in range(n_sections):
        kind, _, _, start, length, link = struct.unpack_from("<IQQQQI", code, at + i * size + 4)
        if kind != 2:  # the table of symbols
            continue
        names = struct.unpack_from("<Q", code, at + link * size + 24)[0]
        for place in range(start + 24, start + length, 24):  # the first one is none
            name, _, _, section = struct.unpack_from("<IBBH", code, place)
            if section == 0:
                begin = names + name
                found.append(code[begin : code.index(b"\0", begin)].decode())
    return found


def _engine() -> Any:
    """Room for one object file, as the compiler's own has it."""
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        reloc="static", codemodel="jitdefault"
    )
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


@functools.cache
def _symbols() -> None:
    """Tells LLVM where numba's run time is."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    for library in ("_helperlib", "_dynfunc"):
        for name, address in _library(library).c_helpers.items():
            llvm.add_symbol(f"numba_{name}", address)
    for name, address in _library("core.runtime._nrt_python").c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
    llvm.add_symbol("_Py_NoneStruct", id(None))  # by address of the object, as these
    for kind in vars(builtins).values():
        if isinstance(kind, type) and issubclass(kind, BaseException):
            llvm.add_symbol(f"PyExc_{kind.__name__}", id(kind))
    llvm.add_symbol("numba_unpickle", ctypes.cast(_unpickled, ctypes.c_void_p).value)


@ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)
def _unpickled(data: int, length: int, digest: int) -> Any:
    key = (data, ctypes.string_at(digest, 20))
    if key not in _constants:
        _constants[key] = pickle.loads(ctypes.string_at(data, length))
    return _constants[key]


_constants: dict[tuple[int, bytes], Any] = {}


def _library(name: str) -> Any:
    """A library of numba's, as the package itself would find it loaded if it were imported later."""
    full_name = f"numba.{name}"
    if full_name not in sys.modules:
        folder = numba_folder().joinpath(*name.split(".")[:-1])
        path = next(
            path
            for suffix in EXTENSION_SUFFIXES
            if (path := folder / f"{name.split('.')[-1]}{suffix}").is_file()
        )
        spec = spec_from_file_location(full_name, path)
        assert spec is not None and spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        sys.modules[full_name] = module
    return sys.modules[full_name]
