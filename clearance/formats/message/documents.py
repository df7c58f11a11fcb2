"""YAML and JSON dumps of messages to plain data, which remembers the line of each mapping.

Numbers are those of JSON and YAML 1.2, tags are refused, an alias means the very same data, so that a small file
cannot ask for much; nothing is made but lists, mappings, text and numbers. Not for: reading YAML (`plain_yaml`),
nor which messages there are (`joint_messages`).
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from clearance.errors import BadSyntax, DuplicateName
from clearance.plain_yaml import PlainValues, events_to_data, not_plain, text_of

MOST_YAML = 16_000_000
"""[bytes] Read in some 45 s: 25,000 points of 7 joints with velocities."""

MOST_JSON = 64_000_000
"""[bytes] Parsed at once, into some 10 times as much memory."""

DEPTH = 32
"""Levels of lists and mappings; the deepest message of trajectories has 8."""

_WHOLE = re.compile(r"[-+]?[0-9]{1,18}")
_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.?(nan|inf)", re.IGNORECASE)


class Fields(dict[str, Any]):
    """A mapping, and the line that it begins on, where that is known."""

    line: int | None = None


def yaml_documents(data: bytes, factors: Mapping[str, float] | None = None) -> list[Any]:
    """The documents of a YAML file that are not empty.

    Args:
        factors: what tags of numbers multiply by; other tags are refused.

    Raises:
        BadSyntax: not YAML, with a tag, too long or too deep. DuplicateName: a key twice.
    """
    _refuse_long(data, MOST_YAML)
    text = text_of(data)
    _refuse_deep_brackets(data)
    found = events_to_data(text, _MessageValues(factors or {}))
    return [document for document in found if document not in (None, "")]


def json_documents(data: bytes) -> list[Any]:
    """The values of a JSON file; mostly one.

    Raises:
        BadSyntax: not JSON, too long or too deep. DuplicateName: a key twice.
    """
    _refuse_long(data, MOST_JSON)
    text = text_of(data)
    _refuse_deep_brackets(data)
    decoder = json.JSONDecoder(object_pairs_hook=_fields, parse_int=_number)
    documents, begin = [], _end_of_space(text, 0)
    while begin < len(text):
        try:
            document, end = decoder.raw_decode(text, begin)
        except json.JSONDecodeError as error:
            raise BadSyntax(f"not JSON: {error.msg}", where=f"line {error.lineno}") from None
        documents.append(document)
        begin = _end_of_space(text, end)
    return documents


class _MessageValues(PlainValues):
    """Numbers of JSON and YAML 1.2, and text; truths stay text, for who knows the field."""

    def __init__(self, factors: Mapping[str, float]) -> None:
        super().__init__(math.inf, DEPTH)  # who goes through a message counts what it repeats
        self._factors = factors

    def value(self, event: Any) -> Any:
        factor = self._factor(event)
        value = _plain(event.value) if event.implicit[0] or factor else event.value
        return value * factor if factor is not None and isinstance(value, int | float) else value

    def key(self, event: Any) -> str:
        self._factor(event)
        return str(event.value)

    def mapping(self, event: Any) -> Fields:
        made = Fields()
        made.line = event.start_mark.line + 1
        return made

    def _factor(self, event: Any) -> float | None:
        factor = self._factors.get(str(event.tag))
        if factor is None and event.tag is not None:
            raise not_plain(event)
        return factor


def described(value: object) -> str:
    """What a value is, short; what aliases repeat without end is not gone through."""
    if isinstance(value, Fields):
        return f"a mapping of {', '.join(map(repr, value)) or 'nothing':.60}"
    return f"a list of {len(value)}" if isinstance(value, list) else f"{value!r:.60}"


def _plain(text: str) -> Any:
    """What text without quotes means."""
    if _WHOLE.fullmatch(text):
        return int(text)
    if _NUMBER.fullmatch(text):
        return float(text)
    if _NOT_FINITE.fullmatch(text):
        return float(text.replace(".", ""))
    return None if text in ("", "~", "null") else text


def _number(text: str) -> int | float:
    return int(text) if len(text) <= 18 else float(text)


def _fields(pairs: list[tuple[str, Any]]) -> Fields:
    made = Fields(pairs)
    if len(made) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise DuplicateName(f"key {twice!r:.60} is there twice", valid="each key once")
    return made


def _end_of_space(text: str, begin: int) -> int:
    found = re.compile(r"\s*").match(text, begin)
    return found.end() if found else begin


_LEVELS = f"{DEPTH} levels or fewer"


def _refuse_long(data: bytes, most: int) -> None:
    if len(data) > most:
        raise BadSyntax(
            f"the file has more than {most:,} bytes", valid="a longer trajectory goes as CSV"
        )


def _refuse_deep_brackets(data: bytes) -> None:
    """Both parsers take time or stack by the depth of brackets before a level is seen; text counts too."""
    letters = np.frombuffer(data, dtype=np.uint8)
    opens = np.isin(letters, list(b"[{")).astype(np.int64)
    depth = np.cumsum(opens - np.isin(letters, list(b"]}")))
    if len(depth) and (depth - np.minimum.accumulate(np.minimum(depth, 0))).max() > 2 * DEPTH:
        raise BadSyntax("brackets are nested too deep", valid=_LEVELS)
