"""Numbers in text as files of meshes, robots and scenes write them: ASCII digits, a sign, a point, an exponent,
and nothing else.

Python and numpy also take `1_0` for 10 and digits of other scripts; in a file either is damage. Not for:
tables (`csv_table`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import AnyStr

import numpy as np

from clearance.errors import BadShape, BadSyntax, NotFinite


def floats(words: Sequence[AnyStr]) -> np.ndarray:
    """(n,) the words as float64, each to the nearest double.

    Raises:
        BadSyntax: a word that is no number, with the word.
    """
    return _numbers(words, np.float64, "a number")


def integers(words: Sequence[AnyStr]) -> np.ndarray:
    """(n,) the words as int64.

    Raises:
        BadSyntax: a word that is no whole number of 64 bits, with the word.
    """
    return _numbers(words, np.int64, "a whole number")


def finite_numbers(text: str, given: str, counts: Collection[int] = ()) -> tuple[float, ...]:
    """The finite numbers in a text, as many as one of `counts`; any number of them where that is empty.

    Args:
        given: what is given, for the errors.

    Raises:
        BadShape: other words, none, or another number of them. NotFinite: NaN or infinity.
    """
    try:
        values = floats(text.split())
    except BadSyntax:
        values = np.empty(0)
    if not len(values) or (counts and len(values) not in counts):
        needed = f"{' or '.join(map(str, counts)) or 'a'} number"
        raise BadShape(given, valid=f"{needed}{' is' if counts in ((), (1,)) else 's are'} needed")
    if not np.isfinite(values).all():
        raise NotFinite(given, valid="finite numbers are needed")
    return tuple(values.tolist())


def is_double(number: int | float) -> bool:
    """True for a finite number that doubles can hold; whole numbers in a file may be longer."""
    try:
        return math.isfinite(number)
    except OverflowError:
        return False


def is_zero(word: str) -> bool:
    """True for a word that is the number 0."""
    try:
        return float(floats([word])[0]) == 0.0
    except BadSyntax:
        return False


def _numbers(words: Sequence[AnyStr], kind: type[np.generic], wanted: str) -> np.ndarray:
    if not len(words):
        return np.empty(0, dtype=kind)
    try:
        values: np.ndarray = np.array(words, dtype=kind)
        fits = _is_plain(words)
    except (ValueError, OverflowError):
        fits = False
    if fits:
        return values
    raise BadSyntax(f"{_shown(next(w for w in words if not _fits(w, kind)))} is not {wanted}")


def _is_plain(words: Sequence[AnyStr]) -> bool:
    joined = words[0][:0].join(words)
    return joined.isascii() and (b"_" if isinstance(joined, bytes) else "_") not in joined


def _fits(word: AnyStr, kind: type[np.generic]) -> bool:
    try:
        np.array([word], dtype=kind)
    except (ValueError, OverflowError):
        return False
    return _is_plain([word])


def _shown(word: str | bytes) -> str:
    text = word.decode("utf-8", errors="replace") if isinstance(word, bytes) else word
    return f"{text!r:.40}"
