"""A robot program in YAML. Not for: what it asks of a robot (`case.program`)."""

from __future__ import annotations

from clearance.formats.schema.program import Program
from clearance.formats.schema.strict_model import validated
from clearance.plain_yaml import parse_yaml


def read_yaml_program(data: bytes, shown: str) -> Program:
    """The program in the content of a file.

    Raises:
        BadInput: with the file and the field.
    """
    return validated(Program, parse_yaml(data, shown), shown)
