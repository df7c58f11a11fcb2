"""RAPID as statements. Not for: what its instructions do (`rapid`), nor its data (`rapid_data`).

Source: ABB, Technical reference manual, RAPID kernel.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

from clearance.errors import DuplicateName
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    ExpressionReader,
    Name,
    Operation,
)
from clearance.formats.program.grammar import Grammar
from clearance.formats.program.rapid_grammar import WORDS, added
from clearance.formats.program.statements import (
    RETURN,
    STOP,
    Assign,
    Do,
    For,
    If,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
)
from clearance.formats.program.tokens import END, Cursor, Line, Token, tokens_of

CHANGES = ("Incr", "Decr", "Add", "Clear")
"""Instructions that give a variable a value of its own."""


def _changed(name: str, args: tuple[Expression, ...], line: Line) -> Assign:
    """What an instruction gives its variable."""
    target, *more = args
    by: Expression = more[0] if more else Constant(-1.0 if name == "Decr" else 1.0)
    value = Constant(0.0) if name == "Clear" else Operation(added, (target, by), line)
    return Assign(line, target, value)


@dataclass(frozen=True)
class Declaration:
    """A datum with its first value; `sizes` are those of an array."""

    line: Line
    kind: str
    type_name: str
    name: str
    value: Expression | None
    sizes: tuple[Expression, ...] = ()


@dataclass(eq=False)
class Modules:
    """The modules of a program.

    Attributes:
        routines, declared, records: by name; the last are the names of fields.
    """

    routines: dict[str, Routine] = field(default_factory=dict)
    declared: dict[str, Declaration] = field(default_factory=dict)
    records: dict[str, list[str]] = field(default_factory=dict)

    def read(self, text: str, rules: Grammar, file: str = "") -> None:
        """Adds the modules of a file.

        Raises:
            BadSyntax: with the line. DuplicateName: two of a name.
        """
        cursor = Cursor(_with_own_names(tokens_of(text, WORDS, file)), folds=True)
        reader = _Reader(cursor, rules, self)
        if cursor.next.kind == END:
            cursor.refuse("'MODULE'")
        while cursor.next.kind != END:
            reader.module()


_DATA = ("CONST", "PERS", "VAR")
_SCOPES = ("LOCAL", "TASK", "GLOBAL")
_ROUTINES = {"PROC": "ENDPROC", "FUNC": "ENDFUNC", "TRAP": "ENDTRAP"}
_HANDLERS = ("ERROR", "UNDO", "BACKWARD")
_BLOCKS_END = (
    *_ROUTINES.values(),
    *_HANDLERS,
    *("ENDIF", "ELSE", "ELSEIF", "ENDFOR", "ENDWHILE", "ENDTEST", "CASE", "DEFAULT", "ENDMODULE"),
)


def _with_own_names(tokens: list[Token]) -> list[Token]:
    """The words, with names that a module has alone (LOCAL) as `module.name`, so that others may have them too.

    A name that a routine of the module has for something of its own stays as it is.
    """
    found, begins = (
        list(tokens),
        [i for i, one in enumerate(tokens) if one.text.upper() == "MODULE"],
    )
    for begin, end in pairwise([*begins, len(tokens)]):
        own, inner = _declared(tokens[begin:end])
        for i in range(begin + 2, end):
            one, before = tokens[i], tokens[i - 1].text
            if one.kind == "name" and one.text.lower() in own - inner and before not in (".", "\\"):
                found[i] = one._replace(text=f"{tokens[begin + 1].text}.{one.text}")
    return found


def _declared(tokens: list[Token]) -> tuple[set[str], set[str]]:
    """The names that a module has alone, and those that its routines give to data and parameters."""
    words = [one.text.upper() for one in tokens]
    own, inner = set[str](), set[str]()
    for i, word in enumerate(words[:-3]):
        is_data, is_local = word in _DATA, "LOCAL" in words[max(0, i - 2) : i]
        if not is_data and word not in _ROUTINES:
            continue
        name = i + (2 if is_data or word == "FUNC" else 1)
        if is_local:
            own.add(tokens[name].text.lower())
        elif is_data:
            inner.add(tokens[name].text.lower())
        if not is_data and words[name + 1] == "(":
            closed = words.index(")", name) if ")" in words[name:] else name
            inner |= {one.text.lower() for one in tokens[name + 1 : closed] if one.kind == "name"}
    return own, inner


class _Reader:
    """Reads modules, one after another."""

    def __init__(self, cursor: Cursor, rules: Grammar, into: Modules) -> None:
        self._cursor, self._rules, self._into = cursor, rules, into
        self._expressions, self._depth = ExpressionReader(cursor, rules), 0

    def module(self) -> None:
        """A module."""
        cursor = self._cursor
        cursor.expect("MODULE")
        cursor.expect_kind("name", "the name of the module")
        if cursor.accept("("):
            while not cursor.accept(")"):
                cursor.expect_kind("name", "an attribute")
                cursor.accept(",")
        while not cursor.accept("ENDMODULE"):
            cursor.accept(*_SCOPES)
            cursor.accept(*_SCOPES)
            if cursor.is_at(*_DATA):
                self._keep(self._declaration())
            elif cursor.is_at(*_ROUTINES):
                self._routine()
            elif cursor.accept("RECORD"):
                self._record()
            elif cursor.accept("ALIAS"):
                cursor.take(), cursor.take()
                cursor.expect(";")
            else:
                cursor.refuse("data, a routine, or 'ENDMODULE'")

    def _keep(self, one: Declaration) -> None:
        if one.name in self._into.declared:
            raise DuplicateName(f"{one.name!r} is declared twice", where=str(one.line))
        self._into.declared[one.name] = one

    def _name(self, what: str) -> str:
        return self._rules.folded(self._cursor.expect_kind("name", what).text)

    def _declaration(self) -> Declaration:
        cursor = self._cursor
        kind = cursor.take()
        type_name = self._name("a type")
        name = self._name("a name")
        sizes = list[Expression]()
        if cursor.accept("{"):
            while not cursor.accept("}"):
                sizes.append(self._expressions.expression())
                cursor.accept(",")
        value = self._expressions.expression() if cursor.accept(":=") else None
        cursor.expect(";")
        return Declaration(kind.line, kind.text.upper(), type_name, name, value, tuple(sizes))

    def _record(self) -> None:
        name = self._name("the name of the record")
        fields = list[str]()
        while not self._cursor.accept("ENDRECORD"):
            self._name("a type")
            fields.append(self._name("a name"))
            self._cursor.expect(";")
        self._into.records[name] = fields

    def _routine(self) -> None:
        cursor = self._cursor
        word = cursor.take()
        if word.text.upper() == "FUNC":
            self._name("a type")
        line, name = cursor.next.line, self._name("a name")
        parameters, returned = self._parameters() if cursor.accept("(") else ([], set[str]())
        body, handlers = self._block(), list[tuple[str, tuple[Statement, ...]]]()
        while cursor.is_at(*_HANDLERS):
            kind = cursor.take().text.upper()
            if cursor.accept("("):
                self._expressions.arguments(")")
                cursor.expect(")")
            handlers.append((kind, self._block()))
        cursor.expect(_ROUTINES[word.text.upper()])
        if name in self._into.routines:
            raise DuplicateName(f"{name!r} is there twice", where=str(line))
        self._into.routines[name] = Routine(
            name,
            line,
            tuple(parameters),
            body,
            word.text.upper() == "TRAP",
            frozenset(returned),
            handlers=tuple(handlers),
        )

    def _parameters(self) -> tuple[list[str], set[str]]:
        """Names of parameters, those that a call names last; and of those that are the caller's own."""
        cursor, returned = self._cursor, set[str]()
        names, optional = list[str](), list[str]()
        while not cursor.accept(")"):
            by_name = cursor.accept("\\", "|") is not None
            own = cursor.accept("INOUT", "VAR", "PERS", "REF")
            first = self._name("a type")
            name = self._name("a name") if cursor.next.kind == "name" else first
            if cursor.accept("{"):
                while not cursor.accept("}"):
                    cursor.take() if cursor.next.kind != END else cursor.refuse("'}'")
            (optional if by_name else names).append(name)
            if own:
                returned.add(name)
            if not cursor.accept(",") and not cursor.is_at(")", "\\", "|"):
                cursor.refuse("',' or ')'")
        return [*names, *optional], returned

    def _block(self) -> tuple[Statement, ...]:
        """Statements up to what ends a block, which is not taken."""
        self._depth += 1
        if self._depth > 60:
            self._cursor.refuse("at most 60 blocks within one another")
        found = list[Statement]()
        while not self._cursor.is_at(*_BLOCKS_END):
            if self._cursor.next.kind == END:
                self._cursor.refuse("the end of the block")
            one = self._statement()
            if one is not None:
                found.append(one)
        self._depth -= 1
        return tuple(found)

    def _statement(self) -> Statement | None:
        cursor, word = self._cursor, self._cursor.next
        compound: dict[str, Callable[[Line], Statement]] = {
            "IF": self._if,
            "FOR": self._for,
            "WHILE": self._while,
            "TEST": self._test,
        }
        if cursor.is_at(*compound):
            return compound[cursor.take().text.upper()](word.line)
        if cursor.is_at(*_DATA):
            return self._own(self._declaration())
        found = self._simple(word)
        cursor.expect(";")
        return found

    def _own(self, one: Declaration) -> Statement:
        """A datum of a routine, as it is entered."""
        first = one.value or Constant({"num": 0.0, "bool": False, "string": ""}.get(one.type_name))
        given = Call("%array", (first, *one.sizes), {}, one.line) if one.sizes else first
        return Assign(one.line, Name(one.name, one.line), given, is_own=True)

    def _simple(self, word: Token) -> Statement | None:
        """A statement before `;`, which is not taken."""
        cursor = self._cursor
        if cursor.accept(";"):
            return None
        if cursor.accept("RETURN"):
            value = None if cursor.is_at(";") else self._expressions.expression()
            return Leave(word.line, "RETURN", RETURN, value)
        if cursor.accept("EXIT"):
            return Leave(word.line, word.text, STOP)
        if cursor.is_at("GOTO", "RAISE", "RETRY", "TRYNEXT", "EXITCYCLE", "%"):
            return self._unreadable(word)
        if cursor.after(1).text == ":":  # a label
            cursor.take(), cursor.take()
            return self._simple(cursor.next) if not cursor.is_at(";") else None
        if cursor.accept("CONNECT"):
            self._expressions.expression()
            cursor.expect("WITH")
            trap = Constant(self._name("the name of a trap"))
            return Do(word.line, Call("CONNECT", (trap,), {}, word.line))
        return self._call_or_value(word)

    def _unreadable(self, word: Token) -> Unreadable:
        while not self._cursor.is_at(";"):
            if self._cursor.take().kind == END:
                self._cursor.refuse("';'")
        return Unreadable(word.line, word.text, jumps=True)

    def _call_or_value(self, word: Token) -> Statement:
        cursor = self._cursor
        following = cursor.after(1).text
        if following in (":=", ".", "{"):
            target = self._expressions.expression(7)
            cursor.expect(":=")
            return Assign(word.line, target, self._expressions.expression())
        name = self._name("a statement")
        args, named = self._expressions.arguments(";")
        if name in CHANGES and args:
            return _changed(name, args, word.line)
        return Do(word.line, Call(name, args, named, word.line))

    def _if(self, line: Line) -> Statement:
        cursor, branches = self._cursor, list[tuple[Expression | None, tuple[Statement, ...]]]()
        condition = self._expressions.expression()
        if not cursor.accept("THEN"):
            one = self._statement()
            return If(line, "if", ((condition, (one,) if one is not None else ()),))
        branches.append((condition, self._block()))
        while cursor.accept("ELSEIF"):
            condition = self._expressions.expression()
            cursor.expect("THEN")
            branches.append((condition, self._block()))
        if cursor.accept("ELSE"):
            branches.append((None, self._block()))
        cursor.expect("ENDIF")
        return If(line, "if", tuple(branches))

    def _for(self, line: Line) -> Statement:
        cursor, own = self._cursor, self._expressions
        name = Name(self._name("a name"), line)
        cursor.expect("FROM")
        first = own.expression()
        cursor.expect("TO")
        last = own.expression()
        step = own.expression() if cursor.accept("STEP") else None
        cursor.expect("DO")
        body = self._block()
        cursor.expect("ENDFOR")
        return For(line, "for", name, first, last, step, body, turns_back=True, is_own=True)

    def _while(self, line: Line) -> Statement:
        condition = self._expressions.expression()
        self._cursor.expect("DO")
        body = self._block()
        self._cursor.expect("ENDWHILE")
        return While(line, "while", condition, body)

    def _test(self, line: Line) -> Statement:
        cursor, branches = self._cursor, list[tuple[Expression | None, tuple[Statement, ...]]]()
        value = self._expressions.expression()
        while cursor.accept("CASE"):
            given, _ = self._expressions.arguments(":")
            cursor.expect(":")
            condition: Expression = Constant(False)
            for one in given:
                same = Operation(operator.eq, (value, one), line)
                condition = Operation(lambda a, b: bool(a) or bool(b), (condition, same), line)
            branches.append((condition, self._block()))
        if cursor.accept("DEFAULT"):
            cursor.expect(":")
            branches.append((None, self._block()))
        cursor.expect("ENDTEST")
        return If(line, "test", tuple(branches))
