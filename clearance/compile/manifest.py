"""What is written down beside the library of kernels: what it was made of, and whether it fits.

Not for: the library itself (`library`), and how it is made (`build`).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent / "built"
"""Where the library lies, beside the package's sources."""


class Manifest(NamedTuple):
    """What `build` says of a library.

    Attributes:
        sources: hash of all that it was made of.
        is_linked: True for a shared library, False for objects that llvmlite links.
        sizes: [bytes] of each file of the library, by its name.
        is_checked: True where the sources may be edited: each start compares the hash.
    """

    sources: str
    is_linked: bool
    sizes: Mapping[str, int]
    is_checked: bool = True

    def is_whole(self) -> bool:
        """True if no file of the library is missing or cut off: to load such a one can stop the process."""
        return all(map(self.has_whole, self.sizes))

    def has_whole(self, name: str) -> bool:
        """True if this file is there with all its bytes."""
        file = FOLDER / name
        return file.is_file() and file.stat().st_size == self.sizes.get(name)


def read_manifest() -> Manifest | None:
    """What is said of the library; None where nothing is said that can be read."""
    try:
        return Manifest(**json.loads((FOLDER / "manifest.json").read_text()))
    except (FileNotFoundError, ValueError, TypeError):
        return None


def is_current(sources: Callable[[], str], levels: Sequence[str]) -> bool:
    """True if there is a library of these levels that fits the sources of this hash; that of a wheel does."""
    manifest = read_manifest()
    if manifest is None or not manifest.is_checked:
        return manifest is not None
    built = {Path(name).stem for name in manifest.sizes}
    is_of_levels = built >= {f"kernels-{level}" for level in levels}
    return is_of_levels and manifest.sources == sources() and manifest.is_whole()


def say(text: str) -> None:
    """Tells the user what takes long."""
    print(f"clearance: {text}", file=sys.stderr, flush=True)
