"""Programs of controllers as their readers have them, from text."""

from __future__ import annotations

from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.program.controller_program import ControllerProgram, ProgramRequest
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated


def reader_and_request(name: str, text: str | bytes, beside=(), **asked):
    """The reader of a file of a name, and what it gets."""
    data = text.encode() if isinstance(text, str) else text
    given = validated(ProgramFile, {"file": name, **asked}, "program")
    row = format_of(Kind.PROGRAM, name, data)
    return function_at(row.read), ProgramRequest(data, name, given, dict(beside))


def read(name: str, text: str | bytes, beside=(), **asked) -> ControllerProgram:
    """The program in a file of a name."""
    reader, request = reader_and_request(name, text, beside, **asked)
    return reader(request)
