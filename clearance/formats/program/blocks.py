"""Blocks of statements, as controllers' languages write them: branches, loops, and what stands up to an end.

Not for: statements that hold no others (each language).
"""

from __future__ import annotations

from collections.abc import Iterable

from clearance.errors import BadSyntax
from clearance.formats.program.expressions import (
    MOST_DEPTH,
    Expression,
    ExpressionReader,
    Name,
    Operation,
)
from clearance.formats.program.statements import For, If, Statement, While
from clearance.formats.program.tokens import END, NEWLINE, Line

Branch = tuple[Expression | None, tuple[Statement, ...]]
"""A condition, None for one that is always true, and the statements that it decides on."""


class BlockReader:
    """Reads statements where a cursor is.

    Attributes:
        ends: the words that end a block or a part of one, whichever it is. other: the word for what else is done.
    """

    ends: tuple[str, ...] = ()
    other = "ELSE"

    def __init__(self, expressions: ExpressionReader) -> None:
        self.expressions, self.cursor, self._depth = expressions, expressions.cursor, 0

    def statement(self) -> Iterable[Statement]:
        """The statements of the next words, which are then behind."""
        raise NotImplementedError

    def expression(self) -> Expression:
        """The expression that follows."""
        return self.expressions.expression()

    def name(self, what: str) -> str:
        """The name that follows."""
        return self.expressions.grammar.folded(self.cursor.expect_kind("name", what).text)

    def body(self) -> tuple[Statement, ...]:
        """Statements up to a word that ends a block, or to the end of the file."""
        found = list[Statement]()
        while not self.cursor.is_at(*self.ends) and self.cursor.next.kind != END:
            if self.cursor.next.kind == NEWLINE:
                self.cursor.take()
            else:
                found += self.statement()
        return tuple(found)

    def block(self, line: Line, word: str, *ends: str) -> tuple[Statement, ...]:
        """The statements of a block up to one of its ends, which is not taken.

        Args:
            line, word: where it begins, and by what.

        Raises:
            BadSyntax: it has none, or is too deep in others.
        """
        self._depth += 1
        if self._depth > MOST_DEPTH:
            raise BadSyntax(f"{word} within {MOST_DEPTH} blocks", where=str(line), valid="fewer")
        found = self.body()
        self._depth -= 1
        if not self.cursor.is_at(*ends):
            fault, valid = f"{word} has no {ends[-1]}", "a whole file: this one is cut off"
            if (other := self.cursor.next).kind != END:
                fault, valid = f"{fault} before {other.text!r:.40} at {other.line}", f"{ends[-1]}"
            raise BadSyntax(fault, where=str(line), valid=valid)
        return found

    def branches(
        self, line: Line, word: str, condition: Expression, then: str, further: str, end: str
    ) -> If:
        """`IF … THEN … ELSEIF … ELSE … ENDIF`, behind its first condition.

        Args:
            then: what has to be between a condition and its statements. further: the words of a further condition.
        """
        more, found = further.split(), list[Branch]()
        while True:
            if then:
                self.cursor.expect(then)
            self.cursor.accept(":")
            found.append((condition, self.block(line, word, *more, self.other, end)))
            if not self.cursor.accept(*more):
                break
            condition = self.expression()
        if self.cursor.accept(self.other):
            self.cursor.accept(":")
            found.append((None, self.block(line, word, end)))
        self.cursor.expect(end)
        return If(line, word, tuple(found))

    def cases(self, line: Line, word: str, end: str) -> If:
        """`SWITCH value … CASE 1, 2 … DEFAULT … ENDSWITCH`, behind its first word."""
        value, ends, found = self.expression(), ("CASE", "DEFAULT", end), list[Branch]()
        if stray := self.block(line, word, *ends):
            fault = f"{word} begins with a statement"
            raise BadSyntax(fault, where=str(stray[0].line), valid="CASE")
        while not self.cursor.accept(end):
            condition = None
            if self.cursor.take().text.upper() == "CASE":
                given = [self.expression()]
                while self.cursor.accept(","):
                    given.append(self.expression())
                condition = Operation(lambda one, *those: one in those, (value, *given), line)
            self.cursor.accept(":")
            found.append((condition, self.block(line, word, *ends)))
        return If(line, word, tuple(found))

    def loop(self, line: Line, word: str, mark: str, end: str) -> While:
        """`WHILE … DO … ENDWHILE`, behind its first word.

        Args:
            mark: what is behind the condition; nothing if it is empty.
        """
        condition = self.expression()
        if mark:
            self.cursor.expect(mark)
        body = self.block(line, word, end)
        self.cursor.take()
        return While(line, word, condition, body)

    def counted(self, line: Line, word: str, begin: str, mark: str) -> For:
        """`FOR i FROM 1 TO 3 STEP 2 DO … ENDFOR`, behind its first word.

        Args:
            begin: what is before the first value. mark: as of `loop`.
        """
        name = Name(self.name("a variable"), line)
        self.cursor.expect(begin)
        first = self.expression()
        self.cursor.expect("TO")
        last = self.expression()
        step = self.expression() if self.cursor.accept("STEP") else None
        if mark:
            self.cursor.expect(mark)
        body = self.block(line, word, "ENDFOR")
        self.cursor.take()
        return For(line, word, name, first, last, step, body)
