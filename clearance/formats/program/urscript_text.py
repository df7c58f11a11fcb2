"""URScript as statements. Not for: what its functions do (`urscript`)."""

from __future__ import annotations

import operator
import re
from dataclasses import dataclass, field

from clearance.errors import BadSyntax, DuplicateName
from clearance.formats.program.blocks import BlockReader
from clearance.formats.program.expressions import (
    Call,
    Constant,
    ExpressionReader,
    Name,
)
from clearance.formats.program.grammar import Grammar, numeric, ranked
from clearance.formats.program.statements import (
    BREAK,
    CONTINUE,
    RETURN,
    STOP,
    Assign,
    Do,
    Leave,
    Routine,
    Statement,
    Unreadable,
)
from clearance.formats.program.tokens import END, NEWLINE, Cursor, Token, tokens_of

WORDS = re.compile(
    r"""(?P<skip>[ \t\f\\]+|\#[^\n]*|\$[^\n]*)
    |(?P<newline>\n|;)
    |(?P<number>0[xX][0-9a-fA-F]+|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    |(?P<name>[A-Za-z_][A-Za-z_0-9]*)
    |(?P<string>"[^"\n]*"|'[^'\n]*')
    |(?P<operator>==|!=|<=|>=|<<|>>|[-+*/%<>=()\[\]{},.:&|^~])""",
    re.VERBOSE,
)

_NODE = re.compile(r'[ \t]*\$[ \t]*\d+[ \t]*"([^"]*)"')
"""A node of PolyScope with its label, above the lines that it makes."""

GRAMMAR = Grammar(
    binary=ranked("or xor", "and", "== != < > <= >=", "+ -", "* / %"),
    unary={
        "not": (2, operator.not_),
        "-": (6, lambda a: numeric(operator.mul)(-1.0, a)),
        "+": (6, lambda a: numeric(operator.mul)(1.0, a)),
    },
    constants={"True": True, "False": False, "true": True, "false": False},
    before_items=("p",),
)

_LEAVES = {"return": RETURN, "break": BREAK, "continue": CONTINUE, "halt": STOP}
_ROUTINES = ("def", "thread", "sec")


@dataclass(eq=False)
class UrScript:
    """A script.

    Attributes:
        routines: by name, those within others too. outer: the names of those within none.
        body: statements that are in none.
    """

    routines: dict[str, Routine] = field(default_factory=dict)
    outer: list[str] = field(default_factory=list)
    body: tuple[Statement, ...] = ()


def labels_of(text: str) -> dict[int, str]:
    """The labels of PolyScope's nodes, each by the number of the first line below it."""
    found, label = dict[int, str](), ""
    for number, row in enumerate(text.split("\n"), 1):
        node = _NODE.match(row)
        if node:
            label = node[1]
        elif label and row.strip():
            found[number], label = label, ""
    return found


def script_of(text: str, file: str = "") -> UrScript:
    """The statements of a script.

    Raises:
        BadSyntax: with the line.
    """
    cursor = Cursor(tokens_of(text, WORDS, file))
    return _Reader(ExpressionReader(cursor, GRAMMAR)).script()


class _Reader(BlockReader):
    """Reads statements, one after another."""

    ends, other = ("end", "else", "elif", "elseif"), "else"

    def script(self) -> UrScript:
        """All statements."""
        self._script, self._n_around = UrScript(), 0
        self._script.body = self.body()
        if self.cursor.next.kind != END:
            self.cursor.refuse("a statement")
        return self._script

    def statement(self) -> list[Statement]:
        """The statement that follows; none of one that does nothing, or of a function."""
        word = self.cursor.next
        if self.cursor.accept(*_ROUTINES):
            self._routine(word)
            return []
        found = self._other(word)
        at_end = self.cursor.next.kind in (NEWLINE, END) or self.cursor.is_at("end", "else")
        if not at_end:
            self.cursor.refuse("the end of the line")
        return [found] if found is not None else []

    def _other(self, word: Token) -> Statement | None:
        cursor = self.cursor
        if cursor.accept("if"):
            return self.branches(word.line, "if", self.expression(), "", "elif elseif", "end")
        if cursor.accept("while"):
            return self.loop(word.line, "while", ":", "end")
        if cursor.accept(*_LEAVES):
            ends = cursor.next.kind in (NEWLINE, END) or cursor.is_at("end")
            value = None if ends or word.text == "halt" else self.expression()
            return Leave(word.line, word.text, _LEAVES[word.text], value)
        if cursor.accept("pass"):
            return None
        if cursor.accept("run", "kill", "join"):
            called = self.expression()
            name = called.name if isinstance(called, Call | Name) else ""
            return Do(word.line, Call(word.text, (Constant(name),), {}, word.line))
        return self._assignment(word)

    def _assignment(self, word: Token) -> Statement | None:
        """A variable's value, or a call."""
        scope = self.cursor.accept("global", "local")
        target = self.expressions.expression(4)
        if not self.cursor.accept("="):
            if isinstance(target, Call):
                return Do(word.line, target)
            return None if scope and isinstance(target, Name) else Unreadable(word.line, word.text)
        if self.cursor.is_at("run"):
            return self._other(self.cursor.next)
        kinds = (scope is not None and scope.text == kind for kind in ("local", "global"))
        return Assign(word.line, target, self.expression(), *kinds)

    def _routine(self, kind: Token) -> None:
        """A function, a thread or a secondary program, whose first word is taken."""
        name = self.cursor.expect_kind("name", "a name")
        self.cursor.expect("(")
        args, named = self.expressions.arguments(")")
        self.cursor.expect(")")
        self.cursor.expect(":")
        parameters = [*(one.name for one in args if isinstance(one, Name)), *named]
        if len(parameters) != len(args) + len(named):
            raise BadSyntax("a parameter without a name", where=str(name.line))
        if name.text in self._script.routines:
            raise DuplicateName(f"{name.text!r} is defined twice", where=str(name.line))
        if not self._n_around:
            self._script.outer.append(name.text)
        self._n_around += 1
        body = self.block(name.line, kind.text, "end")
        self._n_around -= 1
        self.cursor.take()
        self._script.routines[name.text] = Routine(
            name.text, name.line, tuple(parameters), body, kind.text != "def", defaults=dict(named)
        )
