"""Programs in RAPID: from files to moves. Not for: what instructions do (`rapid_instructions`).

Source: ABB, Technical reference manual, RAPID instructions, functions and data types.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from clearance.errors import BadProgram, MissingKey, at, nearest_name
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
    ProgramRequest,
)
from clearance.formats.program.execution import Execution
from clearance.formats.program.rapid_data import (
    tool_record,
    work_object_record,
)
from clearance.formats.program.rapid_grammar import grammar
from clearance.formats.program.rapid_instructions import Rapid
from clearance.formats.program.rapid_text import Modules
from clearance.formats.program.rapid_words import (
    WORDS,
)
from clearance.formats.program.tokens import text_of
from clearance.formats.schema.program_file import ProgramFile


def read_rapid(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a procedure of a program: `main`, if no other is asked for.

    Raises:
        BadInput: with the file and the line.
    """
    rules, modules = grammar(WORDS), Modules()
    with at(asked.shown):
        modules.read(text_of(asked.data), rules)
        for file, data in asked.beside.items():
            modules.read(text_of(data, file), rules, file)
        given = asked.asked
        known_data = {
            **{name.lower(): tool_record(one.matrix()) for name, one in given.tools.items()},
            **{
                name.lower(): work_object_record(one.matrix()) for name, one in given.frames.items()
            },
        }
        language = Rapid(modules, known_data, {name.lower(): name for name in given.units})
        skip = frozenset(rules.folded(one) for one in given.skip)
        run = Execution(language, modules.routines, skip)
        language.declare(run)
        language.keep(run)
        run.enter(modules.routines[_entry(modules, given.entry)])
        moves = _with_zones(run.moves, language.zones)
        notes = (*run.notes, *language.assumed, *_on_cycles(moves))
        doubts = (*run.doubts, *_replaced(modules, given))
        return ControllerProgram(
            tuple(moves), notes, doubts=doubts, maker="abb", left_out=run.left_out
        )


def _replaced(modules: Modules, given: ProgramFile) -> Iterator[str]:
    """A line on each tool and work object of the case whose data the files have too."""
    for key, poses in (("tools", given.tools), ("frames", given.frames)):
        for name in poses:
            own = modules.declared.get(name.lower())
            if own is not None:
                text = f"replaces {own.name} at {own.line}, which the file gives"
                yield f"{key}.{name} of the case {text}"


def _on_cycles(moves: list[ControllerMove | ControllerWait]) -> list[str]:
    """A line on the way back that a controller in cycles makes, if the program ends elsewhere than it begins."""
    ends = [one.to for one in moves if isinstance(one, ControllerMove)]
    if not ends or (isinstance(ends[0], AxisTarget) and ends[0] == ends[-1]):
        return []
    return [
        "the procedure runs once: in cycles the way from its end to its beginning is not measured"
    ]


def _entry(modules: Modules, asked: str | None) -> str:
    """The procedure that runs.

    Raises:
        BadInput: there is none of the name; MissingKey: no `main`, and several others.
    """
    names = [
        name for name, one in modules.routines.items() if not one.parameters and not one.is_thread
    ]
    if asked is not None:
        if asked.lower() not in names:
            valid = nearest_name(asked, names)
            raise BadProgram(f"there is no procedure {asked!r}", where="entry", valid=valid)
        return asked.lower()
    if "main" in names or len(names) == 1:
        return "main" if "main" in names else names[0]
    if not names:
        raise BadProgram("no procedure that runs by itself is in it", valid="PROC main()")
    fault = f"there is no procedure main, but {', '.join(map(str, names))}"
    raise MissingKey(fault, where="entry", valid="the procedure that runs")


def _with_zones(
    moves: list[ControllerMove | ControllerWait], zones: dict[int, tuple[float, float]]
) -> list[ControllerMove | ControllerWait]:
    """Moves with the radius of their zone: that of the tool's point; where the tool turns before or after the
    larger one of its orientation. A wait turns nothing.
    """
    found = list(moves)
    for i, (point, turn) in zones.items():
        before = (move for move in reversed(moves[:i]) if isinstance(move, ControllerMove))
        one, around = moves[i], [*islice(before, 1), *moves[i : i + 2]]
        turns = [
            move.to.pose[:3, :3]
            if isinstance(move, ControllerMove) and isinstance(move.to, PoseTarget)
            else None
            for move in around
        ]
        first = turns[0]
        same = first is not None and all(
            one is not None and np.abs(one - first).max() < 1e-9 for one in turns
        )
        assert isinstance(one, ControllerMove)
        found[i] = replace(one, zone=point if same and len(turns) == 3 else max(point, turn))
    return found
