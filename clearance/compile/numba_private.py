"""What we use of numba beyond its documented interface, with a test each (`tests/compile`).

A new numba may change any of this in a minor version, so `pyproject.toml` bounds numba to the versions that these
tests ran with. Not for: numba's libraries without its package (`machine_code`); `numba.extending` and
`numba.types`, which are documented.

| here | of numba |
|---|---|
| `own_level` | `config.OPT` is read where LLVM's passes are chosen, under the compiler's lock |
| `_without_copies` | `InlineWorker.inline_ir` makes two copies of what it merges by its module's `copy` |
| `LinkedCode` | `JITCodeLibrary`: what `finalize` does last, what `get_executable` asks of a library |
| `_CompilerOfLinkedCode`, `_tell_environments` | `Compiler.compile_extra`; environments by their names |
| `Kernel` | `CPUDispatcher`: `compile`, `get_call_template`; the flags of the caller; the option `_nrt` |
| `KernelForKernels` | `CPUDispatcher`: `_insert`, `_compile_for_args` |
| `KernelCache` | `_Cache`; `CompileResult._reduce`, `_rebuild`; `magic_tuple` names the processor |
| `entry_of` | `CompileResult`: the object file, the names of its functions, environments |
| `entry_address`, `call_at`, `stop_if` | the calling convention |
| `lend_tuple`, `borrow_tuple` | a tuple is a value that can lie on the stack |
| `elements_at`, `array_from` | an array is a structure; its `data` is where the first element lies |
| `HeapType`, `lay_on_heap` | `numba.experimental.structref`; `box` and `unbox` of what it counts references with |
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from types import SimpleNamespace

from llvmlite import ir
from numba import config, types
from numba.core import cgutils, inline_closurecall
from numba.core.caching import _Cache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.environment import lookup_environment
from numba.core.imputils import impl_ret_borrowed
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.serialize import dumps
from numba.core.targetconfig import ConfigStack
from numba.experimental import structref
from numba.extending import NativeValue, box, unbox
from numba.np.arrayobj import populate_array

from clearance.compile.heap import HeapHandle
from clearance.compile.interpreter import no_collections, with_room_for_frames
from clearance.compile.kernel_files import KernelFiles
from clearance.compile.machine_code import Entry
from clearance.compile.numba_types import form_of_types, holds_arrays, without_value

OWN_LEVEL = 1
"""LLVM's level for our functions: 40 % off the first run and 10 to 18 % off every later one (sweep, four scenes,
three alternating runs against level 3). `NUMBA_OPT` in the environment overrules it."""

_EMITTER_LEVEL = int(config.OPT)
if not config.DISABLE_JIT:
    cpu_target.target_context.codegen()  # is made now: at the process's level, and not at ours


def levels() -> tuple[int, int]:
    """The levels that our functions are optimised at, and that machine code is written at (the process's)."""
    return (int(config.OPT) if "NUMBA_OPT" in os.environ else OWN_LEVEL), _EMITTER_LEVEL


@contextmanager
def own_level() -> Iterator[None]:
    """Our level for what this thread compiles; other threads compile before or after, at theirs.

    numba has no such setting for single functions: `codegen._pass_builder` reads `config.OPT` for each module. It
    does so under the compiler's lock, which is held here too. Variables of the environment are read first, since
    the compiler would do that in the middle.
    """
    with global_compiler_lock:
        config.reload_config()
        with _in_place_of(config, "OPT", type(config.OPT)(levels()[0])):
            yield


@contextmanager
def _in_place_of(owner: object, name: str, value: object) -> Iterator[None]:
    """A value for as long as nobody puts another there."""
    before = getattr(owner, name)
    setattr(owner, name, value)
    try:
        yield
    finally:
        if getattr(owner, name) is value:
            setattr(owner, name, before)


def _without_copies() -> AbstractContextManager[None]:
    """No copies of what is merged into its caller (`inline="always"`): numba has just read it for that alone, and
    would copy it twice. Under the compiler's lock.
    """
    return _in_place_of(inline_closurecall, "copy", SimpleNamespace(deepcopy=lambda block: block))


class LinkedCode(JITCodeLibrary):
    """What is compiled of a function that only kernels call: with all it calls, and linked into its callers.

    Nobody calls it at an address of its own, so no machine code is written of it: numba would do so for each
    function of a kernel, and for each again within its callers. It is optimised where it is linked in.
    """

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=0, cost="cheap"
        )
        passes.run(self._final_module, builder)

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
        """The kernel that it is linked into is told it (`_tell_environments`)."""


class _CompilerOfLinkedCode(Compiler):
    """numba's compiler, but for where it puts what it compiles."""

    def compile_extra(self, func: Callable) -> CompileResult:
        self.state.library = LinkedCode(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


def _tell_environments(compiled: CompileResult) -> None:
    """Tells the code of a kernel the environments of the functions that are linked into it."""
    library = compiled.library
    for one in library._final_module.global_variables:
        environment = lookup_environment(one.name)
        if environment is not None and not one.is_declaration:
            library.codegen.set_env(one.name, environment)


class Kernel(CPUDispatcher):
    """A function compiled at our level, in one form for all values of its arguments.

    It is refused to callers that would lose count: a caller that counts no references must not be handed
    arrays. One form of the function serves all callers, and with the counts of the one the other would free an
    array that is in use, or never.
    """

    def compile(self, signature: object) -> object:
        if signature in self.overloads:
            return super().compile(signature)
        with own_level(), no_collections(), _without_copies():
            return with_room_for_frames(super().compile, signature)

    def add_overload(self, cres: CompileResult) -> None:
        if not isinstance(cres.library, LinkedCode):
            _tell_environments(cres)
        super().add_overload(cres)

    def get_call_template(self, args: tuple, named: dict) -> tuple:
        found = super().get_call_template(tuple(map(without_value, args)), named)
        flags = ConfigStack().top_or_none()
        returned = [form.signature.return_type for form in self.overloads.values()]
        if flags is not None and not flags.nrt and any(map(holds_arrays, returned)):
            raise TypeError(
                f"{self.py_func.__name__} returns an array to a kernel without reference counts"
            )
        return found


class KernelForKernels(Kernel):
    """A function without a way in from Python, which would take a third of the time to compile it.

    A call from Python would go to no address; so it is refused.
    """

    def _insert(self, *entry: object) -> None:
        """Nothing for Python to find."""

    def _compile_for_args(self, *args: object, **named: object) -> None:
        raise TypeError(
            f"{self.py_func.__module__}.{self.py_func.__name__} can be called by kernels only"
        )


def kernel_of(
    function: Callable,
    kind: type[Kernel] = Kernel,
    *,
    reference_counts: bool | None = None,
    **options: object,
) -> Kernel:
    """The compiled form of a function, without the GIL and with numpy's division; numba's options for the rest.

    Args:
        reference_counts: whether it counts its references; None: as its first caller does.
    """
    options |= {"nopython": True, "boundscheck": None, "nogil": True, "error_model": "numpy"}
    options["no_cfunc_wrapper"] = True
    compiler: type[Compiler] = Compiler
    if kind is KernelForKernels:
        options["no_cpython_wrapper"] = True
        compiler = _CompilerOfLinkedCode
    if reference_counts is not None:
        options["_nrt"] = reference_counts
    return kind(function, targetoptions=options, pipeline_class=compiler)


class KernelCache(_Cache):
    """Where a dispatcher asks for compiled forms and leaves them, in the files of its kernel.

    A form goes by the name of its types, processor and settings.
    """

    _enabled = True

    def __init__(self, files: KernelFiles) -> None:
        self._files = files

    @property
    def cache_path(self) -> str:
        return self._files.folder

    def load_overload(self, sig: tuple, target_context: object) -> CompileResult | None:
        if not self._enabled:
            return None
        target_context.refresh()
        payload = self._files.read(_form(sig, target_context.codegen()), "kernel")
        if payload is None:
            return None
        try:
            kept = pickle.loads(payload)
            found = CompileResult._rebuild(target_context, *kept)
        except Exception:  # of another build of numba or LLVM: compiled again, and written over
            return None
        if found.signature.args != tuple(sig):
            return None
        _, _, (code, _) = kept[0]
        found.library._compiled_object = code  # which it has let go of
        self._keep_entry(sig, found, code)
        return found

    def save_overload(self, sig: tuple, data: CompileResult) -> None:
        if self._enabled and not data.lifted and not data.library.has_dynamic_globals:
            self._files.write(_form(sig, data.codegen), "kernel", lambda: dumps(data._reduce()))
            self._keep_entry(sig, data, data.library._get_compiled_object())

    def _keep_entry(self, sig: tuple, compiled: CompileResult, code: bytes) -> None:
        form = form_of_types(sig)
        if form is not None and self._files.entry(form) is None:
            self._files.keep_entry(form, entry_of(compiled, code, 0))

    def enable(self) -> None:
        self._enabled = True

    def disable(self) -> None:
        self._enabled = False

    def flush(self) -> None:
        """Nothing is held back."""


def code_of(compiled: CompileResult) -> bytes | None:
    """The object file of what was compiled in this process or taken from the cache, while it is held."""
    return compiled.library._compiled_object


def entry_of(compiled: CompileResult, code: bytes, stamp: int) -> Entry | None:
    """The machine code of a form, or None if it cannot stand alone."""
    library, described = compiled.library, compiled.fndesc
    if compiled.reload_init or compiled.lifted or library.has_dynamic_globals:
        return None
    environments = {
        each.env_name: tuple(each.consts)
        for each in (compiled.environment, *(compiled.referenced_envs or ()))
    }
    if b"numba" in pickle.dumps(tuple(environments.values())):
        return None
    place = (described.modname, described.qualname.split(".")[-1])
    return Entry(
        code, described.llvm_cpython_wrapper_name,
        described.llvm_func_name, tuple(environments.items()), place, stamp,
    )  # fmt: skip


_SETTINGS = ("BOUNDSCHECK", "DEBUGINFO_DEFAULT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "ENABLE_AVX")
"""numba's settings that change the code of a kernel and are not in the description of its target."""


def _form(sig: tuple, codegen: object) -> str:
    settings = [int(getattr(config, name, 0) or 0) for name in _SETTINGS]
    return repr((str(sig), codegen.magic_tuple(), levels(), settings))


def entry_address(function: Kernel, argument_types: tuple) -> tuple[int, types.Type]:
    """Where the machine code of a compiled form begins, and the type of its result."""
    compiled = function.overloads[argument_types]
    address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name)
    return address, compiled.signature.return_type


def call_at(context, builder, address, result: types.Type, arguments: Sequence[types.Type], values):
    """Emits the call of a kernel by its address; what it raises is handed on."""
    kind = context.call_conv.get_function_type(result, arguments)
    place = builder.inttoptr(address, kind.as_pointer())
    unpacked = cgutils.unpack_tuple(builder, values)
    status, value = context.call_conv.call_function(builder, place, result, arguments, unpacked)
    with cgutils.if_unlikely(builder, status.is_error):
        context.call_conv.return_status_propagate(builder, status)
    return value


def stop_if(context, builder, test, error: type[Exception], *args: object) -> None:
    """Emits a test after which the kernel ends with an error, or goes on."""
    with builder.if_then(test, likely=False):
        context.call_conv.return_user_exc(builder, error, args)


def lend_tuple(context, builder, kind: types.Type, value):
    """Emits the address of a tuple that is written down for as long as the caller runs."""
    return builder.bitcast(cgutils.alloca_once_value(builder, value), context.get_value_type(kind))


def borrow_tuple(context, builder, kind: types.Type, address):
    """Emits the tuple at an address, whose arrays somebody else holds."""
    place = builder.bitcast(address, context.get_value_type(kind).as_pointer())
    return impl_ret_borrowed(context, builder, kind, builder.load(place))


def elements_at(context, builder, kind: types.Array, array, indices: Sequence):
    """Emits the addresses of numbers of an array, counted from its first: no check, no strides."""
    first = context.make_array(kind)(context, builder, array).data
    return [cgutils.gep_inbounds(builder, first, index) for index in indices]


def array_from(context, builder, kind: types.Array, address, length):
    """Emits an array of one axis over memory that somebody else holds."""
    made = context.make_array(kind)(context, builder)
    size = context.get_constant(
        types.intp, context.get_abi_sizeof(context.get_data_type(kind.dtype))
    )
    data = builder.inttoptr(address, made.data.type)
    populate_array(made, data=data, shape=[length], strides=[size], itemsize=size, meminfo=None)
    return made._getvalue()


def llvm_function(builder, name: str, kind: ir.FunctionType):
    """A function of LLVM's, by its name."""
    return cgutils.get_or_insert_function(builder.module, kind, name)


class HeapType(types.StructRef):
    """The compiler's type of a structure that lies on the heap: one subclass each."""

    def preprocess_fields(self, fields):
        """Fields of literal type are fields of that type."""
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


def lay_on_heap(handle: type[HeapHandle], fields: Sequence[str]) -> None:
    """Makes `handle(*fields)` in a kernel a structure on the heap.

    Its type, `{handle}Type` in the module of the handle, is found there by who reads back what was compiled.
    """
    name, module = f"{handle.__name__}Type", sys.modules[handle.__module__]
    kind = type(name, (HeapType,), {"__module__": handle.__module__})
    setattr(module, name, kind)
    structref.register(kind)
    structref.define_constructor(handle, kind, fields)
    memory = types.MemInfoPointer(types.voidptr)

    @box(kind)
    def to_python(structure, value, c):
        proxy = cgutils.create_struct_proxy(structure)(c.context, c.builder, value=value)
        told = str(structure), dumps(structure)
        parts = [c.pyapi.unserialize(c.pyapi.serialize_object(part)) for part in (handle, told)]
        holder = c.box(memory, proxy.meminfo)
        made = c.pyapi.call_function_objargs(parts[0], [parts[1], holder])
        for each in (*parts, holder):
            c.pyapi.decref(each)
        return made

    @unbox(kind)
    def from_python(structure, given, c):
        holder = c.pyapi.object_getattr_string(given, "_meminfo")
        proxy = cgutils.create_struct_proxy(structure)(c.context, c.builder)
        proxy.meminfo = c.unbox(memory, holder).value
        c.pyapi.decref(holder)
        return NativeValue(proxy._getvalue())
