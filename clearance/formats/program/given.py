"""What a case gives for a program beside its file: what is lacking, and that the program uses the rest. One check
for all languages.

Not for: what the program does with it (each language).
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from clearance.errors import BadProgram, ClearanceError, MissingKey
from clearance.formats.program.controller_program import (
    ControllerMove,
    ControllerProgram,
    ProgramRequest,
    digits_of,
)
from clearance.formats.schema.pose import Pose
from clearance.formats.schema.program_file import ProgramFile

_WORD = re.compile(r"[$A-Za-z_]\w*(?:\[\d+\])?")

NAMED = ("tools", "frames", "units", "zones")
"""Keys of a case that give values by name."""


MOST_LACKING = 20
"""Values by name that an error asks for at once."""


def not_in_files(fault: str, key: str, name: str, before: str = "", more: str = "") -> MissingKey:
    """The error for a value by name that no file of a program has.

    Args:
        key: of the program, one of `NAMED`. before, more: beside what the program may have.
    """
    unit = ", the radius of such corners [m]" if key == "zones" else " in m and rad"
    valid = f"{before}program: {{{_written([(key, name)])}}}{unit}{more}"
    error = MissingKey(fault, valid=valid)
    error.lacks = key, name
    return error


def read_whole(
    read: Callable[[ProgramRequest], ControllerProgram], request: ProgramRequest
) -> ControllerProgram:
    """The program that a reader makes of a request; where values by name are lacking, the error has all of them.

    Raises:
        BadInput: as the reader.
    """
    lacking: dict[tuple[str, str], MissingKey] = {}
    while len(lacking) < MOST_LACKING:
        try:
            found = read(replace(request, asked=_with_any(request.asked, lacking)))
        except MissingKey as error:
            if error.lacks is None or error.lacks in lacking:
                break
            lacking[error.lacks] = error
        except ClearanceError:
            break
        else:
            if not lacking:
                return found
            break
    if not lacking:
        return read(request)
    first = next(iter(lacking.values()))
    if len(lacking) > 1:
        first.valid = f"program: {{{_written(lacking)}}} in m and rad"
    raise first


def _with_any(asked: ProgramFile, lacking: Iterable[tuple[str, str]]) -> ProgramFile:
    """What a case gives, and any value of what is lacking."""
    found = asked
    for key, name in lacking:
        value = 0.05 if key == "zones" else Pose(xyz=[0.0, 0.0, 0.0])
        found = found.model_copy(update={key: {**getattr(found, key), name: value}})
    return found


def _written(lacking: Iterable[tuple[str, str]]) -> str:
    """The keys of values by name, as a case has them."""
    parts = dict[str, list[str]]()
    for key, name in lacking:
        shown = f'"{name}"' if "[" in name else name
        value = "0.05" if key == "zones" else "{xyz: […], rpy: […]}"
        parts.setdefault(key, []).append(f"{shown}: {value}")
    return ", ".join(f"{key}: {{{', '.join(own)}}}" for key, own in parts.items())


def require_used(
    request: ProgramRequest,
    read: Callable[[ProgramRequest], ControllerProgram],
    found: ControllerProgram,
) -> None:
    """Nothing, if a program changes without each of the values by name that its case gives, and has each word that
    the case skips.

    Args:
        read: the reader that made it from the request.

    Raises:
        BadProgram: one that changes nothing, with the nearest name that the files have.
    """
    words = [*_words(request)]
    known = {word.lower() for word in words}
    for name in request.asked.skip:
        if not {part.lower() for part in re.findall(r"\w+", name)} <= known:
            raise BadProgram(
                f"{name!r} is in no file of it", where="skip", valid=_nearest(name, words)
            )
    for key in NAMED:
        given = getattr(request.asked, key)
        for name in given:
            rest = {other: given[other] for other in given if other != name}
            asked = request.asked.model_copy(update={key: rest})
            try:
                without = read(replace(request, asked=asked))
            except ClearanceError:
                continue
            if _plain(without) == _plain(found):
                fault = "it changes no move: the program does not use it, or says it itself"
                raise BadProgram(fault, where=f"{key}.{name}", valid=_nearest(name, words))


def _words(request: ProgramRequest) -> Iterator[str]:
    for data in (request.data, *request.beside.values()):
        for word in _WORD.findall(data.decode("utf-8", "replace")):
            yield from (word, word.partition("[")[0])


def _nearest(name: str, words: list[str]) -> str:
    """The word of the files that is nearest to a name, if one is near; else that the name has to go."""
    near = [] if name in words else difflib.get_close_matches(name, words, 1, 0.75)
    return f"did you mean {near[0]!r}?" if near else "without it"


def _plain(program: ControllerProgram) -> str:
    """The moves to their last digit, without the tools that do not matter to them."""
    moves = (
        replace(one, tool=np.eye(4))
        if isinstance(one, ControllerMove) and not one.uses_tool
        else one
        for one in program.moves
    )
    return digits_of(*moves)
