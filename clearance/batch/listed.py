"""The list of a store's last batch as JSON: which cases there are, for whoever asks about one of them later.

Not for: what became of them (`store`).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, fields
from datetime import date
from pathlib import Path

from clearance.batch.cases import Cases
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.options import CaseOptions
from clearance.errors import BadInput, MissingFile, nearest_name
from clearance.load.tolerance.tolerance_file import tolerance_digest
from clearance.report.folder import written_file
from clearance.world.waiver import Waiver

FILE_NAME = "batch.json"

_CASES = '"cases": ['
"""Where the cases begin; no text within holds it, since its quotes would be escaped."""


def write_list(place: Path, cases: Cases) -> None:
    """Writes the list of a batch; what all cases have in common is there once.

    Raises:
        Unwritable: it cannot be written.
    """
    options = cases.options
    number = {one: i for i, one in enumerate(options)}
    waivers = list(dict.fromkeys(waiver for one in options for waiver in one.waivers))
    index = {waiver: i for i, waiver in enumerate(waivers)}
    content = {
        "waivers": [_waiver_told(waiver) for waiver in waivers],
        "options": [_options_told(one, index) for one in options],
        "cases": [],
    }
    head, _, tail = json.dumps(content, indent=0).rpartition("]")
    with written_file(place / FILE_NAME) as file:
        file.write(head.encode())
        for item in cases:
            row = _told(item) | {"options": number[item.options]}
            file.write(((",\n" if item.number else "\n") + _object(row)).encode())
        file.write(f"\n]{tail}\n".encode())


def read_list(place: Path) -> Cases:
    """The cases of the last batch.

    Raises:
        MissingFile: there was none. BadInput: it is damaged; the batch writes it anew.
    """
    path = place / FILE_NAME
    try:
        head, begin, rows = path.read_text(encoding="utf-8").partition(_CASES)
        told = json.loads(f"{head}{begin}]}}")
        waivers = [_waiver(one) for one in told["waivers"]]
        options = [_options(one, waivers) for one in told["options"]]
        return Cases.of(_item(i, row, options) for i, row in enumerate(_rows(rows)))
    except FileNotFoundError:
        raise MissingFile(
            "no batch was begun here", where=str(place), valid="`clearance batch … --out` first"
        ) from None
    except (OSError, ValueError, KeyError, TypeError, IndexError, BadInput):
        raise BadInput(
            "the list of cases is damaged", where=str(path), valid="`clearance batch` once more"
        ) from None


def _object(told: dict[str, object]) -> str:
    """A JSON object as `json.dumps(told, indent=0)` writes it, in a third of the time."""
    members = (
        f"{json.dumps(name)}: {_object(one) if isinstance(one, dict) else json.dumps(one)}"
        for name, one in told.items()
    )
    return "{\n" + ",\n".join(members) + "\n}"


def _rows(text: str) -> Iterator[dict]:
    """The cases of a list, one after another, from where the first begins.

    Raises:
        ValueError: it is damaged.
    """
    decoder, at = json.JSONDecoder(), 0
    while (begin := text.find("{", at, at + 3)) >= 0:
        row, at = decoder.raw_decode(text, begin)
        yield row
    if text[at:].split() != ["]", "}"]:
        raise ValueError(f"{text[at:]:.9} goes on no list")


def item_called(items: Sequence[Item], name: str) -> Item:
    """The case of a name.

    Raises:
        BadInput: there is none; with the nearest name.
    """
    found = next((item for item in items if item.name == name), None)
    if found is None:
        names = [item.name for item in items]
        raise BadInput(f"there is no case {name!r:.80}", valid=nearest_name(name, names))
    return found


def _told(item: Item) -> dict[str, object]:
    told: dict[str, object] = {"name": item.name, "file": item.file}
    return told if item.trajectory is None else told | {"trajectory": asdict(item.trajectory)}


def _item(number: int, row: dict, options: Sequence[CaseOptions]) -> Item:
    given = row.get("trajectory")
    trajectory = None if given is None else GivenTrajectory(**given)
    return Item(number, row["name"], row["file"], trajectory, options[row["options"]])


def _options_told(one: CaseOptions, index: dict[Waiver, int]) -> dict[str, object]:
    told = {field.name: getattr(one, field.name) for field in fields(one)}
    return told | {"waivers": [index[waiver] for waiver in one.waivers]}


def _options(told: dict, waivers: Sequence[Waiver]) -> CaseOptions:
    own = tuple(waivers[i] for i in told["waivers"])
    key = _key_now(told["tolerance"])
    return CaseOptions(
        **told | {"accept": tuple(told["accept"]), "waivers": own, "tolerance_key": key}
    )


def _key_now(tolerance: str) -> str:
    """The key of a file of tolerances as it is now: what was measured with another content is missing."""
    try:
        return tolerance_digest(Path(tolerance)) if tolerance else ""
    except BadInput:
        return "none"


_WAIVER = ("between", "at_least", "reason", "by", "case", "rule", "where", "shared")


def _waiver_told(waiver: Waiver) -> dict[str, object]:
    return {name: getattr(waiver, name) for name in _WAIVER} | {"until": waiver.until.isoformat()}


def _waiver(told: dict) -> Waiver:
    one, other = told["between"]
    return Waiver(**told | {"between": (one, other), "until": date.fromisoformat(told["until"])})
