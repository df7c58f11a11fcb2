"""Which cases of a batch the store has answered already, without reading a case: by the hashes of its files.

A case whose files are all as they were when they were last read is what it was then, if all that was looked for in
several places is still found where it was. Not for: measuring the others (`measuring`).
"""

from __future__ import annotations

import json
import os
from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from clearance.batch.cases import SomeCases
from clearance.batch.digest_table import NONE
from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.keys import DAY, key_of, value_digest, variable_of
from clearance.batch.outcome import Outcome
from clearance.batch.store import MOST_TEXTS, Store
from clearance.load.files.input_files import InputFiles
from clearance.load.files.lookups import leads_to
from clearance.load.motion.bag_files import files_of
from clearance.world.case import LOOKUP

Files = tuple[tuple[str, str], ...]
"""Path as shown and sha256."""


def planned(
    outcome: Outcome, store: Store, hashes: FileHashes, *, fresh: bool = False
) -> SomeCases:
    """Notes what the store has answered; the other cases, those of a cell together.

    Args:
        fresh: all are to be done.
    """
    look = _Look(store, hashes)
    todo, files = array("I"), list[str]()
    for place, item in enumerate(outcome.items):
        row = NONE if fresh else look.row(item)
        if row == NONE:
            todo.append(place)
            files.append(item.file)
        else:
            outcome.note(item.number, row)
    order = sorted(range(len(todo)), key=files.__getitem__)
    return outcome.items.among(todo[i] for i in order)


@dataclass(eq=False)
class _Look:
    """Finds the keys of items; what cases share is looked at once."""

    store: Store
    hashes: FileHashes
    _shared: dict[str, Files | None] = field(default_factory=dict)
    _of_folder: dict[str, InputFiles] = field(default_factory=dict)
    _led_to: dict[str, str] = field(default_factory=dict)

    def row(self, item: Item) -> int:
        """The number of an item's row; `NONE` where the store has none, or a file is another."""
        own = self._own(item)
        if own is None:
            return NONE
        for inputs in self.store.inputs(item.file):
            shared = self._as_before(inputs, item.options.today)
            if shared is not None:
                row = self.store.find(key_of(item, (*shared, *own)))
                if row != NONE:
                    return row
        return NONE

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
            if len(self._shared) > MOST_TEXTS:
                self._shared.clear()
            told = json.loads(inputs)
            searches = [row for row in told if row[0].startswith(LOOKUP)]
            rest = [row for row in told if not row[0].startswith(LOOKUP)]
            found = self._hashed((shown, path) for shown, path, _ in rest if path)
            files = tuple((shown, sha256) for shown, path, sha256 in rest if path)
            others = tuple((shown, value) for shown, path, value in rest if not path)
            same = found == files and all(_is_so(*one, today) for one in others)
            same = same and all(self._leads_to(asked) == value for _, asked, value in searches)
            self._shared[inputs] = (*files, *others) if same else None
        return self._shared[inputs]

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
