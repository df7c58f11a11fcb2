"""What a case gives for a program beside its file: that the program uses it. One check for all languages.

Not for: what the program does with it (each language), and what it lacks (`remarks`).
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from clearance.errors import BadProgram, ClearanceError
from clearance.formats.program.controller_program import (
    ControllerMove,
    ControllerProgram,
    ProgramRequest,
    digits_of,
)

_WORD = re.compile(r"[$A-Za-z_]\w*(?:\[\d+\])?")

NAMED = ("tools", "frames", "units", "zones", "variables")
"""Keys of a case that give values by name."""


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
    moves = list(program.moves)
    for i, one in enumerate(moves):
        if isinstance(one, ControllerMove) and not one.uses_tool:
            moves[i] = replace(one, tool=np.eye(4))
    return digits_of(*moves)
