"""What a printed JSON Schema objects to in a result."""

from __future__ import annotations

import json
from typing import Any

import pytest

from clearance.cli.commands import made_schema


def objections(results: str, told: dict[str, Any]) -> list[str]:
    """What the schema of a result file says of its content, as written."""
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(json.dumps(made_schema(results)))
    jsonschema.Draft202012Validator.check_schema(schema)
    assert told["$schema"] == schema["$id"]
    validator = jsonschema.Draft202012Validator(schema)
    lacking = [
        key
        for key in told
        if not [*validator.iter_errors({k: v for k, v in told.items() if k != key})]
    ]
    return [*lacking, *(error.message for error in validator.iter_errors(told))]
