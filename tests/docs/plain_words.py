"""Words that no text for users has, and what to write instead."""

from __future__ import annotations

import re

SENTENCE = r"(?:^|(?<=[.!?] )|(?<=^[-|] ))"

WORDS = {
    SENTENCE + r"(Of|What|Whose|Those) ": "begin with the noun",
    SENTENCE + r"That ": "begin with the noun, or This",
    SENTENCE + r"Where [^.,;|]* of[.,]": "name the thing",
    r"(?i)\b(that|those|whose) (of|from|to|in|at|by|with|for) (which|whom)\b": "name the thing",
    r"(?i)\bof what (is|are|was)\b|\bwhat (it|they) (is|are) of\b": "name the thing",
    r"(?i)\b(is|are|was|were|be) of\b(?! (type|the same)\b)": "is for, belongs to, comes from, applies to",
    r"(?i)\bways? out\b": "separation vector",
    r"(?i)\bstale\b": "unused or expired waiver; outdated",
    r"(?i)\bstands? worst\b": "is critical",
    r"(?i)\b(tells?|told|telling)\b": "says, states, reports, notes; to distinguish",
    r"(?i)\bprove[ns]? apart\b": "proven separate",
    r"(?i)\bheld against\b": "compared with",
    r"(?i)\bkept of\b": "kept from, reused from",
    r"(?i)\blooked at\b|\blooks? at (the samples|what|which)\b": "measured, checked, searched",
    r"(?i)\bcannot do\b": "lower bound, is needed",
    r"(?i)\bmissing or unknown\b": "unknown: a; missing: b",
}
"""By pattern what to write instead."""

MOST_WORDS = 25
"""The longest sentence that is read at once."""

IN_SENTENCES = {"a", "the", "is", "of"}
"""A list of names has none of them, and may be longer."""


def unclear(text: str) -> list[str]:
    """What is unclear about a text: words that were found, with what to write instead, and long sentences."""
    found = ((re.search(pattern, text), instead) for pattern, instead in WORDS.items())
    words = [f"{match[0].strip()} -> {instead}" for match, instead in found if match]
    parts = [part.split() for part in re.split(r"(?<=[.;:?!]) | \| |\n", text)]
    long = [
        part for part in parts if len(part) > MOST_WORDS and IN_SENTENCES & {*map(str.lower, part)}
    ]
    return words + [f"over {MOST_WORDS} words: {' '.join(part)}" for part in long]
