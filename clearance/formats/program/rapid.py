"""Programs in RAPID: from files to moves. Not for: what instructions do (`rapid_instructions`).

Source: ABB, Technical reference manual, RAPID instructions, functions and data types.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from clearance.errors import at
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
    ProgramRequest,
)
from clearance.formats.program.execution import Execution
from clearance.formats.program.language import entry_of
from clearance.formats.program.rapid_data import tool_record, work_object_record
from clearance.formats.program.rapid_grammar import GRAMMAR
from clearance.formats.program.rapid_instructions import Rapid
from clearance.formats.program.rapid_text import Modules
from clearance.formats.program.tokens import text_of
from clearance.formats.schema.program_file import ProgramFile


def read_rapid(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a procedure of a program: `main`, if no other is asked for.

    Raises:
        BadInput: with the file and the line.
    """
    given, modules = asked.asked, Modules()
    with at(asked.shown):
        modules.read(text_of(asked.data))
        for file, data in asked.beside.items():
            modules.read(text_of(data, file), file)
        tools, frames = (
            {name.lower(): record(one.matrix()) for name, one in poses.items()}
            for poses, record in ((given.tools, tool_record), (given.frames, work_object_record))
        )
        language = Rapid(modules, tools | frames, {name.lower(): name for name in given.units})
        run = Execution(language, modules.routines, frozenset(map(GRAMMAR.folded, given.skip)))
        language.declare(run)
        own = modules.routines.items()
        names = [name for name, one in own if not one.parameters and not one.is_thread]
        asked_name = (given.entry or "").lower()
        entry = entry_of("procedure", names, given.entry, asked_name, "main")
        run.enter(modules.routines[entry])
        run.moves = _with_zones(run.moves, language.zones)
        notes = (*language.assumed, *_on_cycles(run.moves))
        return language.program_of(run, notes, _replaced(modules, given))


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
