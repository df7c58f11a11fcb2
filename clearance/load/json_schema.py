"""The case file's schema as JSON Schema, so that editors complete keys and mark faults while one writes.

Made from `schema`, with what its validators take beside the plain types. Not for: checking (`schema_errors`).
"""

from __future__ import annotations

from typing import Any

from clearance.load import schema
from clearance.world.notice import KINDS

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def case_schema() -> dict[str, Any]:
    """The JSON Schema of a case file."""
    made = schema.Case.model_json_schema()
    parts, keys = made["$defs"], made["properties"]
    keys["scene"] = _or_path(keys["scene"], "a YAML file with the scene")
    keys["trajectory"] = _or_path(keys["trajectory"], "the trajectory's CSV file")
    keys["accept"]["items"]["enum"] = list(KINDS)
    factors = parts["Mesh"]["properties"]["scale"]
    parts["Mesh"]["properties"]["scale"] = {"anyOf": [{"type": "number"}, factors], "default": 1.0}
    parts["Obstacle"]["oneOf"] = [{"required": [shape]} for shape in schema.SHAPES]
    parts["Pose"]["not"] = {"required": ["quat_xyzw", "rpy"]}
    _without_titles(made)
    return {"$schema": _DIALECT, "title": "clearance case file", **made}


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
