"""Damage to text of lines and words: headers, units, separators, numbers and rows exchanged, and still such text.

Not for: bytes (`bytes`), nor documents (`trees`).
"""

from __future__ import annotations

import re
from random import Random

WORDS = (
    "0", "-0", "-0.0", "1", "-1", "2", "3", "4", "7", "255", "65536", "4294967295", "-4294967298",
    "99999999999999999999",
    "1e18", "1e308", "-1e308", "1e400", "1e-320", "1e160", "nan", "inf", "-inf", "1_0", "0x10", "0,01", "", "٣",
    "0.1",
    "1" * 5000, "true", "[]", "x", "-1e18", "1.5", "0.5e", "+1", ".", "-", "base", "tip", "m.stl", "../..", "a b",
    "x" * 3000, "*", "#", "0 0 0", "1 1 1", "0 0 1 0", "package://x/y", "model://x", "::",
)  # fmt: skip

UNITS = ("[mm]", "[m]", "[deg]", "[rad]", "[ms]", "[s]", "[in]", "[]", "(deg)", "/velocity")

_SEPARATOR = re.compile(r"[,; \t]")


def odd_word(random: Random) -> str:
    """A word that may stand where any other does."""
    return random.choice(WORDS)


def lines_damaged(valid: bytes, random: Random) -> bytes:
    """Text of which words or lines are exchanged."""
    lines = valid.decode("latin-1").splitlines()
    for _ in range(random.randint(1, 3)):
        if lines:
            random.choice(_DAMAGES)(lines, random)
    return _ended(lines, random).encode("utf-8")


def table_damaged(valid: bytes, random: Random) -> bytes:
    """A table of which cells, rows, columns, units or separators are exchanged."""
    lines = valid.decode().splitlines()
    for _ in range(random.randint(1, 3)):
        if lines:
            random.choice(_OF_TABLES)(lines, random)
    return _ended(lines, random).encode("utf-8")


def _ended(lines: list[str], random: Random) -> str:
    """The lines put together, for the most part as they were."""
    end = random.choice(("\n",) * 12 + ("\r\n", "\r", "\n\n"))
    begin = random.choice(("",) * 12 + ("\ufeff", "\n", "\x00"))
    return begin + end.join(lines) + random.choice((end, end, end, ""))


def _change_word(lines: list[str], random: Random) -> None:
    i = random.randrange(len(lines))
    words = re.split(r"([,; \t]+)", lines[i])
    words[random.randrange(0, len(words), 2)] = odd_word(random)
    lines[i] = "".join(words)


def _swap_words(lines: list[str], random: Random) -> None:
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    one, two = lines[i].split(" "), lines[j].split(" ")
    a, b = random.randrange(len(one)), random.randrange(len(two))
    word, other = one[a], two[b]
    one[a] = other
    lines[i] = " ".join(one)
    if i != j:
        two[b] = word
        lines[j] = " ".join(two)


def _count_words(lines: list[str], random: Random) -> None:
    """A word more or less."""
    i = random.randrange(len(lines))
    words = re.split(r"([,; \t]+)", lines[i])
    a = random.randrange(0, len(words), 2)
    between = words[1] if len(words) > 1 else " "
    words[a : a + 2] = random.choice(([], [words[a], between] * 2, [words[a], between] * 30))
    lines[i] = "".join(words)


def _drop_line(lines: list[str], random: Random) -> None:
    begin = random.randrange(len(lines))
    del lines[begin : begin + random.choice((1, 1, 3))]


def _repeat_lines(lines: list[str], random: Random) -> None:
    begin = random.randrange(len(lines))
    end = begin + random.choice((1, 1, 4))
    lines[end:end] = lines[begin:end] * random.choice((1, 1, 3, 50))


def _swap_lines(lines: list[str], random: Random) -> None:
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]


def _separate_otherwise(lines: list[str], random: Random) -> None:
    """Another separator, in one line or all."""
    mark = random.choice((",", ";", " ", "\t", ", ", "|"))
    chosen = range(len(lines)) if random.random() < 0.7 else [random.randrange(len(lines))]
    for i in chosen:
        lines[i] = _SEPARATOR.sub(mark, lines[i])


def _decimals_otherwise(lines: list[str], random: Random) -> None:
    chosen = range(len(lines)) if random.random() < 0.5 else [random.randrange(len(lines))]
    for i in chosen:
        lines[i] = lines[i].replace(".", ",")


def _change_unit(lines: list[str], random: Random) -> None:
    names = lines[0].split(",") if "," in lines[0] else lines[0].split(";")
    i = random.randrange(len(names))
    bare = re.sub(r"\s*[\[(].*", "", names[i])
    names[i] = f"{bare}{random.choice(('', ' '))}{random.choice(UNITS)}"
    lines[0] = (";" if ";" in lines[0] else ",").join(names)


def _change_column(lines: list[str], random: Random) -> None:
    """A column left out, or there twice, in all rows."""
    mark = ";" if ";" in lines[0] else ","
    at = random.randrange(len(lines[0].split(mark)))
    times = random.choice((0, 2))
    for i, line in enumerate(lines):
        cells = line.split(mark)
        cells[at : at + 1] = cells[at : at + 1] * times
        lines[i] = mark.join(cells)


def _quote(lines: list[str], random: Random) -> None:
    i = random.randrange(len(lines))
    words = re.split(r"([,; \t]+)", lines[i])
    a = random.randrange(0, len(words), 2)
    words[a] = random.choice(('"{}"', '"{}', "'{}'", " {} ", "#{}")).format(words[a])
    lines[i] = "".join(words)


_DAMAGES = (
    _change_word, _change_word, _change_word, _change_word, _swap_words, _count_words, _drop_line, _repeat_lines,
    _swap_lines,
)  # fmt: skip

_OF_TABLES = (
    *_DAMAGES, _separate_otherwise, _decimals_otherwise, _change_unit, _change_unit, _change_column, _quote,
)  # fmt: skip
