"""The names of the code, by the file that has them: what the notes and the guide may put in backticks."""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.docs.code_blocks import ROOT

ROOMS = ("clearance", "scripts", "tests")
HERE = Path(__file__).parent
DATA = ("js", "html", "css", "yaml", "toml", "yml", "csv")

Names = dict[str, set[str]]


@functools.cache
def names_by_file() -> Names:
    """The names of each Python file by its stem: what it defines and uses, and the words of its strings.

    The tests of the pages name what is not there, so that theirs do not count.
    """
    found: Names = {}
    for room in ROOMS:
        for path in (ROOT / room).rglob("*.py"):
            if path.parent != HERE:
                found.setdefault(path.stem, set()).update(_names(path))
    return found


@functools.cache
def all_names() -> frozenset[str]:
    """Every name of the code, files and folders too, and every word of what it reads or serves."""
    words = set().union(*names_by_file().values())
    for path in files():
        words.update((path.stem, *path.parent.parts))
        if path.suffix[1:] in DATA:
            words.update(re.findall(r"\w+", (ROOT / path).read_text(encoding="utf-8")))
    return frozenset(words)


@functools.cache
def files() -> tuple[Path, ...]:
    """All files of the repository's rooms, relative to it."""
    rooms = (*ROOMS, "robots", "scenes")
    inside = [path for room in rooms for path in (ROOT / room).rglob("*") if path.is_file()]
    found = [*inside, *(path for path in ROOT.iterdir() if path.is_file())]
    return tuple(sorted(path.relative_to(ROOT) for path in found))


def is_path(shown: str) -> bool:
    """True if a file or folder is called so, seen from the repository or a folder of it; `.py` may be left out."""
    tail = Path(shown).parts
    for path in files():
        for parts in (path.parts, path.with_suffix("").parts):
            if any(parts[i : i + len(tail)] == tail for i in range(len(parts))):
                return True
    return False


def is_name(shown: str) -> bool:
    """True if every part of a dotted name is one, and the last one is in the file that the one before names."""
    *owners, name = shown.split(".")
    if not all_names().issuperset((*owners, name)):
        return False
    own = names_by_file().get(owners[-1]) if owners else None
    return own is None or name in own or is_path(shown.replace(".", "/"))


def _names(path: Path) -> Iterator[str]:
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    prose = {id(doc) for node in nodes for doc in _docstrings(node)}
    for node in nodes:
        of_kind = _OF_KIND.get(type(node))
        if of_kind is not None and id(node) not in prose:
            yield from of_kind(node)


def _words(node: ast.Constant) -> list[str]:
    return re.findall(r"\w+", node.value) if isinstance(node.value, str) else []


_OF_KIND: dict[type, Callable] = {
    ast.FunctionDef: lambda node: (node.name,),
    ast.ClassDef: lambda node: (node.name,),
    ast.Name: lambda node: (node.id,),
    ast.Attribute: lambda node: (node.attr,),
    ast.arg: lambda node: (node.arg,),
    ast.keyword: lambda node: (node.arg or "**",),
    ast.alias: lambda node: node.name.split("."),
    ast.Constant: _words,
}
"""The names of a node, by its type; quicker to look up than to match."""


def _docstrings(node: ast.AST) -> Iterator[ast.Constant]:
    """The strings that stand alone in a body: docstrings of modules, functions, classes and constants."""
    body = getattr(node, "body", None)
    for statement in body if isinstance(body, list) else ():
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            if isinstance(statement.value.value, str):
                yield statement.value
