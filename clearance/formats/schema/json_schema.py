"""The case file's schema as JSON Schema, so that editors complete keys and mark faults while one writes.

Made from `case`, with what its validators take beside the plain types. Not for: checking (`strict_model`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from clearance.formats.known_formats import Kind, names_of
from clearance.formats.schema import case as schema
from clearance.formats.schema.obstacle import SHAPES
from clearance.formats.schema.tolerance import CONTROLLERS, ERRORS, preset_names
from clearance.world.notice import CODES_OF_KINDS, KINDS, WARNINGS

_NAMES_OF_STATES = {
    "description": "a state of the SRDF, or of the MJCF without one; or several",
    "anyOf": [
        {"type": "number"},
        {"type": "string", "minLength": 1},
        {"type": "array", "items": {"type": "string", "minLength": 1}, "minItems": 1},
    ],
}

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def case_schema() -> dict[str, Any]:
    """The JSON Schema of a case file."""
    made = schema.Case.model_json_schema()
    parts, keys = made["$defs"], made["properties"]
    for part in (made, *parts.values()):
        _without_nothing(part.get("properties", {}))
    keys["scene"] = _or_path(keys["scene"], f"a file with the scene ({names_of(Kind.SCENE)})")
    keys["accept"]["items"]["enum"] = [*KINDS, *WARNINGS, *CODES_OF_KINDS]
    made["oneOf"] = [{"required": ["robot"]}, {"required": ["robots"]}]
    made["anyOf"] = list(_what_moves())
    factors = parts["Mesh"]["properties"]["scale"]
    parts["Mesh"]["properties"]["scale"] = {"anyOf": [{"type": "number"}, factors], "default": 1.0}
    _edit_obstacle(parts["Obstacle"])
    parts["Robot"]["properties"]["joints"]["properties"] = {schema.STATE: _NAMES_OF_STATES}
    parts["Rule"]["anyOf"] = [{"required": ["fail"]}, {"required": ["warn"]}]
    for pose in ("Pose", "Base"):
        parts[pose]["not"] = {"required": ["quat_xyzw", "rpy"]}
    parts["PoseFile"] = _or_path(parts["PoseFile"], f"a file with poses ({names_of(Kind.POSES)})")
    names = {"type": "array", "items": {"type": "string", "minLength": 1}, "minItems": 1}
    motion = parts["TrajectoryFile"]
    motion["properties"]["columns"] = {"anyOf": [motion["properties"]["columns"], names]}
    del motion["required"]
    motion["oneOf"] = [{"required": ["file"]}, {"required": ["program"]}]
    what = f"a file with the motion ({names_of(Kind.TRAJECTORY)})"
    parts["TrajectoryFile"] = _or_path(motion, what)
    parts["Tracking"] = {"anyOf": [{"const": CONTROLLERS}, parts["Tracking"]]}
    pair = parts["AllowedPair"]
    parts["AllowedPair"] = {"anyOf": [pair["properties"]["between"], pair]}
    parts["Clock"] = {"anyOf": [{"enum": list(schema.CLOCKS)}, parts["Clock"]]}
    keys["clock"]["default"] = "common"
    parts["Tolerance"]["anyOf"] = [{"required": [key]} for key in ERRORS]
    parts["Tolerance"]["properties"]["presets"]["items"]["enum"] = list(preset_names())
    _without_titles(made)
    return {"$schema": _DIALECT, "title": "clearance case file", **made}


def _what_moves() -> Iterator[dict[str, Any]]:
    """Where a case can say that something moves; a scene in a file of its own may."""
    moves = {"required": ["trajectory"]}
    yield moves
    yield {"properties": {"robot": moves}, "required": ["robot"]}
    yield {"properties": {"robots": {"contains": moves}}, "required": ["robots"]}
    obstacle = {"properties": {"obstacles": {"contains": {"required": ["moves"]}}}}
    yield {"properties": {"scene": obstacle}}


def _edit_obstacle(part: dict[str, Any]) -> None:
    part["oneOf"] = [{"required": [shape]} for shape in SHAPES]
    part["anyOf"] = [
        {"not": {"required": [key]}} if key != "on" else {"required": [key]}
        for key in ("moves", "pose", "on")
    ]


def _without_nothing(properties: dict[str, Any]) -> None:
    """Takes out that a key may have nothing behind it, which is refused."""
    for given in properties.values():
        if given.get("default", ...) is None:
            del given["default"]
            kinds = [kind for kind in given.pop("anyOf") if kind != {"type": "null"}]
            given.update(kinds[0] if len(kinds) == 1 else {"anyOf": kinds})


def _or_path(mapping: dict[str, Any], what: str) -> dict[str, Any]:
    path = {
        "type": "string",
        "minLength": 1,
        "description": f"path of {what}, relative to this file",
    }
    return {"anyOf": [mapping, path]}


def _without_titles(part: Any) -> None:
    """Takes out the titles that repeat each key's name."""
    if isinstance(part, list):
        for item in part:
            _without_titles(item)
    elif isinstance(part, dict):
        if isinstance(part.get("title"), str):
            del part["title"]
        for item in part.values():
            _without_titles(item)
