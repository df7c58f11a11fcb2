"""What a case gives for a program beside its file: that the program uses it. One check for all languages.

Not for: what the program does with it (each language), and what it lacks (`remarks`).
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from clearance.errors import BadProgram, ClearanceError
from clearance.formats.program.controller_program import (
    ControllerMove,
    ControllerProgram,
    ProgramRequest,
    digits_of,
)
from clearance.formats.program.fanuc_words import named

_WORD = re.compile(r"[$A-Za-z_]\w*(?:\[\d+\])?")

_AT_START, _UNTIL_SET = "at the start", "until these files change it"
_ALWAYS = "all the time, unless a wait needs another"

KINDS: Mapping[str, tuple[str, str]] = {
    **dict.fromkeys(("R[", "UFRAME_NUM", "UTOOL_NUM"), ("0", _AT_START)),
    **dict.fromkeys(("DI[", "RI[", "UI[", "SI[", "$IN[", "$TIMER_FLAG["), ("true", _ALWAYS)),
    **dict.fromkeys(("GI[", "AI[", "$ANIN["), ("0", _ALWAYS)),
    **dict.fromkeys(("DO[", "RO[", "F[", "$OUT[", "$FLAG["), ("true", _UNTIL_SET)),
    **dict.fromkeys(("GO[", "AO["), ("0", _UNTIL_SET)),
}
"""A value of each register, input, output and flag, and how long one of the case holds."""

NAMED = ("tools", "frames", "units", "zones", "variables")
"""Keys of a case that give values by name."""


def kind_of(name: str) -> tuple[str, str]:
    """A value as a variable has it, and how long one of the case holds."""
    return KINDS.get(re.sub(r"(?<=\[)\d+\]$", "", name), ("…", _UNTIL_SET))


def remedy(name: str) -> str:
    """The key of a case that gives a variable, and what it means."""
    value, holds = kind_of(name)
    return f'program: {{variables: {{"{name}": {value}}}}}, if it holds that {holds}'


def give(run: Any, name: str, value: Any) -> None:
    """Gives a variable of a run the value that the case says.

    Raises:
        BadProgram: another value than its kind has; a line may set it by a number that is not read.
    """
    where, (usual, _) = f"variables: {name}", kind_of(name)
    if usual != "…" and isinstance(value, bool) != (usual == "true"):
        raise BadProgram(
            f"{value} is given",
            where=where,
            valid="true or false" if usual == "true" else "a number",
        )
    root, indexed, _ = name.partition("[")
    same = {"DO": "GO", "GO": "DO"}.get(root)
    for changed, line in run.effects.changed_in([one.body for one in run.routines.values()]):
        is_one = re.fullmatch(r"[^[]*\[\d+\]", changed)
        if indexed and changed.partition("[")[0] == root and not is_one:
            fault = f"{root} at {line} may set it by a number that is not read"
            raise BadProgram(fault, where=where, valid="a number in that line")
        if indexed and changed.partition("[")[0] == same:
            text = f"{name} of the case is taken to be none of the outputs that {changed} sets"
            run.doubts[f"{line}: {text}"] = None
    run.variables[name] = value
    run.given.add(name)
    run.persistent.put(name, f"{name} of the case decides{_lasting(name)}", run.variables)


def _lasting(name: str) -> str:
    """How long a variable of the case is taken to hold its value."""
    _, holds = kind_of(name)
    return "" if holds == _AT_START else f", which is taken to hold that {holds}"


def used(
    request: ProgramRequest,
    read: Callable[[ProgramRequest], ControllerProgram],
    found: ControllerProgram,
) -> ControllerProgram:
    """A program, if it changes without each of the values by name that its case gives, and has each word that the
    case skips. A doubt names each variable that no other doubt names: a line may use it without a branch.

    Args:
        read: the reader that made it from the request.

    Raises:
        BadProgram: one that changes nothing, with the nearest name that the files have.
    """
    words = [*_words(request)]
    known = {word.lower() for word in words}
    for name in request.asked.skip:
        if not {part.lower() for part in re.findall(r"[$\w]+", name)} <= known:
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
    told = " ".join(found.doubts)
    untold = [
        one for one in map(named, request.asked.variables) if f" {one} of the case" not in told
    ]
    more = (f"the moves rest on {one} of the case{_lasting(one)}" for one in untold)
    return replace(found, doubts=(*found.doubts, *more))


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
