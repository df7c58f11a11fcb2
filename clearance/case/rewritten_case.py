"""A case file written anew for another folder: paths as seen from there, some values changed, comments kept.

Not for: which values change (room `gains`).
"""

from __future__ import annotations

import copy
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from clearance.errors import BadInput
from clearance.formats.files.brought import is_brought
from clearance.formats.files.input_files import path_from
from clearance.plain_yaml import parse_yaml

Node = dict[str, Any]
"""A mapping of a case file, plain or with its comments."""

WIDE = 10_000
"""Columns of a line: none is broken."""


def rewritten_case(
    data: bytes, case_file: Path, folder: Path, change: Callable[[Node], None]
) -> bytes:
    """The content of a case file that says the same in `folder`, but for what `change` does to it.

    Comments stay, unless the file shares parts of itself in a way that would carry a change where it is not meant;
    then all is written out plainly.

    Args:
        case_file: where `data` is from. folder: need not be there.
        change: sets values in the file's mapping, whose paths are of `folder` already.
    """
    plain = copy_of(parse_yaml(data, case_file.name))
    if not isinstance(plain, dict):
        raise BadInput("it is no mapping", where=case_file.name, valid="a case file")
    _move(plain, case_file.parent, folder)
    change(plain)
    text = _with_comments(data, case_file.parent, folder, change)
    if text is None or parse_yaml(text, case_file.name) != plain:
        text = _dumped(plain)
    return text


def copy_of(value: Any) -> Any:
    """The plain data again, each mapping and list once for each place that it stands at."""
    if isinstance(value, dict):
        return {key: copy_of(one) for key, one in value.items()}
    return [copy_of(one) for one in value] if isinstance(value, list) else value


def robots_of(case: Node) -> list[Node]:
    """The robots of a case file in its order."""
    return [case["robot"]] if "robot" in case else case["robots"]


def robot_node(case: Node, i_robot: int) -> tuple[Node, Node]:
    """A robot of a case file, and the mapping that its `trajectory` stands in."""
    robot = robots_of(case)[i_robot]
    return robot, case if "trajectory" in case else robot


def _with_comments(
    data: bytes, from_folder: Path, folder: Path, change: Callable[[Node], None]
) -> bytes | None:
    """The same by way of a reader that keeps comments; None where that cannot read or write it."""
    from ruamel.yaml.error import YAMLError

    try:
        node = _round_trip().load(data.decode("utf-8-sig"))
        _move(node, from_folder, folder)
        change(node)
        return _dumped(node)
    except (YAMLError, ValueError, TypeError, AttributeError, RecursionError):
        return None


def _dumped(node: Any) -> bytes:
    text = io.StringIO()
    _round_trip().dump(copy.copy(node), text)
    return text.getvalue().encode()


def _round_trip() -> Any:
    from ruamel.yaml import YAML

    made = YAML()
    made.preserve_quotes = True
    made.width = WIDE
    made.default_flow_style = None  # what is new and holds plain values only is on one line
    made.allow_unicode = True
    return made


def _move(case: Node, from_folder: Path, folder: Path) -> None:
    """Writes every path of a case file as seen from another folder."""

    def moved(given: str) -> str:
        return given if is_brought(given) else path_from(folder, from_folder / given)

    done = set[tuple[int, object]]()
    for holder, key in _paths(case):
        if (id(holder), key) not in done:
            done.add((id(holder), key))
            holder[key] = moved(str(holder[key]))


def _paths(case: Node) -> Iterator[tuple[Any, Any]]:
    """Where each path of a case file stands: a mapping or list, and the key or place in it."""
    for robot in robots_of(case):
        yield from _texts(robot, "urdf", "srdf", "joint_limits", "controllers", "trajectory")
        yield from ((robot["package_dirs"], i) for i in range(len(robot.get("package_dirs", ()))))
    yield from _texts(case, "trajectory", "scene")
    if isinstance(case["scene"], dict):
        for obstacle in case["scene"]["obstacles"]:
            yield from _texts(obstacle, "mesh", "points", "moves")
    for profile in case.get("profiles", ()):
        yield from _texts(profile, "sketch")
    yield from ((case["waivers"], i) for i in range(len(case.get("waivers", ()))))


def _texts(node: Node, *keys: str) -> Iterator[tuple[Any, Any]]:
    """The paths under some keys, which stand there alone or as the `file` of a mapping."""
    for key in keys:
        value = node.get(key)
        if isinstance(value, str):
            yield node, key
        elif isinstance(value, dict):
            yield from (
                (value, name) for name in ("file", "program") if isinstance(value.get(name), str)
            )
            if isinstance(program := value.get("program"), dict) and "file" in program:
                yield program, "file"
                yield from ((program["beside"], i) for i in range(len(program.get("beside", ()))))
