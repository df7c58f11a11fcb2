"""Compiles what measuring needs before several processes would, each for itself.

Compilers on one machine take turns, and each writes a file under a name of its own before it takes its place. So
no two ever write one file, and who comes second finds all there. Not for: when a kernel is compiled otherwise
(`compile.kernel_table`).
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext

import clearance.kernels.motion.certify
import clearance.kernels.search.body_pair  # noqa: F401 - both enter their kernels in the table
from clearance.compile import kernel_table
from clearance.compile.kernel_table import CERTIFY, REFINE, SEARCH, SEPARATING_PLANES
from clearance.kept_files import cache_root
from clearance.progress import COMPILING

NEEDED = (SEARCH, REFINE, SEPARATING_PLANES, CERTIFY)
"""What every case needs; others are compiled where a case comes to them."""


def compile_ahead(say: Callable[[str], None] = lambda line: None) -> None:
    """Compiles what this machine has not yet, alone among those that do.

    Args:
        say: told one line if there is anything to compile.
    """
    from filelock import FileLock

    if all(map(kernel_table.is_kept, NEEDED)):
        return
    say(COMPILING)
    root = cache_root()
    turn = nullcontext() if root is None else FileLock(root / "ahead.lock", fallback_to_soft=False)
    with turn:
        for place in NEEDED:
            if not kernel_table.is_kept(place):
                kernel_table.compile_kernel(place)
