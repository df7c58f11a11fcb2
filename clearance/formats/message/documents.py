"""YAML and JSON dumps of messages to plain data, which remembers the line of each mapping.

YAML is read event by event: numbers are those of JSON and YAML 1.2, tags are refused, an alias means the very same
data, so that a small file cannot ask for much; nothing is made but lists, mappings, text and numbers. Not for:
case files (`yaml_file`), nor which messages there are (`joint_messages`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import BadSyntax, ClearanceError, DuplicateName

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
    from ruamel.yaml import YAML

    _refuse_long(data, MOST_YAML)
    text = _text(data)
    _refuse_deep_brackets(data)
    builder = _Builder(factors or {})
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
    except ClearanceError:
        raise
    except Exception as error:  # whatever a parser that is not ours dies of, the file brought it
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or str(error) or type(error).__name__
        raise BadSyntax(f"not YAML: {problem}", where=_line(mark)) from None
    return [document for document in builder.documents if document not in (None, "")]


def json_documents(data: bytes) -> list[Any]:
    """The values of a JSON file; mostly one.

    Raises:
        BadSyntax: not JSON, too long or too deep. DuplicateName: a key twice.
    """
    _refuse_long(data, MOST_JSON)
    text = _text(data)
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


class _OpenNode(NamedTuple):
    """A list or mapping that has not ended; `key` holds the key that waits for its value, or nothing."""

    made: list[Any] | Fields
    anchor: str | None
    key: list[str]


class _Builder:
    """Takes the events of a YAML parser one by one."""

    def __init__(self, factors: Mapping[str, float]) -> None:
        self._factors = factors
        self.documents: list[Any] = []
        self._open: list[_OpenNode] = []
        self._anchors: dict[str, Any] = {}

    def take(self, event: Any) -> None:
        """Adds what an event says.

        Raises:
            BadSyntax, DuplicateName: with the line.
        """
        kind = type(event).__name__
        if kind == "ScalarEvent":
            self._take_scalar(event)
        elif kind in ("MappingStartEvent", "SequenceStartEvent"):
            self._begin(event, Fields() if kind == "MappingStartEvent" else [])
        elif kind in ("MappingEndEvent", "SequenceEndEvent"):
            ended = self._open.pop()
            self._put(ended.made, event, ended.anchor)
        elif kind == "AliasEvent":
            if event.anchor not in self._anchors:
                raise BadSyntax(
                    f"*{event.anchor} refers to nothing before it", where=_line(event.start_mark)
                )
            self._put(self._anchors[event.anchor], event, None)
        elif kind == "DocumentStartEvent":
            self._anchors = {}

    def _begin(self, event: Any, made: list[Any] | Fields) -> None:
        self._refuse_tag(event)
        if isinstance(made, Fields):
            made.line = event.start_mark.line + 1
        if len(self._open) >= DEPTH:
            raise BadSyntax("nested too deep", where=_line(event.start_mark), valid=_LEVELS)
        self._open.append(_OpenNode(made, event.anchor, []))

    def _take_scalar(self, event: Any) -> None:
        factor = self._factors.get(str(event.tag))
        if factor is None:
            self._refuse_tag(event)
        parent = self._open[-1] if self._open else None
        if parent is not None and isinstance(parent.made, Fields) and not parent.key:
            if event.value in parent.made:
                raise DuplicateName(
                    f"key {event.value!r:.60} is there twice", where=_line(event.start_mark)
                )
            parent.key.append(event.value)
        else:
            value = _plain(event.value) if event.implicit[0] or factor else event.value
            if factor is not None and isinstance(value, int | float):
                value *= factor
            self._put(value, event, event.anchor)

    def _put(self, value: Any, event: Any, anchor: str | None) -> None:
        if anchor is not None:
            self._anchors[anchor] = value
        if not self._open:
            self.documents.append(value)
            return
        parent = self._open[-1]
        if isinstance(parent.made, list):
            parent.made.append(value)
        elif parent.key:
            parent.made[parent.key.pop()] = value
        else:
            raise BadSyntax("a key is not plain text", where=_line(event.start_mark))

    def _refuse_tag(self, event: Any) -> None:
        if event.tag is not None:
            raise BadSyntax(
                f"the tag {str(event.tag)!r:.60} makes something else than plain data",
                where=_line(event.start_mark),
                valid="lists, mappings, numbers and text",
            )


def told(value: object) -> str:
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


def _line(mark: Any) -> str:
    return "" if mark is None else f"line {mark.line + 1}"


def _end_of_space(text: str, begin: int) -> int:
    found = re.compile(r"\s*").match(text, begin)
    return found.end() if found else begin


_LEVELS = f"{DEPTH} levels or fewer"


def _refuse_long(data: bytes, most: int) -> None:
    if len(data) > most:
        raise BadSyntax(
            f"the file has more than {most:,} bytes", valid="a longer trajectory goes as CSV"
        )


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadSyntax(f"byte {error.start} is not UTF-8 text") from None


def _refuse_deep_brackets(data: bytes) -> None:
    """Both parsers take time or stack by the depth of brackets before a level is seen; text counts too."""
    letters = np.frombuffer(data, dtype=np.uint8)
    opens = np.isin(letters, list(b"[{")).astype(np.int64)
    depth = np.cumsum(opens - np.isin(letters, list(b"]}")))
    if len(depth) and (depth - np.minimum.accumulate(np.minimum(depth, 0))).max() > 2 * DEPTH:
        raise BadSyntax("brackets are nested too deep", valid=_LEVELS)
