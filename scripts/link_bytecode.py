"""Lays what pip has compiled where `PYTHONPYCACHEPREFIX` looks for it, so that no process compiles it once more.

    PYTHONPYCACHEPREFIX=FOLDER python scripts/link_bytecode.py

Links take no room, and Python itself sees whether one belongs to its source. Not for: sources of our own.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path


def link_bytecode(sources: Path) -> None:
    """Links each compiled file in the `__pycache__` folders below; what cannot be linked is left out."""
    for folder, _, names in os.walk(sources):
        if os.path.basename(folder) == "__pycache__":
            for name in names:
                module, _, rest = name.partition(".")
                if rest == f"{sys.implementation.cache_tag}.pyc":
                    with suppress(OSError):  # another disk, no right, or there already
                        _link(Path(folder, name), Path(folder).parent / f"{module}.py")


def _link(compiled: Path, source: Path) -> None:
    place = Path(cache_from_source(str(source)))
    place.parent.mkdir(parents=True, exist_ok=True)
    os.link(compiled, place)


if __name__ == "__main__":
    for library in {sysconfig.get_path(name) for name in ("purelib", "platlib")}:
        link_bytecode(Path(library))
