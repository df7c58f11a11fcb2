"""YAML text to plain data (YAML 1.2: `1e-3` is a number, `no` is text), in time and memory that follow its length.

What an alias repeats is counted wherever it is met, before anything is made of it: eight lines can otherwise ask
for 10^8 values. Not for: which keys are valid, nor messages as ROS prints them (`formats.message.documents`).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from clearance.errors import BadSyntax, DuplicateName

if TYPE_CHECKING:
    from ruamel.yaml import YAML
    from ruamel.yaml.nodes import Node

MOST_REPEATED = 100_000
"""Values that a file may have beyond one for each of its bytes, aliases followed."""


def plain_data(data: bytes) -> object:
    """The plain data in a YAML file of one document.

    Raises:
        BadSyntax: not YAML, not UTF-8, more than one document, or aliases that repeat too much; with the line.
        DuplicateName: a key twice in a mapping.
    """
    from ruamel.yaml.constructor import DuplicateKeyError

    text = _text(data)
    try:
        if "*" in text:
            _refuse_repetition(_reader().compose(text), len(text))
        return _reader().load(text)
    except BadSyntax:
        raise
    except DuplicateKeyError as error:
        problem = (error.problem or "a key twice").split(" with value")[0]
        raise DuplicateName(problem, where=_line(error), valid="each key once") from None
    except RecursionError:
        raise BadSyntax("not YAML: too deeply nested") from None
    except Exception as error:  # whatever a parser that is not ours dies of, the file brought it
        problem = getattr(error, "problem", None) or str(error) or type(error).__name__
        raise BadSyntax(f"not YAML: {problem}", where=_line(error)) from None


def _reader() -> YAML:
    """A reader of plain data; a day that does not exist stays the text that it is, for who knows its field."""
    from ruamel.yaml import YAML

    reader = YAML(typ="safe", pure=True)
    reader.Constructor = _constructor()
    return reader


@cache
def _constructor() -> type:
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


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadSyntax(
            f"byte {error.start} is not UTF-8 text", valid="a YAML file is needed"
        ) from None


def _refuse_repetition(root: Node | None, n_letters: int) -> None:
    """Nothing, if what the aliases repeat is not much more than the file, and none holds itself."""
    most = MOST_REPEATED + n_letters
    sizes: dict[int, int] = {}
    begun: set[int] = set()
    pending = [] if root is None else [(root, False)]
    while pending:
        node, has_sizes = pending.pop()
        if has_sizes:
            sizes[id(node)] = 1 + sum(sizes[id(part)] for part in _parts(node))
            if sizes[id(node)] > most:
                raise _at(node, "the aliases repeat too much", f"{most:,} values at most")
        elif id(node) not in sizes:
            if id(node) in begun:
                raise _at(node, "an alias stands in what it repeats", "plain lists and mappings")
            begun.add(id(node))
            pending += [(node, True), *((part, False) for part in _parts(node))]


def _parts(node: Node) -> list[Node]:
    """What a list or mapping holds, keys and values alike."""
    if not isinstance(node.value, list):
        return []
    return [part for one in node.value for part in (one if isinstance(one, tuple) else (one,))]


def _at(node: Node, problem: str, valid: str) -> BadSyntax:
    return BadSyntax(problem, where=f"line {node.start_mark.line + 1}", valid=valid)


def _line(error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    return "" if mark is None else f"line {mark.line + 1}"
