"""Hashes of what kernels are made of: their sources, the compiler's versions, and what compiles them.

Each object file is named by the hash of the sources that its kernel imports, so that an edit builds only what it
touches. Not for: the fingerprint of a run.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


@functools.cache
def digest_of(module: str) -> str:
    """The hash of a module of kernels with all that it imports of kernels, and of what compiles it."""
    digest = hashlib.sha256(_compilers().encode())
    for name in sorted({*closure(module), *_compiling_modules()}):
        digest.update(name.encode() + b"\0" + _file(name).read_bytes() + b"\0")
    return digest.hexdigest()


def _compilers() -> str:
    from importlib.metadata import version  # what a start need not pay for

    return " ".join(f"{name} {version(name)}" for name in ("numba", "llvmlite"))


def digest_of_sources() -> str:
    """The hash of all that a library is made of: all kernels, and what compiles and links them."""
    digest = hashlib.sha256()
    compiling = [
        _file(name)
        for name in (
            *_compiling_modules(),
            *map("clearance.compile.{}".format, ("build", "in_process", "linking")),
        )
    ]
    for file in sorted((*(PACKAGE / "kernels").rglob("*.py"), *compiling)):
        digest.update(str(file.relative_to(PACKAGE)).encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


@functools.cache
def digest_of_imported() -> str:
    """The same as this process first saw it, before it imported kernels: they may be edited while it runs."""
    return digest_of_sources()


def modules() -> list[str]:
    """All modules of kernels."""
    files = sorted((PACKAGE / "kernels").rglob("*.py"))
    return [
        ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)
        for file in files
        if file.name != "__init__.py"
    ]


def _compiling_modules() -> list[str]:
    """What the code of a kernel depends on besides its own sources."""
    names = (
        "compiler",
        "decorators",
        "declared",
        "intrinsics",
        "lending",
        "lent",
        "memory",
        "objects",
        "registered",
    )
    return [f"clearance.compile.{name}" for name in names]


def closure(module: str) -> set[str]:
    """A module of kernels, and all of them that it imports."""
    seen: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += _imports(name)
    return seen


@functools.cache
def _imports(module: str) -> tuple[str, ...]:
    return tuple(_imported(ast.parse(_file(module).read_bytes())))


def _imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("clearance.kernels"):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from [name for name in (str(node.module), *inner) if _file(name).exists()]


def _file(module: str) -> Path:
    return PACKAGE.parent / Path(*module.split(".")).with_suffix(".py")
