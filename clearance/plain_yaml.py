"""YAML text to plain data, in time and memory that follow its length: the one reader of YAML.

It is read event by event. An alias means the very same data, and what it repeats is counted before anything is
made of it: eight lines can otherwise ask for 10^8 values. `plain_data` reads our own files (YAML 1.2: `1e-3` is a
number, `no` is text); `events_to_data` takes other rules of what a value is, as for messages of ROS
(`formats.message.documents`). Not for: which keys are valid.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from clearance.errors import BadSyntax, ClearanceError, DuplicateName, MissingFile, at

MOST_REPEATED = 100_000
"""Values that a file may have beyond one for each of its bytes, aliases followed."""

DEEPEST = 100
"""Levels of lists and mappings in a file of ours."""

_MERGED = object()
"""The key `<<`, under which a mapping takes what others have."""

_CORE = "tag:yaml.org,2002:"
_NUMBERS = (f"{_CORE}int", f"{_CORE}float")
_PLAIN = (f"{_CORE}map", f"{_CORE}seq")


def plain_data(data: bytes) -> object:
    """The plain data in a YAML file of one document.

    Raises:
        BadSyntax: not YAML, not UTF-8, more than one document, or aliases that repeat too much; with the line.
        DuplicateName: a key twice in a mapping.
    """
    text = text_of(data, "a YAML file is needed")
    documents = events_to_data(text, PlainValues(MOST_REPEATED + len(text)))
    if len(documents) > 1:
        raise BadSyntax("not YAML: there is another document", valid="one document")
    return documents[0] if documents else None


def parse_yaml(data: bytes, shown: str) -> object:
    """The same; `shown` is the file's name in errors."""
    with at(shown):
        return plain_data(data)


def yaml_file(path: Path, valid: str) -> object:
    """The plain data in a file; `valid` is what such a file would be.

    Raises:
        MissingFile, and what `plain_data` raises, without the file's name.
    """
    if path.exists() and not path.is_file():  # a pipe or a device may never end
        raise MissingFile("is not a file on disk", valid=valid)
    try:
        return plain_data(path.read_bytes())
    except FileNotFoundError:
        raise MissingFile("no such file", valid=valid) from None
    except OSError as fault:
        raise MissingFile(f"cannot be read ({fault.strerror or fault})", valid=valid) from None


def text_of(data: bytes, valid: str = "") -> str:
    """The text in a file.

    Raises:
        BadSyntax: it is not UTF-8.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadSyntax(f"byte {error.start} is not UTF-8 text", valid=valid) from None


def events_to_data(text: str, values: PlainValues) -> list[Any]:
    """The documents of a YAML text.

    Args:
        values: what becomes of its scalars.

    Raises:
        BadSyntax, DuplicateName: with the line.
    """
    builder = _Builder(values)
    with _as_ours():
        for event in values.reader.parse(text):
            builder.take(event)
    return builder.documents


@contextmanager
def _as_ours() -> Iterator[None]:
    """Whatever a parser that is not ours dies of, the file brought it."""
    try:
        yield
    except ClearanceError:
        raise
    except Exception as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or str(error) or type(error).__name__
        raise BadSyntax(f"not YAML: {problem}", where=_line(mark)) from None


class PlainValues:
    """Numbers, truths, days and text as YAML 1.2 has them.

    Args:
        most: values that a list or mapping may hold, aliases followed. deepest: levels of them.
    """

    def __init__(self, most: float, deepest: int = DEEPEST) -> None:
        from ruamel.yaml import YAML
        from ruamel.yaml.nodes import ScalarNode

        self.most, self.deepest = most, deepest
        self.reader = YAML(typ="safe", pure=True)
        self.reader.Constructor = _constructor()
        self._node = ScalarNode
        self._known: dict[tuple[Any, ...], Any] = {}

    def value(self, event: Any) -> Any:
        """What a scalar means."""
        asked = event.value, event.implicit, event.tag
        if asked not in self._known:
            self._known[asked] = self._new(event)
        return self._known[asked]

    def _new(self, event: Any) -> Any:
        tag = event.tag
        if tag is not None and tag != "!" and not str(tag).startswith(_CORE):
            raise not_plain(event)
        if tag is None or tag == "!":
            tag = self.reader.resolver.resolve(self._node, event.value, event.implicit)
            if "_" in event.value and tag in _NUMBERS:  # which YAML 1.1 has, and 1.2 has not
                tag = f"{_CORE}str"
        node = self._node(tag, event.value, event.start_mark, event.end_mark, style=event.style)
        return self.reader.constructor.construct_non_recursive_object(node)

    def key(self, event: Any) -> Any:
        """What a scalar means as a key."""
        is_merge = event.value == "<<" and event.implicit[0] and event.tag is None
        return _MERGED if is_merge else self.value(event)

    def mapping(self, event: Any) -> dict[Any, Any]:
        """An empty mapping that begins here."""
        return {}


class _OpenNode:
    """A list or mapping that has not ended, and how many values it has so far, aliases followed."""

    def __init__(self, made: list[Any] | dict[Any, Any], event: Any) -> None:
        self.made, self.anchor, self.mark = made, event.anchor, event.start_mark
        self.key: list[Any] = []
        self.merged: list[dict[Any, Any]] = []
        self.n_values = 1


class _Anchored(NamedTuple):
    value: Any
    n_values: int


class _Builder:
    """Takes the events of a YAML parser one by one."""

    def __init__(self, values: PlainValues) -> None:
        self._values = values
        self.documents: list[Any] = []
        self._open: list[_OpenNode] = []
        self._anchors: dict[str, _Anchored] = {}

    def take(self, event: Any) -> None:
        """Adds what an event says.

        Raises:
            BadSyntax, DuplicateName: with the line.
        """
        kind = type(event).__name__
        if kind == "ScalarEvent":
            is_key = self._waits_for_key()
            value = self._values.key(event) if is_key else self._values.value(event)
            self._put(_Anchored(value, 1), event.start_mark, event.anchor)
        elif kind == "MappingStartEvent":
            self._begin(event, self._values.mapping(event))
        elif kind == "SequenceStartEvent":
            self._begin(event, [])
        elif kind in ("MappingEndEvent", "SequenceEndEvent"):
            self._end()
        elif kind == "AliasEvent":
            self._put(self._repeated(event), event.start_mark, None)
        elif kind == "DocumentStartEvent":
            self._anchors = {}

    def _waits_for_key(self) -> bool:
        return bool(self._open) and isinstance(self._open[-1].made, dict) and not self._open[-1].key

    def _begin(self, event: Any, made: list[Any] | dict[Any, Any]) -> None:
        if event.tag is not None and event.tag not in _PLAIN:
            raise not_plain(event)
        if len(self._open) >= self._values.deepest:
            levels = f"{self._values.deepest} levels or fewer"
            raise BadSyntax("nested too deep", where=_line(event.start_mark), valid=levels)
        self._open.append(_OpenNode(made, event))

    def _end(self) -> None:
        ended = self._open.pop()
        if ended.n_values > self._values.most:
            raise BadSyntax(
                "the aliases repeat too much",
                where=_line(ended.mark),
                valid=f"{self._values.most:,} values at most",
            )
        made = ended.made
        if ended.merged and isinstance(made, dict):
            own, made = made, {}
            for other in (*reversed(ended.merged), own):
                made |= other
        self._put(_Anchored(made, ended.n_values), ended.mark, ended.anchor)

    def _repeated(self, event: Any) -> _Anchored:
        """What an alias means."""
        if any(node.anchor == event.anchor for node in self._open):
            raise BadSyntax(
                "an alias stands in what it repeats",
                where=_line(event.start_mark),
                valid="plain lists and mappings",
            )
        if event.anchor not in self._anchors:
            raise BadSyntax(
                f"*{event.anchor} refers to nothing before it", where=_line(event.start_mark)
            )
        return self._anchors[event.anchor]

    def _put(self, part: _Anchored, mark: Any, anchor: str | None) -> None:
        if anchor is not None:
            self._anchors[anchor] = part
        if not self._open:
            self.documents.append(part.value)
            return
        parent = self._open[-1]
        parent.n_values += part.n_values
        if isinstance(parent.made, list):
            parent.made.append(part.value)
        elif not parent.key:
            self._put_key(parent, part.value, mark)
        elif (key := parent.key.pop()) is _MERGED:
            parent.merged += _mappings(part.value, mark)
        else:
            parent.made[key] = part.value

    def _put_key(self, parent: _OpenNode, key: Any, mark: Any) -> None:
        if isinstance(key, list | dict):
            raise BadSyntax("a key is not plain text", where=_line(mark))
        if key in parent.made or (key is _MERGED and parent.merged):
            shown = "<<" if key is _MERGED else f"{key!r:.60}"
            raise DuplicateName(
                f"key {shown} is there twice", where=_line(mark), valid="each key once"
            )
        parent.key.append(key)


def _mappings(value: Any, mark: Any) -> list[dict[Any, Any]]:
    """What stands under `<<`: the first goes before the others."""
    given = value if isinstance(value, list) else [value]
    if not all(isinstance(one, dict) for one in given):
        raise BadSyntax("<< is not a mapping, or a list of them", where=_line(mark))
    return given


def not_plain(event: Any) -> BadSyntax:
    """The error for a tag that asks for something else than plain data."""
    return BadSyntax(
        f"the tag {str(event.tag)!r:.60} makes something else than plain data",
        where=_line(event.start_mark),
        valid="lists, mappings, numbers and text",
    )


@cache
def _constructor() -> type:
    """Makes scalars; a day that does not exist stays the text that it is, for who knows its field."""
    from ruamel.yaml.constructor import SafeConstructor

    class Constructor(SafeConstructor):
        pass

    def day_or_text(constructor: SafeConstructor, node: Any) -> object:
        try:
            return constructor.construct_yaml_timestamp(node)
        except ValueError:
            return constructor.construct_scalar(node)

    Constructor.add_constructor("tag:yaml.org,2002:timestamp", day_or_text)
    return Constructor


def _line(mark: Any) -> str:
    return "" if mark is None else f"line {mark.line + 1}"
