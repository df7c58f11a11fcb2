"""The full report of one case of a batch, written when somebody asks for it. Not for: the page of all (`page`)."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from clearance.batch.item import Item
from clearance.batch.keys import key_of
from clearance.batch.measuring import conditions_of, read_item
from clearance.progress import Progress
from clearance.run import Resources, Run, answer

FOLDER = "cases"

_NO_NAME = re.compile(r"[^A-Za-z0-9._-]+")


def folder_of(name: str, key: str) -> str:
    """Where the report of a case lies in its store; another place once the case is another."""
    plain = _NO_NAME.sub("_", name).strip("._")[:80] or "case"
    return f"{FOLDER}/{plain}-{hashlib.sha256(f'{name} {key}'.encode()).hexdigest()[:12]}"


def write_case_page(place: Path, item: Item, progress: Progress | None = None) -> tuple[Run, Path]:
    """Measures a case once more, every step of it, and writes its report; returns where.

    Raises:
        BadInput: the case cannot be read. Unwritable: the report cannot be written.
    """
    case = read_item(item).case
    run = answer(item.options.of_report().question(case), Resources(progress=progress))
    files = (*case.sources, *conditions_of(item, case))
    key = key_of(item, [(one.path, one.sha256) for one in files])
    return run, run.save(place / folder_of(item.name, key))
