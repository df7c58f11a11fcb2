"""URScript as statements. Not for: what its functions do (`urscript`)."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from clearance.errors import BadSyntax, DuplicateName
from clearance.formats.program.expressions import (
    COMPARED,
    Call,
    Constant,
    Expression,
    ExpressionReader,
    Name,
    numeric,
)
from clearance.formats.program.grammar import Grammar
from clearance.formats.program.statements import (
    BREAK,
    CONTINUE,
    RETURN,
    STOP,
    Assign,
    Do,
    If,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
)
from clearance.formats.program.tokens import END, NEWLINE, Cursor, Line, Token, tokens_of

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
    binary={
        "or": (1, lambda a, b: bool(a) or bool(b)),
        "xor": (1, lambda a, b: bool(a) != bool(b)),
        "and": (2, lambda a, b: bool(a) and bool(b)),
        "==": (4, operator.eq),
        "!=": (4, operator.ne),
        **{word: (4, act) for word, act in COMPARED.items()},
        "+": (5, numeric(operator.add)),
        "-": (5, numeric(operator.sub)),
        "*": (6, numeric(operator.mul)),
        "/": (6, numeric(operator.truediv)),
        "%": (6, numeric(math.fmod)),
    },
    unary={
        "not": (3, operator.not_),
        "-": (7, lambda a: numeric(operator.mul)(-1.0, a)),
        "+": (7, lambda a: numeric(operator.mul)(1.0, a)),
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
    return _Reader(Cursor(tokens_of(text, WORDS, file))).script()


class _Reader:
    """Reads statements, one after another."""

    def __init__(self, cursor: Cursor) -> None:
        self._cursor, self._expressions = cursor, ExpressionReader(cursor, GRAMMAR)
        self._script, self._depth = UrScript(), 0

    def script(self) -> UrScript:
        """All statements."""
        self._script.body = self._body()
        if self._cursor.next.kind != END:
            self._cursor.refuse("a statement")
        return self._script

    def _body(self) -> tuple[Statement, ...]:
        """Statements up to what ends a block, which is not taken."""
        found = list[Statement]()
        while True:
            while self._cursor.next.kind == NEWLINE:
                self._cursor.take()
            if self._cursor.next.kind == END or self._cursor.is_at("end", "else", "elif", "elseif"):
                return tuple(found)
            found += self._statement()

    def _statement(self) -> list[Statement]:
        word = self._cursor.next
        if word.text in _ROUTINES:
            self._routine()
            return []
        found = self._other(word)
        at_end = self._cursor.next.kind in (NEWLINE, END) or self._cursor.is_at("end", "else")
        if not at_end:
            self._cursor.refuse("the end of the line")
        return [found] if found is not None else []

    def _other(self, word: Token) -> Statement | None:
        cursor = self._cursor
        if cursor.accept("if"):
            return self._if(word.line)
        if cursor.accept("while"):
            return While(word.line, "while", *self._loop())
        if word.text in _LEAVES:
            cursor.take()
            ends = cursor.next.kind in (NEWLINE, END) or cursor.is_at("end")
            value = None if ends or word.text == "halt" else self._value()
            return Leave(word.line, word.text, _LEAVES[word.text], value)
        if cursor.accept("pass"):
            return None
        if cursor.accept("run", "kill", "join"):
            called = self._value()
            name = called.name if isinstance(called, Call | Name) else ""
            return Do(word.line, Call(word.text, (Constant(name),), {}, word.line))
        return self._assignment(word)

    def _assignment(self, word: Token) -> Statement | None:
        """A variable's value, or a call."""
        scope = self._cursor.accept("global", "local")
        target = self._expressions.expression(5)
        if not self._cursor.accept("="):
            if isinstance(target, Call):
                return Do(word.line, target)
            return None if scope and isinstance(target, Name) else Unreadable(word.line, word.text)
        if self._cursor.is_at("run"):
            return self._other(self._cursor.next)
        is_own = scope is not None and scope.text == "local"
        is_global = scope is not None and scope.text == "global"
        return Assign(word.line, target, self._value(), is_own, is_global)

    def _value(self) -> Expression:
        return self._expressions.expression()

    def _loop(self) -> tuple[Expression, tuple[Statement, ...]]:
        condition = self._value()
        self._cursor.expect(":")
        return condition, self._block(self._body)

    def _if(self, line: Line) -> If:
        branches = list[tuple[Expression | None, tuple[Statement, ...]]]()
        condition: Expression | None = self._value()
        while True:
            self._cursor.accept(":")
            branches.append((condition, self._nested(self._body)))
            if self._cursor.accept("elif", "elseif"):
                condition = self._value()
            elif self._cursor.accept("else"):
                condition = None
            else:
                self._cursor.expect("end")
                return If(line, "if", tuple(branches))

    def _block(self, body: Callable[[], tuple[Statement, ...]]) -> tuple[Statement, ...]:
        """What stands up to `end`."""
        found = self._nested(body)
        self._cursor.expect("end")
        return found

    def _nested(self, body: Callable[[], tuple[Statement, ...]]) -> tuple[Statement, ...]:
        self._depth += 1
        if self._depth > 60:
            self._cursor.refuse("at most 60 blocks within one another")
        found = body()
        self._depth -= 1
        return found

    def _routine(self) -> None:
        """A function, a thread or a secondary program."""
        kind = self._cursor.take()
        name = self._cursor.expect_kind("name", "a name")
        self._cursor.expect("(")
        args, named = self._expressions.arguments(")")
        self._cursor.expect(")")
        self._cursor.expect(":")
        parameters = [*(one.name for one in args if isinstance(one, Name)), *named]
        if len(parameters) != len(args) + len(named):
            raise BadSyntax("a parameter without a name", where=str(name.line))
        if name.text in self._script.routines:
            raise DuplicateName(f"{name.text!r} is defined twice", where=str(name.line))
        if not self._depth:
            self._script.outer.append(name.text)
        body = self._block(self._body)
        self._script.routines[name.text] = Routine(
            name.text, name.line, tuple(parameters), body, kind.text != "def", defaults=dict(named)
        )
