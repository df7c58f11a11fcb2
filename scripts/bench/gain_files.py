"""The made cases as case files, and proposals as files that the plain command checks in a process of its own.

Not for: which cases (`gain_cases`).
"""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from gain_cases import Source, ViolatedCase, violated_cases
from inputs import ROOT
from rows import write_csv

import clearance as cl
from clearance.case.rewritten_case import Node, rewritten_case
from clearance.gains.answer import Gain, Request
from clearance.gains.changed_files import case_files
from clearance.run import Question, answer

INDEX = "index.csv"

COLUMNS = ("source", "how", "kind", "who", "known", "file")


@dataclass(frozen=True)
class CaseOnDisk:
    """A made case, as it lies on disk; what its attributes say is in `ViolatedCase`."""

    source: str
    how: str
    kind: str
    who: str
    known: float
    file: Path

    @property
    def names(self) -> dict[str, str]:
        """What may be changed, as `gain` takes it."""
        return {"obstacle" if self.kind == "obstacle" else "robot": self.who}


def cases_in(
    folder: Path,
    n_cases: int,
    seed: int = 0,
    names: Sequence[str] = (),
    make: Callable[..., Iterator[ViolatedCase]] = violated_cases,
) -> list[CaseOnDisk]:
    """The cases of a folder, which are made and written first where it has none.

    Args:
        make: `violated_cases` or `bent_paths`.
    """
    if not (folder / INDEX).exists():
        rows = [vars(_written(one, folder, i)) for i, one in enumerate(make(n_cases, seed, names))]
        write_csv(rows, COLUMNS, folder / INDEX, digits=17)
    with (folder / INDEX).open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return [
        CaseOnDisk(**row | {"known": float(row["known"]), "file": folder / row["file"]})
        for row in rows
    ][:n_cases]


def kept_by_command(file: Path) -> bool:
    """Whether `clearance check` of a case file ends with 0, in another process."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "clearance", "check", str(file), "--contact", "none"]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    return done.returncode == 0


def kept_afresh(file: Path) -> bool:
    """Whether a case file, read and certified in this process, passes."""
    return bool(cl.check(cl.load_case(file), contact="none").passed)


def write_proposal(found: Gain, file: Path, folder: Path) -> Path:
    """The changed case of a gain on disk; its case file.

    Args:
        file: what was mended.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in case_files(replace(found, case_file=file), folder).files.items():
        (folder / name).write_bytes(content)
    return folder / "case.yaml"


def _written(one: ViolatedCase, folder: Path, i: int) -> CaseOnDisk:
    """A made case written: its limit, then, as a gain writes it, what is changed."""
    place = Path(f"{i:03}_{one.source.name}")
    file = folder / place / "limited.yaml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(_limited(one.source, one.case.limits.fail, file.parent))
    if one.how != "raised":
        request = Request(one.kind, **_named(one))
        run = answer(Question(one.case))
        change = Gain(
            request, True, one.case, np.zeros(0), one.known, 0.0, one.who, run, run, None, 0
        )
        write_proposal(change, file, file.parent)
        place = place / "case.yaml"
    else:
        place = place / "limited.yaml"
    return CaseOnDisk(one.source.name, one.how, one.kind, one.who, one.known, place)


def _named(one: ViolatedCase) -> dict[str, str]:
    return {"obstacle" if one.kind == "obstacle" else "robot": one.who}


def _limited(source: Source, fail: float, folder: Path) -> bytes:
    """The content of a source's case file for another folder, with one fail limit and no other."""

    def change(node: Node) -> None:
        node["limits"] = {"fail": float(fail)}
        node.setdefault("name", source.name)

    return rewritten_case(source.file.read_bytes(), source.file, folder, change)
