"""The files of a program in KRL: each module, a `.src` with its `.dat`, has points and procedures of its own.

Not for: their text (`krl_text`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from clearance.errors import BadProgram
from clearance.formats.program.controller_program import ProgramRequest
from clearance.formats.program.krl_expressions import WORD
from clearance.formats.program.krl_text import Module, module_of
from clearance.formats.program.statements import Assign, Routine, Statement, assigned
from clearance.formats.program.tokens import NEWLINE, Line, Token, text_of, tokens_of


@dataclass(frozen=True)
class Source:
    """The content of a file, and the file as of a `Line`."""

    data: bytes
    file: str = ""


@dataclass(frozen=True)
class Files:
    """All files of a program.

    Attributes:
        routines: by name in capitals. entries: the names of those in the program's own file. declared: what stands
            outside of them.
    """

    routines: dict[str, Routine]
    entries: tuple[str, ...]
    declared: tuple[Statement, ...]


def files_of(asked: ProgramRequest) -> Files:
    """The routines and declarations of a program and of the files beside it.

    Raises:
        BadProgram: the program is none; BadSyntax: as `module_of`.
    """
    groups, types = _groups(asked), dict[str, str]()
    own = groups.pop(_stem(asked.shown))
    modules = [one for name, group in groups.items() for one in _modules(name, group, types)]
    mine = [module_of(_lines(source), types) for source in own]
    if not mine[-1].routines:
        raise BadProgram("no DEF is in it", valid="a program in KRL (.src)")
    routines = {name: one for module in (*modules, *mine) for name, one in module.routines.items()}
    declared = [one for module in (*modules, *mine) for one in module.declared]
    return Files(routines, tuple(mine[-1].routines), tuple(declared))


def _stem(shown: str) -> str:
    return PurePosixPath(shown).stem.upper()


def _groups(asked: ProgramRequest) -> dict[str, list[Source]]:
    """The files of each module; the program's own is the last of its."""
    found = dict[str, list[Source]]()
    for shown, data in asked.beside.items():
        found.setdefault(_stem(shown), []).append(Source(data, shown))
    found.setdefault(_stem(asked.shown), []).append(Source(asked.data))
    return found


def _modules(name: str, group: Sequence[Source], types: dict[str, str]) -> list[Module]:
    """The files of a module beside the program; names that are its own have the module's behind them.

    Data without procedures (`$config.dat`) are for all.
    """
    plain = [module_of(_lines(source), {}) for source in group]
    own = set[str]()
    if any(module.routines for module in plain):
        own = {one for module in plain for one in _own_names(module)}
    named = ((_named(line, own, name) for line in _lines(source)) for source in group)
    return [module_of(lines, types) for lines in named]


def _own_names(module: Module) -> set[str]:
    """The variables and procedures of a file that only its module knows."""
    statements = [one for one in module.declared if isinstance(one, Assign) and not one.is_of_all]
    names = [assigned(one.target) for one in statements]
    return {one.name for one in names if one is not None} | (module.routines.keys() - module.public)


def _lines(source: Source) -> Iterator[list[Token]]:
    """The words of each line that has any, and its end; heads (`&ACCESS`) are left out."""
    for number, row in enumerate(text_of(source.data, source.file).split("\n"), 1):
        words = [] if row.lstrip().startswith("&") else tokens_of(row, WORD)[:-1]
        line = Line(number, source.file)
        if words:
            yield [*(Token(one.kind, one.text, line) for one in words), Token(NEWLINE, "\n", line)]


def _named(words: list[Token], own: set[str], module: str) -> list[Token]:
    """Words, in which a module's own names have its name behind them; parts of aggregates are no such names."""
    found, depth = list[Token](), 0
    for i, one in enumerate(words):
        depth += (one.text == "{") - (one.text == "}")
        before = words[i - 1].text if i else ""
        is_part = before == "." or (depth > 0 and before in ("{", ","))
        is_own = one.kind == "name" and not is_part and one.text.upper() in own
        found.append(one._replace(text=f"{one.text} of {module}") if is_own else one)
    return found
