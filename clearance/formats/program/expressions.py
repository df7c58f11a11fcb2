"""Expressions of controllers' languages: what they are made of, how they are read, and their values.

A value is a number, a text, a list, a record, or not known: then it may not decide where the robot goes. Not for:
what functions mean (each language).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from clearance.errors import BadProgram, BadSyntax, ClearanceError
from clearance.formats.program.grammar import Grammar, is_number
from clearance.formats.program.tokens import Cursor, Line, Token, on

MOST_PARTS = 200
"""Operators in a row, and parts of parts."""

MOST_DEPTH = 60
"""Brackets within brackets."""

MOST_SHOWN = 40
"""Characters of a value in a message."""


@dataclass(frozen=True)
class Unknown:
    """A value that only the controller knows.

    Attributes:
        what: the value that is unknown. hint: what may be meant, slow to find; empty where nothing is near.
        remedy: the key of the case that gives it, and what it means; empty where there is none.
    """

    what: str
    hint: Callable[[], str] = field(default=str, compare=False, repr=False)
    remedy: str = field(default="", compare=False)

    def __repr__(self) -> str:
        return "what is not known"

    @property
    def why(self) -> str:
        """Of what it is, with the hint."""
        hint = self.hint()
        return f"{self.what} ({hint})" if hint else self.what

    def valid(self, other: str) -> str:
        """What is valid in its place, beside another way."""
        return f"{other}, or {self.remedy}" if self.remedy else other


@dataclass(frozen=True)
class Constant:
    """A number, a text, or a truth."""

    value: Any


@dataclass(frozen=True)
class Name:
    """A variable."""

    name: str
    line: Line


@dataclass(frozen=True)
class Passed(Name):
    """An argument that a routine has been given, and passes on if it has."""


@dataclass(frozen=True)
class Items:
    """Values in brackets; `kind` is what stands before them."""

    items: tuple[Expression, ...]
    kind: str = ""


@dataclass(frozen=True)
class Call:
    """A function or an instruction with its arguments, in their order and by name."""

    name: str
    args: tuple[Expression, ...]
    named: Mapping[str, Expression]
    line: Line


@dataclass(frozen=True)
class Part:
    """A part of a value: by an index, or by the name of a field."""

    of: Expression
    by: Expression | str
    line: Line


@dataclass(frozen=True)
class Operation:
    """An operator on one or two values; `word` is how it is written."""

    act: Callable[..., Any]
    on: tuple[Expression, ...]
    line: Line
    word: str = "this"


Expression = Constant | Name | Items | Call | Part | Operation


class Scope(Protocol):
    """Where names and functions have their values."""

    def value_of(self, name: Name) -> Any:
        """The value of a variable."""

    def result_of(self, call: Call) -> Any:
        """The value of a function."""

    language: Any
    """Which makes values in brackets (`items`), and finds parts of values (`part_of`)."""


def value_of(one: Expression, scope: Scope) -> Any:
    """The value of an expression; `Unknown` where a part that decides it is.

    Raises:
        BadInput: with the line: what is not there, or does not go together.
    """
    match one:
        case Constant():
            return one.value
        case Name():
            return scope.value_of(one)
        case Call():
            return scope.result_of(one)
        case Items():
            items = [value_of(item, scope) for item in one.items]
            return scope.language.items(items, one.kind)
        case Part():
            by = one.by if isinstance(one.by, str) else value_of(one.by, scope)
            name = "'.'" if isinstance(one.by, str) else "an index"
            return applied(scope.language.part_of, (value_of(one.of, scope), by), one.line, name)
        case Operation():
            return applied(one.act, [value_of(item, scope) for item in one.on], one.line, one.word)


def applied(act: Callable[..., Any], values: Sequence[Any], line: Line, name: str = "this") -> Any:
    """What an operator or a function of a name makes of values; `Unknown` where one of them is.

    Raises:
        BadInput: with the line: values that it does not take.
    """
    for value in values:
        if isinstance(value, Unknown):
            return value
    with on(line):
        try:
            return act(*values)
        except ClearanceError:
            raise
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            given = " and ".join(map(_shown, values))
            raise BadProgram(f"{name} has no value for {given}") from None


def _shown(value: Any) -> str:
    """A value in a message; of a long one, its kind alone."""
    text = repr(value)
    if len(text) <= MOST_SHOWN:
        return text
    kinds = {list: f"a list of {len(value)}", dict: f"data of {len(value)} parts"}
    return next((kind for one, kind in kinds.items() if isinstance(value, one)), "a long text")


def known(value: Any, what: str) -> Any:
    """The value, if it is known to its last part.

    Raises:
        BadProgram: what only the controller knows.
    """
    for part in value if isinstance(value, list) else [value]:
        if isinstance(part, list):
            known(part, what)
        if isinstance(part, Unknown):
            raise BadProgram(f"{what} is not known: {part.why}", valid=part.valid("a constant"))
    return value


def number(value: Any, what: str) -> float:
    """A value that has to be a known number.

    Raises:
        BadProgram: it is none.
    """
    if not is_number(known(value, what)):
        raise BadProgram(f"{what} is {value!r:.60}", valid="a number")
    return float(value)


def calls_in(one: Expression) -> Iterator[Call]:
    """All calls of functions in an expression, those within others too."""
    if isinstance(one, Call):
        yield one
    for part in _parts(one):
        yield from calls_in(part)


def with_passed(call: Call, given: Collection[str]) -> Call:
    """A call without the arguments that it would pass on and the routine, of these arguments, is not given."""
    named = {
        key: one
        for key, one in call.named.items()
        if not isinstance(one, Passed) or one.name in given
    }
    return call if len(named) == len(call.named) else replace(call, named=named)


def names_in(one: Expression) -> Iterator[str]:
    """All variables in an expression."""
    if isinstance(one, Name):
        yield one.name
    for part in _parts(one):
        yield from names_in(part)


def is_constant(one: Expression) -> bool:
    """True for an expression of constants only."""
    made_of = Constant | Items | Operation
    return isinstance(one, made_of) and all(is_constant(part) for part in _parts(one))


def _parts(one: Expression) -> tuple[Expression, ...]:
    match one:
        case Call():
            return (*one.args, *one.named.values())
        case Items():
            return one.items
        case Part():
            return (one.of,) if isinstance(one.by, str) else (one.of, one.by)
        case Operation():
            return one.on
        case _:
            return ()


class ExpressionReader:
    """Reads expressions where a cursor is."""

    def __init__(self, cursor: Cursor, grammar: Grammar) -> None:
        self.cursor, self.grammar, self._depth = cursor, grammar, 0

    def expression(self, power: int = 0) -> Expression:
        """The expression that follows, whose operators bind more firmly than a power.

        Raises:
            BadSyntax: something else follows.
        """
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self.cursor.refuse(f"an expression of at most {MOST_DEPTH} brackets")
        found = self._prefixed()
        n_parts = 0
        while (rule := self.grammar.binary.get(self._word)) and rule[0] > power:
            word = self.cursor.take()
            found = Operation(
                rule[1], (found, self.expression(rule[0])), word.line, repr(word.text)
            )
            n_parts = self._counted(n_parts)
        self._depth -= 1
        return found

    def _counted(self, n_parts: int) -> int:
        if n_parts == MOST_PARTS:
            self.cursor.refuse(f"an expression of at most {MOST_PARTS} parts")
        return n_parts + 1

    def arguments(self, *ends: str) -> tuple[tuple[Expression, ...], dict[str, Expression]]:
        """The arguments up to one of some words, which is not taken: in their order, and by name. One that is left
        out is not known.

        Raises:
            BadSyntax: the text ends before.
        """
        args, named = list[Expression](), dict[str, Expression]()
        cursor, mark = self.cursor, self.grammar.optional
        while not cursor.is_at(*ends):
            if mark and cursor.accept(mark):
                name = self.grammar.folded(
                    cursor.expect_kind("name", "the name of an argument").text
                )
                if cursor.accept("?"):
                    word = cursor.expect_kind("name", "an argument of the routine")
                    named[name] = Passed(self.grammar.folded(word.text), word.line)
                else:
                    named[name] = self.expression() if cursor.accept(":=") else Constant(True)
            elif not mark and cursor.next.kind == "name" and cursor.after(1).text == "=":
                name = cursor.take().text
                cursor.take()
                named[name] = self.expression()
            elif self.grammar.leaves_out and cursor.is_at(","):
                args.append(Constant(Unknown("it is left out")))
            else:
                args.append(self.expression())
            if not cursor.accept(",") and not cursor.is_at(*ends, *([mark] if mark else [])):
                cursor.refuse(", or ".join(repr(one) for one in (",", *ends)))
        return tuple(args), named

    @property
    def _word(self) -> str:
        word = self.cursor.next
        return word.text.upper() if self.grammar.fold and word.kind == "name" else word.text

    def _prefixed(self) -> Expression:
        rule = self.grammar.unary.get(self._word) if self.cursor.next.kind != "string" else None
        if rule is None:
            return self._with_parts(self._atom())
        word = self.cursor.take()
        return Operation(rule[1], (self.expression(rule[0]),), word.line, repr(word.text))

    def _atom(self) -> Expression:
        cursor = self.cursor
        if cursor.accept("("):
            found = self.expression()
            cursor.expect(")")
            return found
        if cursor.accept("["):
            return self._items("")
        if cursor.next.kind == "number":
            return Constant(_number(cursor.take()))
        if cursor.next.kind == "string":
            return Constant(cursor.take().text[1:-1])
        word = cursor.expect_kind("name", "a value")
        if word.text in self.grammar.before_items and cursor.accept("["):
            return self._items(word.text)
        if self.grammar.folded(word.text) in self.grammar.constants:
            return Constant(self.grammar.constants[self.grammar.folded(word.text)])
        return (
            self.called(word)
            if cursor.is_at("(")
            else Name(self.grammar.folded(word.text), word.line)
        )

    def called(self, word: Token) -> Call:
        """A function's call, whose name is taken and whose bracket follows."""
        self.cursor.expect("(")
        args, named = self.arguments(")")
        self.cursor.expect(")")
        return Call(self.grammar.folded(word.text), args, named, word.line)

    def _items(self, kind: str) -> Items:
        args, _ = self.arguments("]")
        self.cursor.expect("]")
        return Items(args, kind)

    def _with_parts(self, found: Expression) -> Expression:
        opens, closes = self.grammar.index[0], self.grammar.index[1]
        n_parts = 0
        while True:
            line, n_parts = self.cursor.next.line, self._counted(n_parts)
            if self.cursor.accept("."):
                word = self.cursor.expect_kind("name", "the name of a field")
                by = word.text
                if self.cursor.is_at("(") and isinstance(found, Name):
                    found = self.called(word._replace(text=f"{found.name}.{by}"))
                    continue
                found = Part(found, self.grammar.folded(by), line)
            elif self.cursor.accept(opens):
                found = Part(found, self.expression(), line)
                while self.cursor.accept(","):
                    found = Part(found, self.expression(), line)
                self.cursor.expect(closes)
            else:
                return found


def _number(word: Token) -> float:
    """A number: decimals, or digits after 0x, 0b, 'H or 'B. Whole ones stay so, which counts in KRL."""
    text, bases = word.text.lower().strip("'"), {"0x": 16, "0b": 2, "h": 16, "b": 2}
    mark = next((one for one in bases if text.startswith(one)), "")
    try:
        value = int(text[len(mark) :], bases[mark]) if mark else float(text)
    except ValueError:
        value = math.inf
    if not value < 1e300:
        valid = "a number of this earth"
        raise BadSyntax(f"{word.text!r:.60} is given", where=str(word.line), valid=valid)
    return int(text) if text.isdigit() else value
