"""The file by which a folder is known as a store, asked for without what stores need.

Not for: opening one (`store`).
"""

from __future__ import annotations

from pathlib import Path

MARK = "store.json"


def is_store(place: Path) -> bool:
    """True if a folder is a store of whatever version."""
    return (place / MARK).is_file()
