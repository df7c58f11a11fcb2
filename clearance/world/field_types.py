"""What a constructor is given: the types, in one line each, and arrays and tuples of the object's own.

Not for: values, which each type checks itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from clearance.errors import BadInput, BadShape

_NAMES: dict[type, str] = {Real: "number", Mapping: "mapping"}

_NAMING = ("column_names", "columns", "_fields", "keys")
"""What has the names of a table of Arrow, a table of pandas, a named tuple, and a row of pandas."""

Kind = type | list[type] | tuple[type, None]
"""A type; a list of one for a sequence of such; a pair with None where it may be None."""


def require_types(made: object, **kinds: Kind) -> None:
    """Nothing, if each field of an object is of its type. Sequences become tuples: callers use their lists again.

    Raises:
        BadInput: the first that is not: its class and name, what is given, and what is needed.
    """
    for name, kind in kinds.items():
        given = getattr(made, name)
        if isinstance(kind, list):
            _require_each(made, name, given, kind[0])
        elif isinstance(kind, tuple):
            if given is not None and not isinstance(given, kind[0]):
                raise _wrong(made, name, given, _article(kind[0]))
        elif not isinstance(given, kind):
            raise _wrong(made, name, given, _article(kind))


def _require_each(made: object, name: str, given: Any, kind: type) -> None:
    if not isinstance(given, Sequence) or isinstance(given, str):
        raise _wrong(made, name, given, f"a sequence of {kind.__name__}")
    for one in given:
        if not isinstance(one, kind):
            raise _wrong(made, name, one, _article(kind))
    object.__setattr__(made, name, tuple(given))


def owned(array: np.ndarray) -> np.ndarray:
    """The array if it is read-only, else a read-only copy: callers reuse their arrays for the next object."""
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array


def numbers_of(given: object, names: Sequence[str] = (), where: str = "") -> np.ndarray:
    """What is given as numbers; the last axis is that of `names`, whatever order a named row or table has.

    Raises:
        BadInput: no numbers, masked ones, times of a calendar, or values of other names.
    """
    if type(given) is np.ndarray and given.dtype == np.float64:
        return given
    own = names_in(given) if names else []
    if own:
        places = _places_of(names, own, where)
        if isinstance(given, Mapping):
            return numbers_of([*given.values()], (), where).T[..., places]
        return numbers_of(given, (), where)[..., places]
    rows = given if isinstance(given, Sequence) and not isinstance(given, str) else ()
    if names and any(map(names_in, rows)):
        return numbers_of([numbers_of(row, names, where) for row in rows], (), where)
    if np.ma.is_masked(given) or any(map(np.ma.is_masked, rows)):
        raise BadInput("values are masked", where=where, valid="an array without a mask")
    dtype = getattr(given, "dtype", None)
    if isinstance(dtype, np.dtype) and dtype.kind in "bmMc":
        raise BadInput(
            f"values have the type {dtype}", where=where, valid="an array of real numbers"
        )
    try:
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadShape(
            f"{given!r:.60} is given", where=where, valid="an array of numbers"
        ) from None


def names_in(given: Any) -> list[Any]:
    """The names of the values of a row, or of the columns of a table; empty where they are in order alone."""
    if type(given) in (float, int):
        return []
    if isinstance(given, Mapping):
        return [*given]
    for attribute in _NAMING:
        found = getattr(given, attribute, None)
        if found is not None:
            own = [*(found() if callable(found) else found)]
            return own if any(isinstance(name, (str, tuple)) for name in own) else []
    return []


def _places_of(names: Sequence[str], own: list[Any], where: str) -> list[int]:
    """The place of each of the names among those of a row or table.

    Raises:
        BadInput: others, or one of them twice.
    """
    faults = {
        "unknown": [name for name in own if name not in names],
        "missing": [name for name in names if name not in own],
        "twice": [name for name in dict.fromkeys(own) if own.count(name) > 1],
    }
    told = (f"{fault}: {', '.join(sorted(map(str, of)))}" for fault, of in faults.items() if of)
    if any(faults.values()):
        raise BadInput(
            "; ".join(told), where=where, valid=f"one number for each of {', '.join(names)}"
        )
    return [own.index(name) for name in names]


def require_two_patterns(made: object, name: str, given: Any) -> tuple[str, str]:
    """Two patterns of names.

    Raises:
        BadInput: anything else.
    """
    is_pair = isinstance(given, Sequence) and not isinstance(given, str) and len(given) == 2
    if not is_pair or not all(isinstance(one, str) for one in given):
        raise _wrong(made, name, given, "two patterns of names")
    return given[0], given[1]


def _article(kind: type) -> str:
    return f"a {_NAMES.get(kind, kind.__name__)}"


def _wrong(made: object, name: str, given: object, needed: str) -> BadInput:
    where = f"{type(made).__name__}.{name}"
    return BadInput(f"{given!r:.60} is given", where=where, valid=f"{needed} is needed")
