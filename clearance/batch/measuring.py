"""Reads and answers cases, in whichever process: a task in, the rows of its cases out.

A cell is read once in a process and stays for the next case in it. Not for: which process does what (`engine`).
"""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

from clearance.batch.file_hashes import FileStamp, seen
from clearance.batch.item import Item
from clearance.batch.keys import DAY, key_of, program, value_digest, variable_mark
from clearance.batch.rows import inputs_text, row_of
from clearance.batch.shared_waivers import as_shared
from clearance.errors import ClearanceError, Incomplete
from clearance.load.case.case_file import CellFile, load_case, load_cell, with_trajectory_file
from clearance.load.files.mesh_paths import variables_of
from clearance.load.robot.urdf.xacro_variables import variables_asked
from clearance.load.schema.manifest import TrajectoryOptions
from clearance.run import Question, Resources, Run, answer
from clearance.world.case import Case, Source

CELLS = 4
"""Cells that stay read in a process; work comes cell by cell."""

GROUP, GROUP_SECONDS = 16, 0.1
"""Short cases that go through each stage together: a processor's caches hold one stage, not all. As many as that
time is enough for, so that no long case waits for another."""

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
    n_done = 0
    while n_done < len(task.items):
        passed = time.monotonic() - begun
        if n_done and passed > task.seconds:
            break
        some = task.items[n_done : n_done + _group_size(n_done, passed)]
        n_done += work.add(some, begun + task.seconds)
    return work.done(task.items[n_done:])


def _group_size(n_done: int, passed: float) -> int:
    """How many cases go on together, after so many in [s]."""
    if n_done == 0:
        return 1
    return max(1, min(GROUP, int(GROUP_SECONDS * n_done / max(passed, 1e-9))))


class _StagedCase:
    """A case that goes through the stages beside others, and what has become of it; after a fault no more does."""

    def __init__(self, item: Item) -> None:
        self.item, self.read = item, 0
        self.fault: Fault | None = None
        self.found: ReadItem
        self.question: Question
        self.run: Run
        self.row: dict[str, Any]

    def take(self, stage: Callable[[_StagedCase], None]) -> None:
        """Goes through a stage."""
        if self.fault is not None:
            return
        try:
            stage(self)
        except ClearanceError as error:
            self.fault = Fault(self.item.number, str(error))
        except Exception as error:
            text = f"a fault of this program, not of the input: {type(error).__name__}: {error}"
            self.fault = Fault(self.item.number, text, traceback.format_exc())


class _Work:
    """Gathers what becomes of items."""

    def __init__(self, batch: str) -> None:
        self.batch = batch
        self.measured: list[ItemResult] = []
        self.faults: list[Fault] = []
        self.read: dict[str, FileStamp] = {}

    def add(self, items: Sequence[Item], until: float) -> int:
        """Takes items through all stages together; how many, since after a time [s] none but the first is begun.

        What has been read of the others is read again by whoever takes them.
        """
        staged, begun = [], time.monotonic()
        for item in items:
            staged.append(_StagedCase(item))
            staged[-1].take(self._read)
            if time.monotonic() - begun > GROUP_SECONDS:
                break  # what takes so long to read is large, and more of it would fill the memory
        for i, one in enumerate(staged):
            if i and time.monotonic() > until:
                staged = staged[:i]
                break
            one.take(_answer)
        for stage in (_find, _make_row):
            for one in staged:
                one.take(stage)
        for one in staged:
            if one.fault is None:
                self._keep(one)
            else:
                self.faults.append(one.fault)
        return len(staged)

    def _read(self, one: _StagedCase) -> None:
        one.read = time.time_ns()
        one.found = read_item(one.item, self.batch)
        one.question = one.item.options.question(one.found.case)

    def _keep(self, one: _StagedCase) -> None:
        item, found, read = one.item, one.found, one.read
        case, others = found.case, conditions_of(item, found.case)
        key = key_of(item, [(one.path, one.sha256) for one in (*case.sources, *others)])
        inputs = inputs_text((*found.kept, *others))
        self.measured.append(ItemResult(item.number, key, inputs, one.row))
        self._note(found.kept, found.since or read)
        self._note(case.sources, read)

    def _note(self, sources: Sequence[Source], read: int) -> None:
        for one in sources:
            if one.read_from not in self.read:
                marks = seen(one.read_from, one.sha256, read)
                if marks is not None:
                    self.read[one.read_from] = marks

    def done(self, left: tuple[Item, ...]) -> TaskResult:
        return TaskResult(tuple(self.measured), tuple(self.faults), tuple(self.read.items()), left)


def _answer(one: _StagedCase) -> None:
    one.run = answer(one.question, ONE_THREAD)


def _find(one: _StagedCase) -> None:
    _ = one.run.findings  # which the row takes as they are then


def _make_row(one: _StagedCase) -> None:
    one.row = row_of(one.run)


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
        case = load_case(item.file)
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
    day = [Source(DAY, item.options.today, 0)] if case.waivers else []
    named = variables_of([one.read_from for one in case.sources])
    named = list(dict.fromkeys([*named, *variables_asked(case.sources)]))
    return (*day, *(Source(variable_mark(name), value_digest(name), 0) for name in named))


@lru_cache(maxsize=CELLS)
def _cell(path: str, batch: str) -> tuple[CellFile, int]:
    """A cell, and when [ns] reading it began: what becomes of its files later is not what was read."""
    since = time.time_ns()
    return load_cell(path), since
