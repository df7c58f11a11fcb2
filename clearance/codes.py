"""Stable codes of all that is said of input and results: errors, notices, findings.

All that is known of a code stands in one table, `codes.toml`. Each class of errors, kind of notice and kind
of finding has its code there by name. Not for: the texts themselves, which are made where something is found.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TABLE = Path(__file__).with_suffix(".toml")

GROUPS = {
    "0": "Curves, profiles and sketches",
    "1": "Input files",
    "2": "Robot",
    "3": "Scene and bodies",
    "4": "Motion",
    "5": "Limits, rules and waivers",
    "6": "Proof, tolerances and receipts",
    "7": "Results, installation and command line",
    "8": "Programs and changes",
    "9": "Batch",
}
"""What codes are about, by their first digit."""

_HEAD = re.compile(r'^\[(CL\d{3})\]\nof = "(.+)"$', re.MULTILINE)


@dataclass(frozen=True)
class Entry:
    """What is known of a code.

    Attributes:
        of: the class of errors, or the kind of notice or finding. means, matters, remedy: a sentence or two.
        example: a line that has the code.
    """

    code: str
    of: str
    title: str
    means: str
    matters: str
    remedy: str
    example: str

    @property
    def group(self) -> str:
        """What codes of its hundred are about."""
        return GROUPS[self.code[2]]


@cache
def codes() -> dict[str, str]:
    """The code of each class and kind. Read without the rest of the table: a run has no use for that."""
    return {of: code for code, of in _HEAD.findall(TABLE.read_text(encoding="utf-8"))}


@cache
def entries() -> dict[str, Entry]:
    """The whole table by code."""
    import tomllib

    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return {code: Entry(code, **told) for code, told in table.items()}


def code_of_error(kind: type[BaseException]) -> str:
    """The code of a class of errors, or of the nearest class above it that has one."""
    return next(found for one in kind.__mro__ if (found := codes().get(one.__name__)))


def coded(text: str, code: str) -> str:
    """A line with its code; what has none stays as it is."""
    return f"{text} [{code}]" if code else text


def coded_of(text: str, of: str) -> str:
    """A line with the code of its kind."""
    return coded(text, codes()[of])


def kind_of(given: str) -> str:
    """The kind that a code is of; what is no code is returned as it is."""
    return next((of for of, code in codes().items() if code == given), given)
