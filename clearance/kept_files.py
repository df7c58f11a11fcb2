"""Files that this package keeps from one run to the next, and what is believed of what lies there.

What is read back may be unpickled and run, so whoever can write there can run code as this user. A folder counts
only if it and the file are of this user (or of root) and nobody else can write them. And a file counts only if it
is whole: its first bytes are the digest of its name and of the rest. What is damaged, by a power cut or a full
disk, is dropped and made again. Where nothing can be kept, everything is made in each run, with one warning that
says why. Not for: what is kept (`compile.kernel_files`, `import_statements`).
"""

from __future__ import annotations

import functools
import hashlib
import os
import stat
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

_DIGEST = 32


class KernelCacheWarning(UserWarning):
    """Compiled kernels cannot be kept; the message says why."""


@functools.cache
def cache_root() -> Path | None:
    """The folder that all is kept in; None where there is none that can be trusted."""
    try:
        root = _root_of_this_user()
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = root.stat()
    except (OSError, RuntimeError) as error:  # RuntimeError: nobody knows where the home is
        warn_not_kept(
            f"no folder for them can be made ({getattr(error, 'strerror', None) or error})"
        )
        return None
    if not _is_ours_alone(found):
        warn_not_kept(f"others own or can write {root}, and what lies there is run")
        return None
    return root


def read_kept(folder: str, name: str) -> bytes | None:
    """What lies whole and ours under a name in a folder of the cache; what is damaged is taken away."""
    root = cache_root()
    return None if root is None else _whole(root / folder / name)


def write_kept(folder: str, name: str, content: bytes) -> None:
    """Keeps `content` under a name in a folder of the cache, as a whole or not at all.

    Raises:
        OSError: there is no room, or no right to write.
    """
    root = cache_root()
    if root is None:
        return
    place = root / folder
    place.mkdir(mode=0o700, exist_ok=True)
    _write(place / name, digest_of_kept(name, content) + content)


def digest_of_kept(name: str, content: bytes) -> bytes:
    """What stands in front of the content of a file of this name."""
    digest = hashlib.sha256(name.encode() + b"\0")
    digest.update(content)
    return digest.digest()


@functools.cache
def warn_not_kept(reason: str) -> None:
    """Says once in a process why compiled kernels, which cost the most, are not kept."""
    told = f"compiled kernels are not kept, so each run compiles them anew: {reason}"
    warnings.warn(told, KernelCacheWarning, stacklevel=1)


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
    try:
        if not _is_ours_alone(path.parent.stat()):
            warn_not_kept(f"others own or can write {path.parent}, and what lies there is run")
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
    if content[:_DIGEST] == digest_of_kept(path.name, payload):
        return payload
    with suppress(OSError):
        path.unlink()
    return None


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
