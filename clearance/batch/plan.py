"""Which cases of a batch the store has answered already, without reading a case: by the hashes of its files.

A case whose files are all as they were when they were last read is what it was then, if all that was looked for in
several places is still found where it was. Not for: measuring the others (`measuring`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.keys import DAY, key_of, value_digest, variable_of
from clearance.batch.measuring import Fault
from clearance.batch.outcome import Outcome
from clearance.batch.store import Store
from clearance.formats.files.found_files import leads_to
from clearance.formats.files.input_files import InputFiles
from clearance.formats.motion.requests import files_of
from clearance.world.case import LOOKUP

Files = tuple[tuple[str, str], ...]
"""Path as shown and sha256."""


def planned(
    outcome: Outcome, store: Store, hashes: FileHashes, *, fresh: bool = False
) -> list[Item]:
    """Notes what the store has answered; the other cases, those of a cell together.

    Args:
        fresh: all are to be done.
    """
    lookup, todo = _Lookup(store, hashes), []
    for item in outcome.items:
        key = None if fresh else lookup.key(item)
        if key is None:
            todo.append(item)
        else:
            outcome.keys[item.number] = key
    return sorted(todo, key=lambda item: item.file)


def faults_as_before(store: Store, items: Iterable[Item], hashes: FileHashes) -> dict[int, Fault]:
    """The faults of cases when they were last tried, by number, of those whose own files are what they were."""
    found: dict[int, Fault] = {}
    for item in items:
        fault = store.fault(item.name)
        if fault is not None and fault[2] == files_text(item, hashes):
            found[item.number] = Fault(item.number, fault[0], fault[1])
    return found


def files_text(item: Item, hashes: FileHashes) -> str:
    """The sha256 of the case file and of the trajectory it is given, as text; null where one cannot be read."""
    given = item.trajectory
    paths = [item.file] if given is None else [item.file, given.path]
    return json.dumps([hashes.of(path) for path in paths])


@dataclass(eq=False)
class _Lookup:
    """Finds the keys of items; what cases share is looked at once."""

    store: Store
    hashes: FileHashes
    _inputs: dict[str, list[str]] = field(default_factory=dict)
    _shared: dict[str, Files | None] = field(default_factory=dict)
    _of_folder: dict[str, InputFiles] = field(default_factory=dict)
    _led_to: dict[str, str] = field(default_factory=dict)

    def key(self, item: Item) -> str | None:
        """The key of an item's row; None where the store has none, or a file is another."""
        own = self._own(item)
        if own is None:
            return None
        if item.file not in self._inputs:
            self._inputs[item.file] = self.store.inputs(item.file)
        for inputs in self._inputs[item.file]:
            shared = self._as_before(inputs, item.options.day.isoformat())
            if shared is not None:
                key = key_of(item, (*shared, *own))
                if self.store.has(key):
                    return key
        return None

    def _own(self, item: Item) -> Files | None:
        """The files of the trajectory that a cell is given."""
        given = item.trajectory
        if given is None:
            return ()
        folder = os.path.dirname(item.file)
        files = self._of_folder.get(folder)
        if files is None:
            files = self._of_folder[folder] = InputFiles(Path(folder))
        return self._hashed((files.shown(path), path) for path in _paths(given))

    def _as_before(self, inputs: str, today: str) -> Files | None:
        """The files that a case was made from, if each is as it was, and so are the day, the variables and the
        searches that it depends on.
        """
        if inputs not in self._shared:
            self._shared[inputs] = self._checked(json.loads(inputs), today)
        return self._shared[inputs]

    def _checked(self, recorded: list[list[str]], today: str) -> Files | None:
        searches = [row for row in recorded if row[0].startswith(LOOKUP)]
        rest = [row for row in recorded if not row[0].startswith(LOOKUP)]
        found = self._hashed((shown, path) for shown, path, _ in rest if path)
        files = tuple((shown, sha256) for shown, path, sha256 in rest if path)
        others = tuple((shown, value) for shown, path, value in rest if not path)
        same = found == files and all(_is_so(*one, today) for one in others)
        same = same and all(self._leads_to(asked) == value for _, asked, value in searches)
        return (*files, *others) if same else None

    def _leads_to(self, asked: str) -> str:
        if asked not in self._led_to:
            self._led_to[asked] = leads_to(asked)
        return self._led_to[asked]

    def _hashed(self, paths: Iterable[tuple[str, str]]) -> Files | None:
        found = []
        for shown, path in paths:
            sha256 = self.hashes.of(path)
            if sha256 is None:
                return None
            found.append((shown, sha256))
        return tuple(found)


def _is_so(shown: str, value: str, today: str) -> bool:
    """True if the day, or a variable, has the value that it had."""
    return value == (today if shown == DAY else value_digest(variable_of(shown)))


def _paths(given: GivenTrajectory) -> list[str]:
    """The files of a trajectory: several where it is a bag."""
    try:
        if os.path.isdir(given.path):
            return [*map(str, files_of(Path(given.path)))]
    except OSError:
        pass
    return [given.path]
