"""Words of a controller's language, each with its line. Not for: what they mean."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from clearance.errors import BadSyntax, ClearanceError


class Line(NamedTuple):
    """A line of a program, from 1; of a file beside the program's own, if that is named.

    Attributes:
        own: the number that the controller itself shows, if the file writes it.
    """

    number: int
    file: str = ""
    own: int = 0

    def __str__(self) -> str:
        return f"{self.file} line {self.number}".lstrip()


@contextmanager
def on(line: Line) -> Iterator[None]:
    """Says of an error on which line it arises, unless one within says it."""
    try:
        yield
    except ClearanceError as error:
        if "line " not in error.where:
            error.where = f"{line}: {error.where}".removesuffix(": ")
        raise


class Token(NamedTuple):
    """A word: the group of the pattern that it fits, and where it stands. The last is of kind `END`."""

    kind: str
    text: str
    line: Line


END, NEWLINE, SKIP = "END", "newline", "skip"
"""The kind of what follows the last word; groups of patterns: the end of a line, and what has no meaning."""


def text_of(data: bytes, file: str = "") -> str:
    """The text of a file in UTF-8, with or without a byte order mark, or else Latin-1; lines end in `\\n`.

    Args:
        file: as of a `Line`.

    Raises:
        BadSyntax: it is no text.
    """
    if b"\0" in data or data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise BadSyntax("this is no text of single bytes", where=file, valid="UTF-8 or Latin-1")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def tokens_of(text: str, pattern: re.Pattern[str], file: str = "") -> list[Token]:
    """All words of a text, the ends of lines within brackets left out.

    Args:
        pattern: its groups are the kinds of words. file: as of a `Line`.
    """
    found, at, number, depth = list[Token](), 0, 1, 0
    while at < len(text):
        match = pattern.match(text, at)
        kind = "other" if match is None else str(match.lastgroup)
        word = text[at] if match is None else match[0]
        if kind not in (NEWLINE, SKIP) or (kind == NEWLINE and depth == 0):
            found.append(Token(kind, word, Line(number, file)))
        depth = max(0, depth + (word in ("(", "[", "{")) - (word in (")", "]", "}")))
        number += word.count("\n")
        at += len(word)
    return [*found, Token(END, "", Line(number, file))]


class Cursor:
    """Goes through words.

    Args:
        folds: whether capital letters mean the same as small ones.
    """

    def __init__(self, tokens: Sequence[Token], folds: bool = False) -> None:
        self._tokens, self._folds, self._at = tokens, folds, 0

    @property
    def next(self) -> Token:
        """The next word."""
        return self._tokens[self._at]

    def after(self, n: int) -> Token:
        """The word that is n further on, or the last."""
        return self._tokens[min(self._at + n, len(self._tokens) - 1)]

    def take(self) -> Token:
        """The next word, and goes on; the last is taken again and again."""
        found = self.next
        self._at = min(self._at + 1, len(self._tokens) - 1)
        return found

    def is_at(self, *words: str) -> bool:
        """True where the next word is one of some."""
        text = self.next.text.upper() if self._folds else self.next.text
        return self.next.kind not in (END, "string") and text in words

    def accept(self, *words: str) -> Token | None:
        """The next word if it is one of some, and goes on."""
        return self.take() if self.is_at(*words) else None

    def expect(self, *words: str) -> Token:
        """The next word, which has to be one of some.

        Raises:
            BadSyntax: another is there, or the text ends.
        """
        return self.accept(*words) or self.refuse(" or ".join(repr(word) for word in words))

    def expect_kind(self, kind: str, what: str) -> Token:
        """The next word, which has to be of a kind.

        Raises:
            BadSyntax: as `expect`.
        """
        return self.take() if self.next.kind == kind else self.refuse(what)

    def refuse(self, wanted: str) -> Token:
        """Nothing.

        Raises:
            BadSyntax: something else than what is wanted is next.
        """
        ends = {END: "the file ends", NEWLINE: "the line ends"}
        found = ends.get(self.next.kind, f"{self.next.text!r:.60} is given")
        raise BadSyntax(found, where=str(self.next.line), valid=f"{wanted} is needed")
