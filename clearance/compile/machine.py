"""What compiled code, and the last bits of what it works out, depend on beside its source.

Nothing here imports the compiler, which takes longer than most runs. Not for: settings of the compiler's own
(`numba_private`).
"""

from __future__ import annotations

import functools
import os
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path


@functools.cache
def numba_folder() -> Path:
    """Where numba lies."""
    found = find_spec("numba")
    assert found is not None and found.origin is not None, "numba is always there"
    return Path(found.origin).parent


@functools.cache
def numba_version() -> str:
    """numba's version, as its own file says."""
    spec = spec_from_file_location("clearance_numba_version", numba_folder() / "_version.py")
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return str(module.get_versions()["version"])


@functools.cache
def processor() -> tuple[str, str, str]:
    """The system, processor and its features that code is compiled for, as LLVM names them."""
    import llvmlite.binding as llvm

    name = os.environ.get("NUMBA_CPU_NAME") or llvm.get_host_cpu_name()
    features = os.environ.get("NUMBA_CPU_FEATURES")
    if features is None:
        features = llvm.get_host_cpu_features().flatten()
    return llvm.get_process_triple(), name, features
