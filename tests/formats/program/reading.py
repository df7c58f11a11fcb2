"""Programs of controllers as their readers have them, from text."""

from __future__ import annotations

from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.program.controller_program import ControllerProgram, ProgramRequest
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated


def read(name: str, text: str | bytes, beside=(), **asked) -> ControllerProgram:
    """The program in a file of a name."""
    data = text.encode() if isinstance(text, str) else text
    given = validated(ProgramFile, {"file": name, **asked}, "program")
    row = format_of(Kind.PROGRAM, name, data)
    return function_at(row.read)(ProgramRequest(data, name, given, dict(beside)))
