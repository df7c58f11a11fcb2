"""Where compiled kernels are kept from one run to the next, and what is believed of what lies there.

What is read back is unpickled and run, so whoever can write there can run code as this user. A folder counts
only if it and the file are of this user (or of root) and nobody else can write them. And a file counts only if it
is whole: its first bytes are the digest of its name and of the rest. What is damaged, by a power cut or a full
disk, is dropped and compiled again. Where nothing can be kept, everything is compiled in each run, with one
warning that says why. Not for: when a kernel is compiled (`jit`, `kernel_table`).
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import stat
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

_DIGEST = 32
_SETTINGS = ("OPT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "ENABLE_AVX")
"""numba's settings that change the code of a kernel and are not in the description of its target."""


class KernelCacheWarning(UserWarning):
    """Compiled kernels cannot be kept; the message says why."""


class KernelCache(_Cache):
    """The compiled forms of one kernel, a file for each.

    Args:
        source_key: names the folder; another one where the kernel's source is another.
    """

    def __init__(self, function, source_key: str) -> None:
        self._function = function
        self._name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        self._stem = f"{self._name}-{sys.implementation.cache_tag}-{numba.__version__}"
        self._source_key = source_key
        self._enabled = True

    @property
    def cache_path(self) -> str:
        root = cache_root()
        return "" if root is None else str(root / self._source_key)

    def holds_any(self) -> bool:
        """True if any form lies there, for this interpreter and this processor or others."""
        return bool(self.cache_path) and any(Path(self.cache_path).glob(f"{self._stem}.*.kernel"))

    def load_overload(self, sig: tuple, target_context) -> CompileResult | None:
        target_context.refresh()
        root = cache_root() if self._enabled else None
        if root is None:
            return None
        path = root / self._source_key / self._file_name(sig, target_context.codegen())
        payload = _whole(path)
        if payload is None:
            return None
        try:
            found = CompileResult._rebuild(target_context, *pickle.loads(payload))
            return found if found.signature.args == tuple(sig) else None
        except Exception:  # of another build of numba or LLVM: compiled again, and written over
            return None

    def save_overload(self, sig: tuple, data: CompileResult) -> None:
        root = cache_root() if self._enabled else None
        if root is None or data.lifted or data.library.has_dynamic_globals:
            return
        name = self._file_name(sig, data.codegen)
        payload = dumps(data._reduce())
        try:
            folder = root / self._source_key
            folder.mkdir(mode=0o700, exist_ok=True)
            _write(folder / name, _digest(name, payload) + payload)
        except OSError as error:
            _warn(f"{root} cannot be written ({error.strerror or error})")

    def _file_name(self, sig: tuple, codegen) -> str:
        settings = [int(getattr(numba.config, name, 0) or 0) for name in _SETTINGS]
        key = (str(sig), codegen.magic_tuple(), self._function.__code__.co_code, settings)
        return f"{self._stem}.{hashlib.sha256(repr(key).encode()).hexdigest()[:32]}.kernel"

    def enable(self) -> None:
        self._enabled = True

    def disable(self) -> None:
        self._enabled = False

    def flush(self) -> None:
        """Nothing is held back."""


@functools.cache
def cache_root() -> Path | None:
    """The folder that compiled kernels are kept in; None where there is none that can be trusted."""
    try:
        root = _root_of_this_user()
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = root.stat()
    except (OSError, RuntimeError) as error:  # RuntimeError: nobody knows where the home is
        _warn(f"no folder for them can be made ({getattr(error, 'strerror', None) or error})")
        return None
    if not _is_ours_alone(found):
        _warn(f"others own or can write {root}, and what lies there is run")
        return None
    return root


def _root_of_this_user() -> Path:
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return Path(given).absolute() / "clearance"
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base).absolute() / "clearance" / "compiled"


def _is_ours_alone(found: os.stat_result) -> bool:
    """True for what this user or root owns and nobody else can write."""
    if not hasattr(os, "geteuid"):
        return True  # on Windows rights are not in the mode, and a profile is its user's
    return found.st_uid in (os.geteuid(), 0) and not found.st_mode & 0o022


def _whole(path: Path) -> bytes | None:
    """The payload of a file that is ours and whole; what is damaged is taken away."""
    try:
        if not _is_ours_alone(path.parent.stat()):
            _warn(f"others own or can write {path.parent}, and what lies there is run")
            return None
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0))
        with open(descriptor, "rb") as file:
            found = os.fstat(descriptor)
            if not stat.S_ISREG(found.st_mode) or not _is_ours_alone(found):
                return None
            content = file.read()
    except OSError:
        return None
    payload = content[_DIGEST:]
    if content[:_DIGEST] == _digest(path.name, payload):
        return payload
    with suppress(OSError):
        path.unlink()
    return None


def _digest(name: str, payload: bytes) -> bytes:
    digest = hashlib.sha256(name.encode() + b"\0")
    digest.update(payload)
    return digest.digest()


def _write(path: Path, content: bytes) -> None:
    """Writes a file that is there as a whole or not at all, as far as a running system is concerned."""
    handle, partial = tempfile.mkstemp(prefix=".", suffix=".partial", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(partial, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(partial)
        raise


@functools.cache
def _warn(reason: str) -> None:
    """Says once in a process why compiled kernels are not kept."""
    told = f"compiled kernels are not kept, so each run compiles them anew: {reason}"
    warnings.warn(told, KernelCacheWarning, stacklevel=1)
