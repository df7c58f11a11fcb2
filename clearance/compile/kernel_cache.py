"""The compiled forms of kernels, a file for each.

Not for: when a kernel is compiled (`jit`, `kernel_table`), and what is believed of a file (`kept_files`).
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable
from pathlib import Path

import numba

from clearance.compile.numba_private import KeptKernels
from clearance.kept_files import cache_root, read_kept, warn_not_kept, write_kept


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
        return read_kept(self._source_key, self._file_name(named))

    def write(self, named: str, payload: Callable[[], bytes]) -> None:
        root = cache_root()
        if root is None:
            return
        content = payload()
        try:
            write_kept(self._source_key, self._file_name(named), content)
        except OSError as error:
            warn_not_kept(f"{root} cannot be written ({error.strerror or error})")

    def _file_name(self, named: str) -> str:
        digest = hashlib.sha256(repr((named, self._code)).encode()).hexdigest()
        return f"{self._stem}.{digest[:32]}.kernel"
