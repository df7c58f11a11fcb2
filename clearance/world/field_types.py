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
    """What is given as numbers. Where a table names its columns, as one of pandas does, they are `names` in order.

    Raises:
        BadInput: no numbers, masked ones, times of a calendar, or columns of other names or in another order.
    """
    if type(given) is np.ndarray and given.dtype == np.float64:
        return given
    columns = [*getattr(given, "columns", ())]
    if names and any(isinstance(one, str) for one in columns) and columns != [*names]:
        told = ", ".join(map(str, columns))
        in_order = f"{', '.join(names)}, in this order"
        raise BadInput(f"the columns are {told}", where=where, valid=in_order)
    if np.ma.is_masked(given):
        raise BadInput("values are masked", where=where, valid="an array without a mask")
    dtype = getattr(given, "dtype", None)
    if isinstance(dtype, np.dtype) and dtype.kind in "mMc":
        raise BadInput(
            f"values have the type {dtype}", where=where, valid="an array of real numbers"
        )
    try:
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadShape(
            f"{given!r:.60} is given", where=where, valid="an array of numbers"
        ) from None


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
