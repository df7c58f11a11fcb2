"""Which cases of a store could not be read or answered when they were last tried, and why: `faults.json`.

Such a case has no row, so without this file it could not be told from one that nobody has measured yet. The file
decides nothing: the next batch tries each of them again. Not for: rows (`store`).
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import Item
from clearance.batch.measuring import Fault
from clearance.report.folder import write_file

FILE_NAME = "faults.json"


def keep_faults(place: Path, items: Iterable[Item], faults: Mapping[int, Fault]) -> None:
    """Writes what is wrong with some cases, instead of what was known of them; what is known of others stays.

    Raises:
        Unwritable: it cannot be written.
    """
    before = _read(place)
    known = before.copy()
    for item in items:
        known.pop(item.name, None)
        fault = faults.get(item.number)
        if fault is not None:
            files = _files(item, FileHashes())
            known[item.name] = {"text": fault.text, "trace": fault.trace, "files": files}
    if known != before:
        content = json.dumps(known, indent=0, sort_keys=True) + "\n"
        write_file(place / FILE_NAME, content.encode())


def faults_in(place: Path, items: Iterable[Item], hashes: FileHashes) -> dict[int, Fault]:
    """The faults of some cases by number, of those whose own files are what they were."""
    known = _read(place)
    found: dict[int, Fault] = {}
    for item in items if known else ():
        told = known.get(item.name)
        if told is not None and told["files"] == _files(item, hashes):
            found[item.number] = Fault(item.number, told["text"], told["trace"])
    return found


def _files(item: Item, hashes: FileHashes) -> list[str | None]:
    """The sha256 of the case file, and of the trajectory that it is given; null where one cannot be read."""
    given = item.trajectory
    paths = [item.file] if given is None else [item.file, given.path]
    return [hashes.of(path) for path in paths]


def _read(place: Path) -> dict[str, dict[str, Any]]:
    """What is known; nothing where the file is not there or damaged."""
    try:
        told = json.loads((place / FILE_NAME).read_text(encoding="utf-8"))
        return {
            str(name): {"text": str(one["text"]), "trace": str(one["trace"]), "files": one["files"]}
            for name, one in told.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}
