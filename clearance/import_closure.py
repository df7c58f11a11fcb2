"""Which files of this package a file imports, directly or not: what its results can depend on.

The names of compiled kernels in the cache and the fingerprint of a run are hashes of such closures. A form of
import that is overlooked here would let old code or old rows pass for new ones. So files are parsed, and a form
whose target only a run can tell is refused. Not for: other packages.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

PACKAGE = Path(__file__).parent

_RUNNERS = frozenset(
    {"import_module", "__import__", "exec", "eval", "reload", "run_path", "run_module"}
)
"""Functions that import, or run, what their argument says."""

_HOLDS_STATEMENTS = (ast.stmt, ast.ExceptHandler, ast.match_case)


class UnknownImport(Exception):
    """An import whose target only a run can tell; the message says in which file and line."""


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
        content = path.read_bytes()
        place = path.relative_to(package) if path.is_relative_to(package) else Path(path.name)
        digest.update(f"{place.as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def _room_of(path: Path, package: Path) -> str:
    """The folder or file of the package that a path lies in; empty for a file outside it, as a test has."""
    return path.relative_to(package).parts[0] if path.is_relative_to(package) else ""


@functools.cache
def _imports(path: Path, package: Path) -> tuple[Path, ...]:
    """The files of the package that one file imports itself."""
    if path == package / "__init__.py":
        return ()
    found: list[Path] = []
    source = path.read_text(encoding="utf-8")
    runs_text = any(name in source for name in _RUNNERS)
    for node in _at_run_time(
        ast.parse(source, str(path)), ast.AST if runs_text else _HOLDS_STATEMENTS
    ):
        if isinstance(node, ast.Import):
            for alias in node.names:
                found += _files_of(alias.name.split("."), package, _place(node, path), alias.asname)
        elif isinstance(node, ast.ImportFrom):
            parts = _absolute(node, path, package)
            for alias in node.names:
                found += _files_from(parts, alias.name, package, _place(node, path))
        elif isinstance(node, ast.Call):
            found += _called(node, path, package)
    return tuple(found)


def _at_run_time(tree: ast.AST, kinds: type | tuple[type, ...]) -> Iterator[ast.AST]:
    """All nodes of some kinds in a file, without the branches that only type checkers read."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        if isinstance(node, ast.If) and _last_name(node.test) == "TYPE_CHECKING":
            waiting.extend(node.orelse)
        else:
            waiting.extend(
                child for child in ast.iter_child_nodes(node) if isinstance(child, kinds)
            )


def _called(call: ast.Call, path: Path, package: Path) -> list[Path]:
    """What a call imports: nothing, or the module that a literal names."""
    name = _last_name(call.func)
    if name not in _RUNNERS or (name in ("exec", "eval") and not isinstance(call.func, ast.Name)):
        return []
    known = name == "import_module" and len(call.args) == 1 and not call.keywords
    if (
        not known
        or not isinstance(call.args[0], ast.Constant)
        or not isinstance(call.args[0].value, str)
    ):
        raise UnknownImport(
            f"{_place(call, path)}: what {name}() imports or runs is not known without running it"
        )
    return _files_of(call.args[0].value.split("."), package, _place(call, path), as_name="it")


def _absolute(node: ast.ImportFrom, path: Path, package: Path) -> list[str]:
    """The module of `from … import`, dots at its front resolved."""
    parts = node.module.split(".") if node.module else []
    if node.level == 0:
        return parts
    if not path.is_relative_to(package):
        raise UnknownImport(f"{_place(node, path)}: a relative import outside the package")
    inside = [package.name, *path.relative_to(package).with_suffix("").parts]
    if node.level >= len(inside):
        raise UnknownImport(f"{_place(node, path)}: a relative import leaves the package")
    return [*inside[: -node.level], *parts]


def _files_from(parts: list[str], name: str, package: Path, place: str) -> list[Path]:
    """The files of `from a.b import name`, where name is a module or something in one."""
    if not parts or parts[0] != package.name:
        return []
    if name != "*" and _module_file([*parts, name], package) is not None:
        return _files_of([*parts, name], package, place, as_name=name)
    return _files_of(parts, package, place, as_name=name)


def _files_of(parts: list[str], package: Path, place: str, as_name: str | None) -> list[Path]:
    """The module's file and the `__init__` of each folder above it."""
    if parts[0] != package.name:
        return []
    if len(parts) == 1 and as_name in (None, "*"):
        raise UnknownImport(
            f"{place}: {package.name} as a whole; import what is used of it, by its module"
        )
    files = [_module_file(parts[:n], package) for n in range(1, len(parts) + 1)]
    if None in files:
        raise UnknownImport(f"{place}: there is no module {'.'.join(parts)}")
    return [file for file in files if file is not None]


def _module_file(parts: list[str], package: Path) -> Path | None:
    """The file of a module or of a folder of modules; None where there is none."""
    stem = package.joinpath(*parts[1:])
    for file in (stem / "__init__.py", stem.parent / f"{stem.name}.py"):
        if file.is_file():
            return file
    return None


def _last_name(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def _place(node: ast.stmt | ast.expr, path: Path) -> str:
    return f"{path}, line {node.lineno}"
