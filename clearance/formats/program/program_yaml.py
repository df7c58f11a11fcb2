"""A robot program in YAML. Not for: what it asks of a robot (`case.program`)."""

from __future__ import annotations

from clearance.errors import BadProgram
from clearance.formats.program.controller_program import ProgramRequest
from clearance.formats.schema.program import Program
from clearance.formats.schema.strict_model import validated
from clearance.plain_yaml import parse_yaml


def read_yaml_program(asked: ProgramRequest) -> Program:
    """The program in the content of a file.

    Raises:
        BadInput: with the file and the field.
    """
    others = sorted(asked.asked.model_fields_set - {"file"})
    if others:
        raise BadProgram(
            "it is for the language of a controller", where=others[0], valid="no such key"
        )
    return validated(Program, parse_yaml(asked.data, asked.shown), asked.shown)
