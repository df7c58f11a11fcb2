"""The library of compiled kernels: which file, whether it fits the sources, and where a kernel lies in it.

Where sources may be edited, a library that does not fit them is built again before it is used, in a process of its
own. Not for: how it is made (`build`), and how a kernel is called (`calls`).
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import platform
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

from clearance.compile.manifest import FOLDER, Manifest, is_current, read_manifest, say
from clearance.compile.registered import KERNELS, Declaration
from clearance.compile.sources import digest_of_imported
from clearance.errors import BadInput, Unavailable

INSTALL_COMPILER = "pip install -e '.[jit]' in the folder of the sources installs it"


def address_of(kernel: Declaration) -> int:
    """Where a kernel lies; it is compiled now if `CLEARANCE_KERNELS` says so, or if the library has none of it.

    Raises:
        Unavailable: it has to be compiled, and that cannot be.
    """
    found = built_address(kernel.symbol)
    if found is None:
        _require_compiler(f"{kernel.symbol} must be compiled")
        from clearance.compile.in_process import compiled_address

        found = compiled_address(kernel, processor_level(), address_of, address_of_memory)
    return found


def built_address(symbol: str) -> int | None:
    """Where a symbol of the library lies; None if it has none of that name, or is not to be used."""
    return None if KERNELS == "jit" else opened()(symbol)


def free_memory() -> None:
    """Gives back what kernels have made in this thread."""
    _free()()


@functools.cache
def _free() -> Any:
    return ctypes.CFUNCTYPE(None)(address_of_memory("clearance_free_memory"))


def address_of_memory(symbol: str) -> int:
    """Where a function of `memory` lies, for all kernels of this process."""
    found = built_address(symbol)
    if found is None:
        from clearance.compile.in_process import memory

        found = memory(processor_level())[symbol]
    return found


def _opened_shared(file: Path) -> Callable[[str], int | None]:
    """Where a symbol of a shared library lies, as the system loads it; None if there is none of that name."""
    library = ctypes.CDLL(str(file))

    def address_of(symbol: str) -> int | None:
        try:
            return ctypes.cast(library[symbol], ctypes.c_void_p).value
        except AttributeError:
            return None

    return address_of


_opening = threading.Lock()


def opened() -> Callable[[str], int | None]:
    """Where a symbol of the library for this processor lies; it is built first if it does not fit the sources.

    Raises:
        Unavailable: it has to be built, and that cannot be.
    """
    with _opening:
        return _opened()


@functools.cache
def _opened() -> Callable[[str], int | None]:
    if KERNELS not in ("built", "jit", "python"):
        raise BadInput(f"CLEARANCE_KERNELS is {KERNELS!r}", valid="built, jit or python is needed")
    if not is_current(digest_of_imported, [processor_level()]):
        _rebuild()
    manifest = read_manifest()
    assert manifest is not None
    address_of = _loaded(library_file(processor_level(), manifest.is_linked), manifest)
    ctypes.CFUNCTYPE(None)(address_of("clearance_open_memory"))()
    return address_of


def _loaded(file: Path, manifest: Manifest) -> Callable[[str], int | None]:
    """The library in a file.

    Raises:
        Unavailable: it is damaged.
    """
    try:
        if not manifest.has_whole(file.name):
            raise OSError(f"{file} is missing or cut off")
        if manifest.is_linked:
            return _opened_shared(file)
        from clearance.compile.linking import opened_pack

        return opened_pack(file)
    except (OSError, BadZipFile, ImportError, RuntimeError) as error:
        raise Unavailable(
            f"the compiled kernels cannot be loaded: {error}",
            valid=f"remove {file.name}, if it is there, and install clearance again",
        ) from None


def library_file(level: str, is_linked: bool) -> Path:
    """What is loaded on such a processor."""
    return FOLDER / f"kernels-{level}.{'so' if is_linked else 'zip'}"


def _rebuild() -> None:
    """Builds the library in a process of its own, which says how far it is."""
    import subprocess

    manifest = read_manifest()
    if manifest is None:
        fault = "the kernels are not compiled yet"
    elif not manifest.is_whole():
        fault = "a file of the compiled kernels is missing or cut off"
    else:
        fault = "the kernels have changed since they were compiled"
    _require_compiler(fault)
    say(f"{fault}: doing it now, once, which may take minutes")
    paths = [str(FOLDER.parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-P", "-m", "clearance.compile.build"],
        env={**_clean_environment(), "PYTHONPATH": os.pathsep.join(paths)},
        cwd=FOLDER.parent,
        stdout=subprocess.DEVNULL,
        check=False,
    )
    if done.returncode != 0:
        raise Unavailable("the kernels cannot be compiled", valid="the lines above say why")
    if not is_current(digest_of_imported, [processor_level()]):
        raise Unavailable(
            "the kernels have changed since this process began", valid="start it again"
        )


def _clean_environment() -> dict[str, str]:
    """The environment without what would change the kernels of the library."""
    ours = ("NUMBA_", "CLEARANCE_KERNELS")
    return {name: value for name, value in os.environ.items() if not name.startswith(ours)}


def _require_compiler(why: str) -> None:
    from importlib.util import find_spec

    if find_spec("numba") is None:
        raise Unavailable(f"{why}, and the compiler numba is not installed", valid=INSTALL_COMPILER)


def processor_level() -> str:
    """The best of the levels that are built which this processor has."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return platform.machine()
    wanted = {"avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"}
    return "x86-64-v3" if wanted <= _flags() else "x86-64-v2"


@functools.cache
def processor() -> tuple[str, str]:
    """The level that kernels run at here, and a digest of all features, by which numpy chooses its code."""
    features = " ".join((sys.platform, platform.machine(), *sorted(_flags())))
    return processor_level(), hashlib.sha256(features.encode()).hexdigest()[:8]


@functools.cache
def _flags() -> set[str]:
    if not sys.platform.startswith("linux"):
        return set()
    try:
        cpuinfo = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:  # no /proc: the lowest level runs everywhere
        return set()
    flags = (line for line in cpuinfo.splitlines() if line.startswith("flags"))
    return set(next(flags, ":").split(":", 1)[1].split())
