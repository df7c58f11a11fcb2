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
import stat
import sys
import tempfile
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numba

from clearance.compile.numba_private import KeptKernels

_DIGEST = 32


class KernelCacheWarning(UserWarning):
    """Compiled kernels cannot be kept; the message says why."""


class KernelCache(KeptKernels):
    """The compiled forms of one kernel, a file for each.

    Args:
        source_key: names the folder; another one where the kernel's source is another.
    """

    def __init__(self, function: Callable, source_key: str) -> None:
        self._code = function.__code__.co_code
        name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        self._stem = f"{name}-{sys.implementation.cache_tag}-{numba.__version__}"
        self._source_key = source_key

    @property
    def cache_path(self) -> str:
        root = cache_root()
        return "" if root is None else str(root / self._source_key)

    def holds_any(self) -> bool:
        """True if any form lies there, for this interpreter and this processor or others."""
        return bool(self.cache_path) and any(Path(self.cache_path).glob(f"{self._stem}.*.kernel"))

    def read(self, named: str) -> bytes | None:
        root = cache_root()
        return None if root is None else _whole(root / self._source_key / self._file_name(named))

    def write(self, named: str, payload: Callable[[], bytes]) -> None:
        root = cache_root()
        if root is None:
            return
        name, content = self._file_name(named), payload()
        try:
            folder = root / self._source_key
            folder.mkdir(mode=0o700, exist_ok=True)
            _write(folder / name, _digest(name, content) + content)
        except OSError as error:
            _warn(f"{root} cannot be written ({error.strerror or error})")

    def _file_name(self, named: str) -> str:
        digest = hashlib.sha256(repr((named, self._code)).encode()).hexdigest()
        return f"{self._stem}.{digest[:32]}.kernel"


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
        descriptor = os.open(
            path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        )
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
