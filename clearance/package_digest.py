"""The sources of this package as one digest: with a change of any, all that is made counts as another program's.

Not for: which libraries and what machine stand below them (`simulate.fingerprint`, `batch.keys`).
"""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parent

SOURCES = (".py", ".yaml", ".html", ".css", ".js")
"""Suffixes of what decides rows or pages: code, presets, and what pages are made of."""


@functools.cache
def package_digest() -> str:
    """sha256 of all sources of this package, with their places in it."""
    return digest_of_sources(PACKAGE)


def digest_of_sources(folder: Path) -> str:
    """sha256 of the sources in a folder and below it, with their places in it."""
    digest = hashlib.sha256()
    for place, path in sorted(_sources(str(folder))):
        with open(path, "rb") as file:
            content = file.read()
        digest.update(f"{place} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def _sources(folder: str) -> Iterator[tuple[str, str]]:
    """Each source's place in the folder, with slashes, and its path."""
    for above, _, names in os.walk(folder):
        for name in names:
            if name.endswith(SOURCES):
                path = os.path.join(above, name)
                yield path[len(folder) + 1 :].replace(os.sep, "/"), path
