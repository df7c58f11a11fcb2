"""The files of one kernel's compiled forms in the cache.

Two kinds: what the compiler reads back (`.kernel`), and bare machine code that is called without the compiler
(`.entry`, see `machine_code`). Not for: what is in them, and what is believed of a file (`kept_files`).
"""

from __future__ import annotations

import functools
import hashlib
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.compile.machine import numba_version, processor
from clearance.kept_files import cache_root, read_kept, warn_not_kept, write_kept
from clearance.source_digests import closure_digest

if TYPE_CHECKING:
    from clearance.compile.machine_code import Entry


class KernelFiles:
    """The files of one function's forms; their folder is named for the sources that it is compiled from."""

    def __init__(self, function: Callable, source_key: str) -> None:
        self._code = function.__code__.co_code
        name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        self._stem = f"{name}-{sys.implementation.cache_tag}-{numba_version()}"
        self.folder = source_key

    def holds_any(self) -> bool:
        """True if any form lies there, for this interpreter and this processor or others."""
        root = cache_root()
        return root is not None and any((root / self.folder).glob(f"{self._stem}.*.kernel"))

    def read(self, named: str, kind: str) -> bytes | None:
        """What is kept of the form of that name."""
        return read_kept(self.folder, self._file_name(named, kind))

    def write(self, named: str, kind: str, payload: Callable[[], bytes]) -> None:
        """Keeps a form; where that cannot be, a warning says so once."""
        root = cache_root()
        if root is None:
            return
        content = payload()
        try:
            write_kept(self.folder, self._file_name(named, kind), content)
        except OSError as error:
            warn_not_kept(f"{root} cannot be written ({error.strerror or error})")

    def entry(self, form: object) -> Entry | None:
        """The machine code of a form, as `form_of` tells it; None where none lies ready."""
        content = self.read(_named(form), "entry")
        with suppress(Exception):  # of another build: compiled again, and written over
            return None if content is None else pickle.loads(content)
        return None

    def keep_entry(self, form: object, entry: Entry | None) -> None:
        """Keeps the machine code of a form, if it can stand alone."""
        if entry is not None:
            self.write(_named(form), "entry", lambda: pickle.dumps(entry, protocol=5))

    def _file_name(self, named: str, kind: str) -> str:
        digest = hashlib.sha256(repr((named, self._code)).encode()).hexdigest()
        return f"{self._stem}.{digest[:32]}.{kind}"


def _named(form: object) -> str:
    return repr((form, processor()))


def files_of(function: Callable) -> KernelFiles:
    """The files of a kernel, by its own source, this room's and all that its source imports."""
    return KernelFiles(function, _source_key(Path(function.__code__.co_filename)))


@functools.cache
def _source_key(path: Path) -> str:
    return closure_digest([path, *_ROOM])[:16]


_ROOM = sorted(Path(__file__).parent.glob("*.py"))
