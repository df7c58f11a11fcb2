"""The list of a store's last batch: which cases there are, for whoever asks about one of them later.

Not for: what became of them (`store`).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.options import CaseOptions
from clearance.batch.store import Store
from clearance.errors import BadBatch, BadInput, MissingFile, nearest_name


def write_list(store: Store, items: Sequence[Item]) -> None:
    """Keeps the list of a batch; what cases have in common is there once.

    Raises:
        Incomplete: there is no room.
    """
    number = {one: i for i, one in enumerate(dict.fromkeys(item.options for item in items))}
    options = (json.dumps(one.plain(), default=str) for one in number)
    store.write_list(options, _list_rows(items, number))


def _list_rows(
    items: Sequence[Item], number: dict[CaseOptions, int]
) -> Iterator[tuple[int, str, str, int]]:
    for item in items:
        given = None if item.trajectory is None else asdict(item.trajectory)
        yield item.number, item.name, json.dumps([item.file, given]), number[item.options]


def read_list(store: Store) -> list[Item]:
    """The cases of the last batch.

    Raises:
        MissingFile: there was none. BadInput: it is damaged; the batch writes it anew.
    """
    asked, rows = store.read_list()
    if not rows:
        raise MissingFile(
            "no batch was begun here",
            where=str(store.place),
            valid="`clearance batch … --out` first",
        )
    try:
        options = [CaseOptions.of_plain(json.loads(one)) for one in asked]
        return [_item(i, name, stored, options[n]) for i, (name, stored, n) in enumerate(rows)]
    except (ValueError, TypeError, IndexError, BadInput):
        raise BadBatch(
            "the list of cases is damaged",
            where=str(store.path),
            valid="`clearance batch` again",
        ) from None


def item_called(items: Sequence[Item], name: str) -> Item:
    """The case of a name.

    Raises:
        BadInput: there is none; with the nearest name.
    """
    found = next((item for item in items if item.name == name), None)
    if found is None:
        names = [item.name for item in items]
        raise BadBatch(f"there is no case {name!r:.80}", valid=nearest_name(name, names))
    return found


def _item(number: int, name: str, stored: str, options: CaseOptions) -> Item:
    file, given = json.loads(stored)
    return Item(number, name, file, given and GivenTrajectory(**given), options)
