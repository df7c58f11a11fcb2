"""Where files that are named lie on this machine, while a case that came in one file is read.

Its files keep their places to each other below the folder that they are unpacked into. That folder stands for one
of the machine that packed them, so absolute paths and variables of the environment lead into it as well. Not for:
packing (`pack`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Place:
    """A folder that stands for another.

    Attributes:
        folder: absolute, here. packages: the folder of what packages of Python bring, here.
        stands_for: absolute, on the machine that packed; empty where nothing is named by an absolute path.
        variables: values of the variables that lead to packages, as `folder` has these.
    """

    folder: str
    packages: Path
    stands_for: str = ""
    variables: Mapping[str, str] = field(default_factory=dict)


_PLACE: ContextVar[Place | None] = ContextVar("place", default=None)


@contextmanager
def reading_in(place: Place) -> Iterator[None]:
    """Names lead into this place until the block ends."""
    token = _PLACE.set(place)
    try:
        yield
    finally:
        _PLACE.reset(token)


def current_place() -> Place | None:
    """The place that names lead into; None where they mean what they say."""
    return _PLACE.get()


def here(path: str | Path) -> Path:
    """Where a path lies on this machine."""
    place = _PLACE.get()
    if place is None or not place.stands_for or not os.path.isabs(path):
        return Path(path)
    below = os.path.relpath(path, place.stands_for)
    is_here = os.path.abspath(path).startswith(os.path.join(place.folder, ""))
    is_outside = below.split(os.sep)[0] == os.pardir
    return Path(path) if is_here or is_outside else Path(place.folder, below)


def top() -> str:
    """The folder here that is the root of the file system, if it does not stand for another folder."""
    place = _PLACE.get()
    whole = place is not None and place.stands_for == os.path.abspath(os.sep)
    return place.folder if place is not None and whole else os.path.abspath(os.sep)


def environment() -> Mapping[str, str]:
    """The variables that name folders with packages, among others."""
    place = _PLACE.get()
    return os.environ if place is None else place.variables
