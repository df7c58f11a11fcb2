"""Which variables of the environment xacro files ask for, as they write it: `$(env X)` and `$(optenv X …)`.

Not for: evaluating them (`xacro_process`), nor names that are themselves put together by xacro.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from clearance.formats.files.input_files import regular_file
from clearance.world.case import Source

_SUFFIXES = frozenset({".xacro", ".xml", ".urdf"})

_ASKED = re.compile(rb"\$\(\s*(?:opt)?env\s+([A-Za-z_]\w*)")


def variables_asked(sources: Iterable[Source]) -> tuple[str, ...]:
    """The names of the variables that some files ask for, sorted."""
    files = [one for one in sources if os.path.splitext(one.read_from)[1].lower() in _SUFFIXES]
    return tuple(sorted({name for one in files for name in _in_file(one.read_from, one.sha256)}))


@lru_cache(maxsize=256)
def _in_file(path: str, sha256: str) -> frozenset[str]:
    """Those of one file, by its content; of one that is gone none, and its case is then measured again."""
    try:
        with regular_file(Path(path)) as file:
            return frozenset(name.decode() for name in _ASKED.findall(file.read()))
    except OSError:
        return frozenset()
