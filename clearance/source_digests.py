"""What results can depend on in this package's sources, as one digest, worked out once for each state of them.

Reading these files and following their imports took a twentieth of a short run, to the same end each time. So a
digest is kept, and believed while each source of the package has the place, inode, size and both times that it
had. A source that was changed within the last seconds may change again without showing it: then nothing is kept.
Not for: which files count (`import_closure`).
"""

from __future__ import annotations

import atexit
import functools
import hashlib
import json
import os
import sys
import time
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from clearance.import_closure import PACKAGE, digest_of, import_closure
from clearance.kept_files import read_kept, write_kept

SETTLED = 2 * 10**9
"""[ns] How long ago a source must have been changed for its times to be believed, as coarse clocks are."""

_FOLDER = "imports"


def closure_digest(
    paths: Iterable[Path], package: Path = PACKAGE, leave_out: Collection[str] = ()
) -> str:
    """`digest_of(import_closure(paths, package, leave_out), package)`.

    Raises:
        UnknownImport: as `import_closure`.
    """
    roots = sorted({*paths})
    if not all(root.is_relative_to(package) for root in roots):
        return digest_of(import_closure(roots, package, leave_out), package)
    told = repr((list(map(str, roots)), sorted(leave_out)))
    asked = hashlib.sha256(told.encode()).hexdigest()
    kept = _kept(package)
    if asked not in kept.known:
        found = digest_of(import_closure(roots, package, leave_out), package)
        kept.known[asked] = kept.new[asked] = found
    return kept.known[asked]


class _DigestStore(NamedTuple):
    """Digests by what was asked for: all that are known, and those that are not kept yet."""

    known: dict[str, str]
    new: dict[str, str]


@functools.cache
def _kept(package: Path) -> _DigestStore:
    """What earlier runs of the same sources have kept; what this one adds is written when it ends."""
    state = _state(package, time.time_ns())
    file_name = _file_name(package)
    kept = _DigestStore({} if state is None else _read(file_name, state), {})
    if state is not None:
        atexit.register(_write, file_name, state, kept.new)
    return kept


def _state(package: Path, now: int) -> str | None:
    """A digest of where all sources lie and when they were changed; None where that was just now."""
    try:
        found = sorted(_sources(str(package)))
    except OSError:  # the package lies in no folder
        return None
    newest = max(max(times) for _, times in found)
    return None if newest > now - SETTLED else hashlib.sha256(repr(found).encode()).hexdigest()


def _sources(folder: str) -> Iterator[tuple[tuple[str, int, int, int], tuple[int, int]]]:
    """Place, device, inode and size of each source in a folder, and when content and status were changed [ns]."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                found = entry.stat()
                place = (entry.path, found.st_dev, found.st_ino, found.st_size)
                yield place, (found.st_mtime_ns, found.st_ctime_ns)
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _sources(entry.path)


def _read(file_name: str, state: str) -> dict[str, str]:
    content = read_kept(_FOLDER, file_name)
    with suppress(ValueError, KeyError, TypeError):
        told = {} if content is None else json.loads(content)
        if told["state"] == state:
            return dict(told["digests"])
    return {}


def _write(file_name: str, state: str, new: dict[str, str]) -> None:
    if not new:
        return
    told = {"state": state, "digests": {**_read(file_name, state), **new}}
    with suppress(OSError):  # no room: the next run reads the sources again
        write_kept(_FOLDER, file_name, json.dumps(told, sort_keys=True).encode())


def _file_name(package: Path) -> str:
    """One for each place of the package, and each interpreter, which may read a source otherwise."""
    place = hashlib.sha256(os.fsencode(package)).hexdigest()[:16]
    return f"digests-{sys.implementation.cache_tag}-{place}.json"
