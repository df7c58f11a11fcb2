"""The import statements of a source file of this package, each source parsed once on a machine.

Parsing the eighty files that kernels are compiled from takes longer than reading what was compiled from them. So
the statements are kept by sha256 of the source that they stand in. Not for: which files they mean
(`import_closure`).
"""

from __future__ import annotations

import ast
import atexit
import functools
import hashlib
import json
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from clearance.kept_files import read_kept, write_kept

_RUNNERS = frozenset(
    {"import_module", "__import__", "exec", "eval", "reload", "run_path", "run_module"}
)
"""Functions that import, or run, what their argument says."""

_HOLDS_STATEMENTS = (ast.stmt, ast.ExceptHandler, ast.match_case)


class UnknownImport(Exception):
    """An import whose target only a run can tell; the message says in which file and line."""


class Statement(NamedTuple):
    """One import of a source: `import module as alias`, or `from module import names` with `level` dots."""

    line: int
    module: str
    level: int
    names: tuple[str, ...]
    alias: str | None


_FOLDER = "imports"

_MOST = 4000
"""Sources whose statements are kept; past that only those that the last run has parsed."""


def statements_of(path: Path) -> tuple[Statement, ...]:
    """The import statements of a file that count at run time.

    Raises:
        UnknownImport: one that cannot be followed.
    """
    source = path.read_bytes()
    name = hashlib.sha256(source).hexdigest()
    kept = _kept()
    if name not in kept.known:
        kept.known[name] = kept.new[name] = json.dumps(_statements(source.decode("utf-8"), path))
    return tuple(
        Statement(line, module, level, tuple(names), alias)
        for line, module, level, names, alias in json.loads(kept.known[name])
    )


class _KeptStatements(NamedTuple):
    """Statements by sha256 of their source, as JSON: all that are known, and those that are not kept yet."""

    known: dict[str, str]
    new: dict[str, str]


@functools.cache
def _kept() -> _KeptStatements:
    """What earlier runs have kept; what this one adds is written when it ends."""
    kept = _KeptStatements(_read(), {})
    atexit.register(_write, kept.new)
    return kept


def _read() -> dict[str, str]:
    """What is kept: a line a source, its sha256 and its statements, of which a run reads a few."""
    content = read_kept(_FOLDER, _file_name())
    lines = [] if content is None else content.decode().splitlines()
    return dict(line.split(" ", 1) for line in lines)


def _write(new: dict[str, str]) -> None:
    if not new:
        return
    known = {**_read(), **new}
    kept = known if len(known) <= _MOST else new
    told = "".join(f"{name} {statements}\n" for name, statements in kept.items())
    with suppress(OSError):  # no room: the next run parses them again
        write_kept(_FOLDER, _file_name(), told.encode())


@functools.cache
def _file_name() -> str:
    """Another one for other rules, and for an interpreter that may read a source otherwise."""
    rules = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:16]
    return f"{sys.implementation.cache_tag}-{rules}.txt"


def _statements(source: str, path: Path) -> tuple[Statement, ...]:
    """The import statements of a source that count at run time."""
    found: list[Statement] = []
    runs_text = any(name in source for name in _RUNNERS)
    for node in _at_run_time(
        ast.parse(source, str(path)), ast.AST if runs_text else _HOLDS_STATEMENTS
    ):
        if isinstance(node, ast.Import):
            found += [Statement(node.lineno, a.name, 0, (), a.asname) for a in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = tuple(alias.name for alias in node.names)
            found.append(Statement(node.lineno, node.module or "", node.level, names, None))
        elif isinstance(node, ast.Call):
            found += _called(node, path)
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


def _called(call: ast.Call, path: Path) -> list[Statement]:
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
            f"{path}, line {call.lineno}: what {name}() imports or runs is not known without running it"
        )
    return [Statement(call.lineno, call.args[0].value, 0, (), "it")]


def _last_name(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""
