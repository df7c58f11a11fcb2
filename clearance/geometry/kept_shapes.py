"""What is worked out of meshes once on a machine: solids of files, and the form in which they are searched.

What is kept goes by the digest of all that it is made from, by that of the sources that make it, and by versions
and processor, so that the same bits come back as would be worked out again. It is believed as compiled kernels are
(`kept_files`). Not for: how anything is worked out.
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import platform
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

import numpy as np

from clearance.compile.machine import numba_version, processor
from clearance.kept_files import cache_root, read_kept, write_kept
from clearance.source_digests import closure_digest

FOLDER = "shapes"

MOST_BYTES, MOST_FILES = 500_000_000, 10_000
"""How much is kept; past either, what was written the longest ago goes until half is left."""

T = TypeVar("T")


def name_of(*parts: object) -> str:
    """The digest of what something is made from: bytes, arrays, or what its `repr` tells."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(repr((part.shape, part.dtype.str)).encode())
            digest.update(np.ascontiguousarray(part).data)
        else:
            content = part if isinstance(part, bytes) else repr(part).encode()
            digest.update(b"%d " % len(content))
            digest.update(content)
    return digest.hexdigest()


def kept(name: str, kind: str, source: str, make: Callable[[], T]) -> T:
    """`make()`, taken from the cache where it was worked out before of what `name` stands for.

    Args:
        kind: distinguishes what is kept of one thing.
        source: the file that works it out, `__file__`.
    """
    file_name = f"{kind}-{name_of(name, _program(source))[:40]}.pickle"
    content = read_kept(FOLDER, file_name)
    if content is not None:
        with suppress(
            Exception
        ):  # of another build of a library: worked out again, and written over
            found: T = pickle.loads(content)
            return found
    made = make()
    with suppress(OSError):  # no room: it is worked out in each run
        write_kept(FOLDER, file_name, pickle.dumps(made, protocol=5))
        _make_room()
    return made


@functools.cache
def _program(source: str) -> str:
    versions = (np.__version__, numba_version(), platform.python_version(), processor())
    return f"{closure_digest([Path(source)])} {versions}"


def _make_room() -> None:
    """Takes away what was written the longest ago, where more is kept than may be."""
    root = cache_root()
    if root is None:
        return
    entries = [(entry.stat(), entry.path) for entry in os.scandir(root / FOLDER)]
    n_bytes = sum(found.st_size for found, _ in entries)
    if n_bytes <= MOST_BYTES and len(entries) <= MOST_FILES:
        return
    n_files = len(entries)
    for found, path in sorted(entries, key=lambda entry: entry[0].st_mtime):
        if 2 * n_bytes <= MOST_BYTES and 2 * n_files <= MOST_FILES:
            return
        with suppress(OSError):  # another run takes it away too
            os.unlink(path)
        n_bytes, n_files = n_bytes - found.st_size, n_files - 1
