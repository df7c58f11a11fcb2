"""The marks that follow from the names that a test, its fixtures and their callees in `tests` and `makers` use.

`cold`: starts a process, or begins with empty caches. `browser`: drives Chromium. `peer`: asks another
library the same question. `shared`: reads the cases beside the repository. What no name gives away carries
its mark by hand; `guards` fails a test that does what it has no mark for.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

from tests.shared_cases import SHARED_CASES

TESTS = Path(__file__).parent
MAKERS = TESTS.parent / "scripts" / "makers"
PEERS = {
    "coal",
    "fcl",
    "klampt",
    "manifold3d",
    "pinocchio",
    "pybullet",
    "shapely",
    "solvespace",
    "trimesh",
    "yourdfpy",
}
COLD_NAMES = {"fork", "XDG_CACHE_HOME"}


def marks_of(functions: Iterable[Callable]) -> set[str]:
    """The marks of a test, given its function and its fixtures'."""
    found, waiting, seen = set(), [_unwrapped(f) for f in functions], set()
    while waiting:
        one = waiting.pop()
        if one is not None and one not in seen:
            seen.add(one)
            marks, callees = _looked_at(one)
            found |= marks
            waiting.extend(callees)
    return found


@functools.cache
def _looked_at(function: FunctionType) -> tuple[frozenset[str], tuple[FunctionType, ...]]:
    """The marks of what a function itself uses, and what it may call in `tests` and `makers`."""
    used = list(_used(function))
    marks = frozenset(mark for value in used for mark in _marks_of_value(value))
    return marks, tuple(callee for value in used for callee in _functions_of(value))


def _functions_of(value: object) -> list[FunctionType]:
    """The functions of `tests` and `makers` that come with a value: itself, or a class's methods."""
    if isinstance(value, str | tuple | int | float | None):
        return []
    values = vars(value).values() if isinstance(value, type) else [value]
    functions = map(_unwrapped, values)
    return [
        f
        for f in functions
        if f is not None and f.__code__.co_filename.startswith((str(TESTS), str(MAKERS)))
    ]


def _unwrapped(value: object) -> FunctionType | None:
    """The plain function below decorators."""
    while hasattr(value, "__wrapped__"):
        value = value.__wrapped__
    inner = getattr(value, "hypothesis", None)
    value = value if inner is None else inner.inner_test
    return value if isinstance(value, FunctionType) else None


def _used(function: FunctionType) -> Iterator[object]:
    """All names, globals, constants and modules that a function uses.

    A name counts as each of the things it may be: code keeps one list for globals, attributes and modules, and
    to tell them apart step by step takes twenty times as long.
    """
    for code in _codes(function.__code__):
        yield from code.co_consts
        if _asks_for_a_cross_check(code):
            yield Imported("clearance.crosscheck")
        for name in code.co_names:
            yield name
            yield Imported(name)
            yield function.__globals__.get(name)


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _asks_for_a_cross_check(code: CodeType) -> bool:
    """True if it may call something with `cross_check=True`; a record is also made with what one has said."""
    keywords = [names for names in code.co_consts if isinstance(names, tuple)]
    given = any(isinstance(x, str) and x == "cross_check" for names in keywords for x in names)
    return given and any(value is True for value in code.co_consts)


class Imported(str):
    """A name that may be that of a module which a function imports."""


def _marks_of_value(value: object) -> Iterator[str]:
    if isinstance(value, Path):
        if str(value).startswith(str(SHARED_CASES)):
            yield "shared"
    elif isinstance(value, ModuleType | Imported):
        yield from _marks_of_module(value if isinstance(value, str) else value.__name__)
    elif isinstance(value, str) and value in COLD_NAMES:
        yield "cold"
    elif isinstance(value, FunctionType | type):
        yield from _marks_of_module(value.__module__)


def _marks_of_module(name: str) -> Iterator[str]:
    if name == "subprocess":
        yield "cold"
    elif name == "tests.report.browser":
        yield "browser"
    elif name.split(".")[0] in PEERS or name.startswith("clearance.crosscheck"):
        yield "peer"
