"""Words that no text for users has, and what to write instead: add a row, then mend what is found."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Word:
    """A pattern, what to write instead, and a text in which the pattern is found."""

    pattern: str
    instead: str
    example: str


SENTENCE = r"(?:^|(?<=[.!?] )|(?<=^[-|] ))"

WORDS = (
    Word(SENTENCE + r"(Of|What|Whose|Those) ", "begin with the noun", "It ends. Of these none is left."),
    Word(SENTENCE + r"That ", "begin with the noun, or This", "That it holds is proven."),
    Word(SENTENCE + r"Where [^.,;|]* of[.,]", "name the thing", "Where it is not of, none is."),
    Word(
        r"(?i)\b(that|those|whose) (of|from|to|in|at|by|with|for) (which|whom)\b",
        "name the thing", "that of which least is left",
    ),
    Word(
        r"(?i)\bof what (is|are|was)\b|\bwhat (it|they) (is|are) of\b",
        "name the thing", "a part of what is left",
    ),
    Word(
        r"(?i)\b(is|are|was|were|be) of\b(?! (type|the same)\b)",
        "is for, belongs to, comes from, applies to", "the receipt is of a case",
    ),
    Word(r"(?i)\bways? out\b", "separation vector", "the way out of a body"),
    Word(r"(?i)\bstale\b", "unused or expired waiver; outdated", "a stale waiver"),
    Word(r"(?i)\bstands? worst\b", "is critical", "the pair that stands worst"),
    Word(r"(?i)\b(tells?|told|telling)\b", "says, states, reports, notes; to distinguish", "depth is told"),
    Word(r"(?i)\bprove[ns]? apart\b", "proven separate", "they are proven apart"),
    Word(r"(?i)\bheld against\b", "compared with", "a run held against another"),
    Word(r"(?i)\bkept of\b", "kept from, reused from", "rows are kept of a run"),
    Word(
        r"(?i)\blooked at\b|\blooks? at (the samples|what|which)\b",
        "measured, checked, searched", "the samples were looked at",
    ),
    Word(r"(?i)\bcannot do\b", "lower bound, is needed", "less than 3 mm cannot do"),
    Word(r"(?i)\bmissing or unknown\b", "unknown: a; missing: b", "missing or unknown joints: a, b"),
)  # fmt: skip


MOST_WORDS = 25
"""The longest sentence that is read at once."""

IN_SENTENCES = {"a", "the", "is", "of"}
"""A list of names has none of them, and may be longer."""


def unclear(text: str) -> list[str]:
    """What is unclear about a text: words that were found, with what to write instead, and long sentences."""
    found = ((re.search(word.pattern, text), word.instead) for word in WORDS)
    words = [f"{match[0].strip()} -> {instead}" for match, instead in found if match]
    parts = [part.split() for part in re.split(r"(?<=[.;:?!]) | \| |\n", text)]
    long = [
        part for part in parts if len(part) > MOST_WORDS and IN_SENTENCES & {*map(str.lower, part)}
    ]
    return words + [f"over {MOST_WORDS} words: {' '.join(part)}" for part in long]
