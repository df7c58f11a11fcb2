"""Which cases of a batch the store has answered already, without reading a case: by the hashes of its files.

A case whose files are all as they were when they were last read is what it was then, if all that was looked for in
several places is still found where it was. Not for: measuring the others (`measuring`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import field
from pathlib import Path

from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.keys import DAY, key_of, value_digest, variable_of
from clearance.batch.store import Store
from clearance.late_dataclass import dataclass
from clearance.load.bag_files import files_of
from clearance.load.input_files import InputFiles
from clearance.load.lookups import leads_to
from clearance.world.case import LOOKUP

Files = tuple[tuple[str, str], ...]
"""Path as shown and sha256."""


@dataclass(frozen=True)
class Plan:
    """What is known and what is to be done.

    Attributes:
        keys: of the items that the store has answered, by number. todo: the others, those of a cell together.
    """

    keys: dict[int, str]
    todo: list[Item]


def planned(
    items: Sequence[Item], store: Store, hashes: FileHashes, *, fresh: bool = False
) -> Plan:
    """What of some items is to be done.

    Args:
        fresh: all of it.
    """
    keys: dict[int, str] = {}
    look = _Look(store, hashes)
    if not fresh:
        for item in items:
            key = look.key(item)
            if key is not None:
                keys[item.number] = key
    todo = [item for item in items if item.number not in keys]
    return Plan(keys, sorted(todo, key=lambda item: (item.file, item.number)))


@dataclass(eq=False)
class _Look:
    """Finds the keys of items; what cases share is looked at once."""

    store: Store
    hashes: FileHashes
    _shared: dict[str, Files | None] = field(default_factory=dict)
    _of_folder: dict[str, InputFiles] = field(default_factory=dict)
    _led_to: dict[str, str] = field(default_factory=dict)

    def key(self, item: Item) -> str | None:
        """The key of an item that the store has; None where it has none, or a file is another."""
        own = self._own(item)
        if own is None:
            return None
        for inputs in self.store.inputs.get(item.file, ()):
            shared = self._as_before(inputs, item.options.today)
            if shared is not None:
                key = key_of(item, (*shared, *own))
                if key in self.store:
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
        return self._hashed((files.shown(path), str(path)) for path in _paths(given))

    def _as_before(self, inputs: str, today: str) -> Files | None:
        """The files that a case was made from, if each is as it was, and so are the day, the variables and the
        searches that it depends on.
        """
        if inputs not in self._shared:
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


def _paths(given: GivenTrajectory) -> list[Path]:
    """The files of a trajectory: several where it is a bag."""
    try:
        return files_of(Path(given.path))
    except OSError:
        return [Path(given.path)]
