"""What is written down beside the library of kernels: what it was made of, and whether it fits.

Not for: the library itself (`library`), and how it is made (`build`).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent / "built"
"""Where the library lies, beside the package's sources."""


class Manifest(NamedTuple):
    """What `build` says of a library.

    Attributes:
        sources: hash of all that it was made of.
        is_linked: True for a shared library, False for objects that llvmlite links.
        is_checked: True where the sources may be edited: each start compares the hash.
    """

    sources: str
    is_linked: bool
    is_checked: bool = True


def read_manifest() -> Manifest | None:
    """What is said of the library; None where there is none."""
    try:
        return Manifest(**json.loads((FOLDER / "manifest.json").read_text()))
    except FileNotFoundError:
        return None


def is_current(sources: Callable[[], str]) -> bool:
    """True if there is a library that fits the sources of this hash; that of a wheel does."""
    manifest = read_manifest()
    if manifest is None or not manifest.is_checked:
        return manifest is not None
    return manifest.sources == sources()


def say(text: str) -> None:
    """Tells the user what takes long."""
    print(f"clearance: {text}", file=sys.stderr, flush=True)
