"""A cell with a cart on a rail before a wall, and motions on it: small cases in any number, made in a moment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from clearance.batch.answer import BatchAnswer, answer_of
from clearance.batch.engine import LocalEngine
from clearance.batch.item import Item
from clearance.batch.listed import write_list
from clearance.batch.manifest import batch_of
from clearance.batch.outcome import Outcome
from clearance.batch.output import write_answer
from clearance.batch.run import run_batch
from clearance.batch.store import open_store
from clearance.cli.batch_verdict import print_answer
from tests.cart import URDF

CELL = """name: rail
robot: {urdf: cart.urdf}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}
limits: {fail: 0.05, warn: 0.3}
"""

MANIFEST = 'cell: cell.yaml\ntrajectories: "t*.csv"\n'

ANSWER = ("batch.html", "cases.parquet", "findings.parquet", "junit.xml")


def items_of(arguments: Sequence[str], said: Mapping[str, Any] = {}) -> tuple[Item, ...]:
    """The cases of `batch_of`."""
    return batch_of(arguments, said).items


def write_path(path: Path, nearest: float) -> None:
    """A motion up to `nearest` [m] from the wall and half the way back."""
    path.write_text(f"time,rail\n0,0\n1,{0.8 - nearest}\n2,{0.4}\n")


def write_cell(folder: Path, nearest: Sequence[float]) -> Path:
    """The manifest of a cell with a motion `t000.csv`, … for each distance [m]."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cart.urdf").write_text(URDF)
    (folder / "cell.yaml").write_text(CELL)
    for i, one in enumerate(nearest):
        write_path(folder / f"t{i:03d}.csv", one)
    manifest = folder / "batch.yaml"
    manifest.write_text(MANIFEST)
    return manifest


class JointsOnPath:
    """A watch that keeps what it is told."""

    def __init__(self) -> None:
        self.todo: list[str] = []
        self.measured: list[str] = []

    def begin(self, items) -> None:
        self.names = {item.number: item.name for item in items}
        self.todo = list(self.names.values())

    def note(self, measured, faults) -> None:
        self.measured += [self.names[one.number] for one in (*measured, *faults)]


def run_here(
    manifest: Path, place: Path, *, strict: bool = False, engine=None, changes=None, **options
):
    """Runs a batch in this process and writes its answer; what was measured, and the answer."""
    items, told = items_of([str(manifest)], changes or {}), JointsOnPath()
    outcome = Outcome(items)
    with open_store(place) as store:
        write_list(store, items)
        run_batch(outcome, store, lambda n: nullcontext(engine or LocalEngine()), told, **options)
        answer = answer_of(outcome, store, strict=strict)
        write_answer(answer, store)
    return told, answer


def printed(answer: BatchAnswer, place: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The lines that a terminal shows of an answer."""
    with open_store(place) as store:
        print_answer(answer, store, 0, None)
    return capsys.readouterr().out.splitlines()


def answer_bytes(place: Path) -> dict[str, bytes]:
    """The content of the answer's files."""
    return {name: (place / name).read_bytes() for name in ANSWER if (place / name).exists()}


def statuses(answer: BatchAnswer) -> dict[str, str]:
    """The status of each case by name."""
    return dict(zip(column(answer, "case"), column(answer, "status"), strict=True))


def column(answer: BatchAnswer, name: str) -> list:
    """A column of the cases."""
    return answer.column(name)


def cases(place: Path) -> list[dict]:
    """The rows of the table of cases in a store."""
    return pq.read_table(place / "cases.parquet").to_pylist()


def findings(place: Path) -> list[dict]:
    """The rows of the table of findings in a store."""
    return pq.read_table(place / "findings.parquet").to_pylist()


def n_rows(place: Path) -> int:
    """How many rows the store in a folder has, whoever is writing there."""
    with open_store(place, make=False) as store:
        return len(store)
