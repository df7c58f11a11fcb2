"""Cache of searchable forms of shapes, as arrays in files: 43,000 faces need 0.3 s to build.

A file goes by the digest of what it is built from, of this package's sources, of versions and processor. So what
would be built again comes back bit for bit, and what cannot be read is built. Not for: how it is built (`tree`).
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from clearance.compile.library import processor
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.mesh.surface import Surface
from clearance.package_digest import package_digest

MOST_BYTES = 500_000_000
"""The most bytes in the cache; beyond, the oldest files go until half remain."""

_NAME = "name_of_file"
"""The array with the file's own name: a file under the name of another is not read."""


def cached_surface(shape: Polyhedron, build: Callable[[Polyhedron], Surface]) -> Surface:
    """`build(shape)`, read from the user's cache where an earlier run has built it."""
    try:
        path = _path_of(shape)
    except RuntimeError:  # nobody knows where the home is
        return build(shape)
    found = _read(path)
    if found is None:
        found = build(shape)
        with suppress(OSError):  # no space, or no right to write: it is built in each run
            _write(path, found)
            _remove_oldest(path.parent)
    return found


def _path_of(shape: Polyhedron) -> Path:
    program = (package_digest(), np.__version__, processor())
    digest = hashlib.sha256(repr(program).encode())
    for array in (shape.vertices, shape.face_starts, shape.face_vertices):
        digest.update(repr(array.shape).encode())
        digest.update(array.data)
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base, "clearance", "surfaces", f"{digest.hexdigest()}.npz")


def _read(path: Path) -> Surface | None:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            content = dict(arrays)
            own = content.pop(_NAME).item()
            return Surface(**content) if own == path.name else None
    except (
        OSError,
        ValueError,
        EOFError,
        TypeError,
        KeyError,
        zipfile.BadZipFile,
    ):  # not there, or damaged
        return None


def _write(path: Path, surface: Surface) -> None:
    """Writes a file that is there as a whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        whole = Path(folder) / path.name
        np.savez(whole, allow_pickle=False, **surface._asdict(), **{_NAME: np.array(path.name)})
        os.replace(whole, path)


def _remove_oldest(folder: Path) -> None:
    """Removes the oldest files where the cache is too large."""
    files = [(path.stat(), path) for path in folder.glob("*.npz")]
    n_bytes = sum(found.st_size for found, _ in files)
    if n_bytes <= MOST_BYTES:
        return
    for found, path in sorted(files, key=lambda one: one[0].st_mtime):
        if 2 * n_bytes <= MOST_BYTES:
            return
        path.unlink(missing_ok=True)  # another run removes it too
        n_bytes -= found.st_size
