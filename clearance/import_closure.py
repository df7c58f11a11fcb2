"""Which files of this package a file imports, directly or not: what its results can depend on.

The names of compiled kernels in the cache and the fingerprint of a run are hashes of such closures. A form of
import that is overlooked here would let old code or old rows pass for new ones. So files are
parsed (`import_statements`), and a form whose target only a run can tell is refused. Not for: other packages.
"""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Collection, Iterable
from pathlib import Path

from clearance.import_statements import Statement, UnknownImport, statements_of

PACKAGE = Path(__file__).parent


def import_closure(
    paths: Iterable[Path], package: Path = PACKAGE, leave_out: Collection[str] = ()
) -> list[Path]:
    """The files themselves and every file of the package that they import, directly or not, in order.

    Args:
        leave_out: rooms (folders or files of the package, by name) that are neither counted nor followed.

    Imports count wherever they stand, in functions too; those for type checkers only (`if TYPE_CHECKING:`) do not.
    Of the package's own `__init__` the file itself counts, not what it imports when it is asked for a name.

    Raises:
        UnknownImport: a form of import that cannot be followed.
    """
    found: set[Path] = set()
    waiting = list(paths)
    while waiting:
        path = waiting.pop()
        if path not in found and _room_of(path, package) not in leave_out:
            found.add(path)
            waiting.extend(_imports(path, package))
    return sorted(found)


def digest_of(paths: Iterable[Path], package: Path = PACKAGE) -> str:
    """sha256 of files of the package, with their places in it."""
    digest = hashlib.sha256()
    for path in paths:
        found = os.stat(path)
        content = _digest_of_content(path, found.st_mtime_ns, found.st_size)
        digest.update(f"{_place(path, package)} {content}\n".encode())
    return digest.hexdigest()


@functools.cache
def _place(path: Path, package: Path) -> str:
    """Where a file lies in the package; the name of one outside it."""
    inside = path.is_relative_to(package)
    return path.relative_to(package).as_posix() if inside else path.name


@functools.cache
def _digest_of_content(path: Path, modified: int, size: int) -> str:
    """sha256 of a file, read once in a process while it stays as it is."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def _room_of(path: Path, package: Path) -> str:
    """The folder or file of the package that a path lies in; empty for a file outside it, as a test has."""
    return path.relative_to(package).parts[0] if path.is_relative_to(package) else ""


@functools.cache
def _imports(path: Path, package: Path) -> tuple[Path, ...]:
    """The files of the package that one file imports itself."""
    if path == package / "__init__.py":
        return ()
    found: list[Path] = []
    for one in statements_of(path):
        place = f"{path}, line {one.line}"
        if not one.names:
            found += _files_of(tuple(one.module.split(".")), package, place, one.alias)
        else:
            parts = _absolute(one, path, package)
            for name in one.names:
                found += _files_from(parts, name, package, place)
    return tuple(found)


def _absolute(one: Statement, path: Path, package: Path) -> tuple[str, ...]:
    """The module of `from … import`, dots at its front resolved."""
    parts = tuple(one.module.split(".")) if one.module else ()
    if one.level == 0:
        return parts
    if not path.is_relative_to(package):
        raise UnknownImport(f"{path}, line {one.line}: a relative import outside the package")
    inside = (package.name, *path.relative_to(package).with_suffix("").parts)
    if one.level >= len(inside):
        raise UnknownImport(f"{path}, line {one.line}: a relative import leaves the package")
    return (*inside[: -one.level], *parts)


def _files_from(parts: tuple[str, ...], name: str, package: Path, place: str) -> list[Path]:
    """The files of `from a.b import name`, where name is a module or something in one."""
    if not parts or parts[0] != package.name:
        return []
    if name != "*" and _module_file((*parts, name), package) is not None:
        return _files_of((*parts, name), package, place, as_name=name)
    return _files_of(parts, package, place, as_name=name)


def _files_of(parts: tuple[str, ...], package: Path, place: str, as_name: str | None) -> list[Path]:
    """The module's file and the `__init__` of each folder above it."""
    if parts[0] != package.name:
        return []
    if len(parts) == 1 and as_name in (None, "*"):
        raise UnknownImport(
            f"{place}: {package.name} as a whole; import what is used of it, by its module"
        )
    files = _files_down_to(parts, package)
    if not files:
        raise UnknownImport(f"{place}: there is no module {'.'.join(parts)}")
    return [*files]


@functools.cache
def _files_down_to(parts: tuple[str, ...], package: Path) -> tuple[Path, ...]:
    """A module's file after the `__init__` of each folder above it; empty where one is not there."""
    files = [_module_file(parts[:n], package) for n in range(1, len(parts) + 1)]
    found = tuple(file for file in files if file is not None)
    return found if len(found) == len(files) else ()


@functools.cache
def _module_file(parts: tuple[str, ...], package: Path) -> Path | None:
    """The file of a module or of a folder of modules; None where there is none."""
    stem = os.path.join(package, *parts[1:])
    for file in (os.path.join(stem, "__init__.py"), f"{stem}.py"):
        if os.path.isfile(file):
            return Path(file)
    return None
