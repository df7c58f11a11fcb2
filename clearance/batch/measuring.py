"""Reads and answers cases, in whichever process: a task in, the rows of its cases out.

A cell is read once in a process and stays for the next case in it. Not for: which process does what (`engine`).
"""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from clearance.batch.file_hashes import FileStamp, seen
from clearance.batch.item import Item
from clearance.batch.keys import DAY, key_of, program, value_digest, variable_mark
from clearance.batch.manifest_file import TrajectoryOptions
from clearance.batch.rows import inputs_text, row_of
from clearance.batch.shared_waivers import as_shared
from clearance.case.case_file import CellFile, load_case, load_cell, with_trajectory_file
from clearance.case.packed import is_zip, unpacked_for_now
from clearance.codes import code_of_error, coded
from clearance.errors import ClearanceError, Incomplete
from clearance.formats.files.input_files import InputFiles
from clearance.formats.files.mesh_paths import variables_of
from clearance.formats.robot.urdf.xacro_file import variables_asked
from clearance.run import Resources, answer
from clearance.world.case import Case, Source

CELLS = 4
"""Cells that stay read in a process; work comes cell by cell."""

ONE_THREAD = Resources(jobs=1)


@dataclass(frozen=True)
class Task:
    """Cases to be measured one after another.

    Attributes:
        seconds: after which no further case is begun; what is left comes back.
        program: that the rows must be of. batch: another one for each batch, whose cells are read anew.
    """

    items: tuple[Item, ...]
    seconds: float
    program: str
    batch: str


class ItemResult(NamedTuple):
    """What became of an item.

    Attributes:
        inputs: the files that its case file was read with, as `rows.inputs_text` writes them.
        row: the columns of `rows.VERDICT`.
    """

    number: int
    key: str
    inputs: str
    row: dict[str, Any]


class Fault(NamedTuple):
    """Why an item has no answer.

    Attributes:
        trace: where this program is at fault, else empty.
    """

    number: int
    text: str
    trace: str = ""


@dataclass(frozen=True)
class TaskResult:
    """What a task came to.

    Attributes:
        read: the files that were read, as they were found. left: what was not begun.
    """

    measured: tuple[ItemResult, ...]
    faults: tuple[Fault, ...]
    read: tuple[tuple[str, FileStamp], ...]
    left: tuple[Item, ...]


def measure(task: Task) -> TaskResult:
    """Measures the items of a task.

    Raises:
        Incomplete: this process runs another program than the one that asks.
    """
    if task.program != program():
        raise Incomplete(
            "a worker runs another version of clearance or of its libraries",
            valid="the same versions wherever the batch runs",
        )
    work, begun = _Work(task.batch), time.monotonic()
    for i, item in enumerate(task.items):
        if i and time.monotonic() - begun > task.seconds:
            return work.done(task.items[i:])
        work.take(item)
    return work.done(())


class _Work:
    """Gathers what becomes of items."""

    def __init__(self, batch: str) -> None:
        self.batch = batch
        self.measured: list[ItemResult] = []
        self.faults: list[Fault] = []
        self.read: dict[str, FileStamp] = {}

    def take(self, item: Item) -> None:
        """Measures an item; a fault of one costs no other."""
        try:
            with unpacked_for_now():
                self._measure(item)
        except ClearanceError as error:
            self.faults.append(Fault(item.number, error.line))
        except Exception as error:
            text = f"a fault of this program, not of the input: {type(error).__name__}: {error}"
            text = coded(text, code_of_error(type(error)))
            self.faults.append(Fault(item.number, text, traceback.format_exc()))

    def _measure(self, item: Item) -> None:
        read = time.time_ns()
        case, sources, since = read_item(item, self.batch)
        row = row_of(answer(item.options.question(case), ONE_THREAD))
        others = conditions_of(item, case)
        key = key_of(item, [(one.path, one.sha256) for one in (*case.sources, *others)])
        inputs = inputs_text((*sources, *others))
        self.measured.append(ItemResult(item.number, key, inputs, row))
        self._note(sources, since or read)
        self._note(case.sources, read)

    def _note(self, sources: Sequence[Source], read: int) -> None:
        for one in sources:
            if one.read_from not in self.read:
                marks = seen(one.read_from, one.sha256, read)
                if marks is not None:
                    self.read[one.read_from] = marks

    def done(self, left: tuple[Item, ...]) -> TaskResult:
        """What became of all."""
        return TaskResult(tuple(self.measured), tuple(self.faults), tuple(self.read.items()), left)


class ReadItem(NamedTuple):
    """A case, and the files that it has in common with others of its cell, or all.

    Attributes:
        since: [ns] when reading `kept` began, where a case before has read them; else 0.
    """

    case: Case
    kept: tuple[Source, ...]
    since: int = 0


def read_item(item: Item, batch: str = "") -> ReadItem:
    """The case of an item.

    Args:
        batch: as in `Task`.

    Raises:
        BadInput: as `load_case`.
    """
    given = item.trajectory
    if given is None:
        file = Path(item.file)
        case = load_case(file)
        if is_zip(file):
            files = InputFiles(file.parent)
            files.unread(file)
            case = replace(case, sources=files.sources)
        return ReadItem(case, case.sources)
    cell, since = _cell(item.file, batch)
    reading = TrajectoryOptions.model_validate(json.loads(given.reading))
    asked = reading.model_copy(update={"file": given.path})
    case = with_trajectory_file(cell, asked, item.name, given.robot)
    if case.waivers:
        case = replace(case, waivers=as_shared(case.waivers))
    return ReadItem(case, cell.files.sources, since)


def conditions_of(item: Item, case: Case) -> tuple[Source, ...]:
    """What a row depends on beside the files of its case, as if each were one: the day, where it has waivers that
    may end on one, variables that name folders in which files of it lie, and those that its xacro files ask for.
    """
    day = [Source(DAY, item.options.day.isoformat(), 0)] if case.waivers else []
    of_files = variables_of([one.read_from for one in case.sources])
    named = list(dict.fromkeys([*of_files, *variables_asked(case.sources)]))
    return (*day, *(Source(variable_mark(name), value_digest(name), 0) for name in named))


@lru_cache(maxsize=CELLS)
def _cell(path: str, batch: str) -> tuple[CellFile, int]:
    """A cell, and when [ns] reading it began: what becomes of its files later is not what was read."""
    since = time.time_ns()
    return load_cell(path), since
