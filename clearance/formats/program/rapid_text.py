"""RAPID as statements. Not for: what its instructions do (`rapid`), nor its data (`rapid_data`).

Source: ABB, Technical reference manual, RAPID kernel.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

from clearance.errors import DuplicateName
from clearance.formats.program.blocks import BlockReader
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    ExpressionReader,
    Name,
    Operation,
)
from clearance.formats.program.rapid_words import GRAMMAR, WORD, added
from clearance.formats.program.statements import (
    RETURN,
    STOP,
    Assign,
    Do,
    If,
    Leave,
    Routine,
    Statement,
    Unreadable,
)
from clearance.formats.program.tokens import END, Cursor, Line, Token, tokens_of

FIRST = {"num": 0.0, "dnum": 0.0, "bool": False, "string": ""}
"""Values of data that are declared without one, by their types."""

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

    def read(self, text: str, file: str = "") -> None:
        """Adds the modules of a file.

        Raises:
            BadSyntax: with the line. DuplicateName: two of a name.
        """
        cursor = Cursor(_with_own_names(tokens_of(text, WORD, file)), folds=True)
        reader = _Reader(ExpressionReader(cursor, GRAMMAR))
        reader.into = self
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
    begins = [i for i, one in enumerate(tokens) if one.text.upper() == "MODULE"]
    found = list(tokens)
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


class _Reader(BlockReader):
    """Reads modules, one after another."""

    into: Modules
    ends = _BLOCKS_END

    def module(self) -> None:
        """A module."""
        cursor = self.cursor
        cursor.expect("MODULE")
        self.name("the name of the module")
        if cursor.accept("("):
            while not cursor.accept(")"):
                self.name("an attribute")
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
        if one.name in self.into.declared:
            raise DuplicateName(f"{one.name!r} is declared twice", where=str(one.line))
        self.into.declared[one.name] = one

    def _declaration(self) -> Declaration:
        cursor = self.cursor
        kind = cursor.take()
        type_name = self.name("a type")
        name = self.name("a name")
        sizes = list[Expression]()
        if cursor.accept("{"):
            while not cursor.accept("}"):
                sizes.append(self.expression())
                cursor.accept(",")
        value = self.expression() if cursor.accept(":=") else None
        cursor.expect(";")
        return Declaration(kind.line, kind.text.upper(), type_name, name, value, tuple(sizes))

    def _record(self) -> None:
        name = self.name("the name of the record")
        fields = list[str]()
        while not self.cursor.accept("ENDRECORD"):
            self.name("a type")
            fields.append(self.name("a name"))
            self.cursor.expect(";")
        self.into.records[name] = fields

    def _routine(self) -> None:
        cursor, kind = self.cursor, self.cursor.take().text.upper()
        if kind == "FUNC":
            self.name("a type")
        line, name = cursor.next.line, self.name("a name")
        parameters, returned = self._parameters() if cursor.accept("(") else ([], set[str]())
        ends, handlers = (*_HANDLERS, _ROUTINES[kind]), list[tuple[str, tuple[Statement, ...]]]()
        body = self.block(line, kind, *ends)
        while not cursor.accept(ends[-1]):
            handler = cursor.take().text.upper()
            if cursor.accept("("):
                self.expressions.arguments(")")
                cursor.expect(")")
            handlers.append((handler, self.block(line, kind, *ends)))
        if name in self.into.routines:
            raise DuplicateName(f"{name!r} is there twice", where=str(line))
        own = name, line, tuple(parameters), body, kind == "TRAP", frozenset(returned)
        self.into.routines[name] = Routine(*own, handlers=tuple(handlers))

    def _parameters(self) -> tuple[list[str], set[str]]:
        """Names of parameters, those that a call names last; and of those that are the caller's own."""
        cursor, returned = self.cursor, set[str]()
        names, optional = list[str](), list[str]()
        while not cursor.accept(")"):
            by_name = cursor.accept("\\", "|") is not None
            own = cursor.accept("INOUT", "VAR", "PERS", "REF")
            first = self.name("a type")
            name = self.name("a name") if cursor.next.kind == "name" else first
            if cursor.accept("{"):
                while not cursor.accept("}"):
                    cursor.take() if cursor.next.kind != END else cursor.refuse("'}'")
            (optional if by_name else names).append(name)
            if own:
                returned.add(name)
            if not cursor.accept(",") and not cursor.is_at(")", "\\", "|"):
                cursor.refuse("',' or ')'")
        return [*names, *optional], returned

    def statement(self) -> list[Statement]:
        """The statement that follows; none of an empty one, or a label."""
        cursor, line = self.cursor, self.cursor.next.line
        if cursor.is_at(*_DATA):
            return [self._own(self._declaration())]
        if cursor.accept("IF"):
            return [self._if(line)]
        if cursor.accept("FOR"):
            found = self.counted(line, "for", "FROM", "DO")
            return [replace(found, turns_back=True, is_own=True)]
        if cursor.accept("WHILE"):
            return [self.loop(line, "while", "DO", "ENDWHILE")]
        if cursor.accept("TEST"):
            return [self.cases(line, "test", "ENDTEST")]
        one = self._simple(cursor.next)
        cursor.expect(";")
        return [one] if one is not None else []

    def _own(self, one: Declaration) -> Statement:
        """A datum of a routine, as it is entered."""
        first = one.value or Constant(FIRST.get(one.type_name))
        given = Call("%array", (first, *one.sizes), {}, one.line) if one.sizes else first
        return Assign(one.line, Name(one.name, one.line), given, is_own=True)

    def _if(self, line: Line) -> Statement:
        """A branch with an end, or one of a single statement."""
        condition = self.expression()
        if self.cursor.is_at("THEN"):
            return self.branches(line, "if", condition, "THEN", "ELSEIF", "ENDIF")
        return If(line, "if", ((condition, tuple(self.statement())),))

    def _simple(self, word: Token) -> Statement | None:
        """A statement before `;`, which is not taken."""
        cursor = self.cursor
        if cursor.is_at(";"):
            return None
        if cursor.accept("RETURN"):
            value = None if cursor.is_at(";") else self.expression()
            return Leave(word.line, "RETURN", RETURN, value)
        if cursor.accept("EXIT"):
            return Leave(word.line, word.text, STOP)
        if cursor.is_at("GOTO", "RAISE", "RETRY", "TRYNEXT", "EXITCYCLE", "%"):
            while not cursor.is_at(";"):
                if cursor.take().kind == END:
                    cursor.refuse("';'")
            return Unreadable(word.line, word.text, jumps=True)
        if cursor.after(1).text == ":":  # a label
            cursor.take(), cursor.take()
            return self._simple(cursor.next)
        if cursor.accept("CONNECT"):
            self.expression()
            cursor.expect("WITH")
            trap = Constant(self.name("the name of a trap"))
            return Do(word.line, Call("CONNECT", (trap,), {}, word.line))
        return self._call_or_value(word)

    def _call_or_value(self, word: Token) -> Statement:
        if self.cursor.after(1).text in (":=", ".", "{"):
            target = self.expressions.expression(5)
            self.cursor.expect(":=")
            return Assign(word.line, target, self.expression())
        name = self.name("a statement")
        args, named = self.expressions.arguments(";")
        if name in CHANGES and args:
            return _changed(name, args, word.line)
        return Do(word.line, Call(name, args, named, word.line))
