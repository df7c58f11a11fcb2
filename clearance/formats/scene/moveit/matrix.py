"""MoveIt's AllowedCollisionMatrix to pairs of names that may touch. Not for: which bodies there are.

Source: MoveIt, collision_detection::AllowedCollisionMatrix: an entry goes before a default.
"""

from __future__ import annotations

from clearance.errors import BadInput, BadShape, at
from clearance.formats.message.values import Message, items
from clearance.world.names import require_own_names
from clearance.world.rules import pattern_of

MOST_NAMES = 2000
"""Of which there are two million pairs."""

ANY = "*"
"""Stands for every body."""


def allowed_pairs(matrix: Message) -> list[tuple[str, str]]:
    """The pairs of names of which an entry is true, each once, as patterns of those names alone; with `ANY` for a
    default that is true.

    A default holds for pairs of which there is no entry; where the entries of a name forbid something, its default
    is left out, so that more is measured and not less.

    Raises:
        BadShape: rows and names that are not as many. BadInput: an entry that is neither true nor false.
        DuplicateName: two rows of one name.
    """
    with at("allowed_collision_matrix"):
        names = _names(matrix, "entry_names")
        if len(names) > MOST_NAMES:
            raise BadInput(f"{len(names)} entry_names are given", valid=f"{MOST_NAMES} or fewer")
        rows = [_row(row, len(names)) for row in items(matrix, "entry_values")]
        require_own_names("entry_name", names)
        if len(rows) != len(names):
            raise BadShape(
                f"{len(rows)} entry_values of {len(names)} entry_names", valid="one each"
            )
        patterns = [pattern_of(name) for name in names]
        pairs = [
            (patterns[i], patterns[j])
            for i in range(len(names))
            for j in range(i + 1, len(names))
            if rows[i][j] and rows[j][i]
        ]
        forbidding = {name for name, row in zip(names, rows, strict=True) if not all(row)}
        return pairs + [
            (pattern_of(name), ANY) for name in _defaults(matrix) if name not in forbidding
        ]


def _defaults(matrix: Message) -> list[str]:
    names = _names(matrix, "default_entry_names")
    values = items(matrix, "default_entry_values")
    if len(values) != len(names):
        raise BadShape(f"{len(values)} default_entry_values of {len(names)}", valid="one each")
    return [name for name, value in zip(names, _row(values, len(names)), strict=True) if value]


def _names(matrix: Message, key: str) -> list[str]:
    names = items(matrix, key)
    if not all(isinstance(name, str) for name in names):
        raise BadInput("a name is no text", where=key, valid="names")
    return names


def _row(given: object, n: int) -> list[bool]:
    row = given.get("enabled") if isinstance(given, dict) else given
    if not isinstance(row, list) or len(row) != n:
        raise BadShape(
            f"{given!r:.60} is given", where="entry_values", valid=f"{n} of true or false"
        )
    if not all(value in (0, 1) for value in row):
        raise BadInput(f"{given!r:.60} is given", where="entry_values", valid="true or false")
    return [bool(value) for value in row]
