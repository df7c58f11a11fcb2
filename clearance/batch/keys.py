"""The key of a case: what decides its row, as one hash. Two cases of one key have the same row.

It is of the program and its libraries, of what is asked, and of every file that was read, by content. The
processor is not in it: another one may differ in the last bits, no more than the bounds allow. Not for: hashing
files quickly (`file_hashes`).
"""

from __future__ import annotations

import functools
import hashlib
import os
import platform
from collections.abc import Iterable
from importlib import metadata
from pathlib import PurePath

from clearance.batch.item import Item
from clearance.extras import is_installed
from clearance.package_digest import package_digest
from clearance.world.case import LOOKUP

FORMAT = 1
"""Of the rows; another one makes all keys new."""

DAY = "(day)"
"""Stands among the files of a case that has waivers, with the day in place of a hash."""

LIBRARIES = ("numpy", "scipy", "trimesh", "shapely", "lxml", "ruamel.yaml")
"""Those that can change a row beside this package; pyarrow's numbers are exact."""

READERS = ("xacro", "cascadio", "rosbags", "ezdxf", "mujoco")
"""Those that read inputs of some kinds, where they are installed."""


def variable_mark(name: str) -> str:
    """Stands among the files of a case that depends on a variable, with its `value_digest` in place of a hash."""
    return f"(${name})"


def variable_of(mark: str) -> str:
    """The variable that a mark is of."""
    return mark[2:-1]


def value_digest(name: str) -> str:
    """sha256 of a variable's value, which may be no one's business; empty where it is not set."""
    value = os.environ.get(name)
    return "" if value is None else hashlib.sha256(os.fsencode(value)).hexdigest()


@functools.cache
def program() -> str:
    """sha256 of all sources of this package, presets among them, and of the versions below them."""
    versions = [(name, metadata.version(name)) for name in (*LIBRARIES, "pyarrow")]
    versions += [(name, metadata.version(name)) for name in READERS if is_installed(name)]
    parts = (package_digest(), FORMAT, versions, platform.python_version(), platform.machine())
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def key_of(item: Item, files: Iterable[tuple[str, str]]) -> str:
    """The key of an item.

    Args:
        files: path as shown and sha256 of each file that was read; where a search led is no part of the key, since
            the files that it led to are.
    """
    given = item.trajectory
    name: tuple[object, ...]
    if given is None:
        path = PurePath(item.file)
        name = (path.parent.name, path.name)  # a case without a name takes theirs
    else:
        name = (item.name, given.reading, given.robot)
    read = sorted({one for one in files if not one[0].startswith(LOOKUP)})
    asked = (program(), name, item.options.key, read)
    return hashlib.sha256(repr(asked).encode()).hexdigest()
