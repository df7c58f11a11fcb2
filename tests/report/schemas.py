"""What a printed JSON Schema objects to."""

from __future__ import annotations

import contextlib
import io
import json
from typing import Any

import pytest

from clearance.cli import run


def printed_schema(*options: str) -> tuple[dict[str, Any], Any]:
    """What `clearance schema` prints, and what asks whether something keeps to it."""
    jsonschema = pytest.importorskip("jsonschema")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert run(["schema", *options]) == 0
    schema = json.loads(out.getvalue())
    jsonschema.Draft202012Validator.check_schema(schema)
    return schema, jsonschema.Draft202012Validator(schema)


def objections(results: str, told: dict[str, Any]) -> list[str]:
    """What the schema of a result file says of its content, as written."""
    schema, validator = printed_schema("--results", results)
    assert told["$schema"] == schema["$id"]
    lacking = [
        key
        for key in told
        if not [*validator.iter_errors({k: v for k, v in told.items() if k != key})]
    ]
    return [*lacking, *(error.message for error in validator.iter_errors(told))]
