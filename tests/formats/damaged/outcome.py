"""What comes of a damaged file: it is read, refused by an error of ours, or shows a fault of its reader."""

from __future__ import annotations

import dataclasses
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from clearance.errors import ClearanceError
from tests.formats.damaged.rows import Reader

MAY_BE_INFINITE = frozenset(
    {"lower", "upper", "velocity", "acceleration", "limits", "trajectory", "goal", "start", "end"}
)
"""What is called so has no bound where it is infinite."""

MOST_VALUES = 20_000
"""Values that are looked at in what was read."""


def outcome(reader: Reader, data: bytes, folder: Path) -> str:
    """What came of a file: "read", "refused", or the fault.

    A fault is a foreign error, a message of several lines, or a number that is not finite in what was read.
    """
    try:
        found = reader.read(data, folder)
    except ClearanceError as error:
        return "refused" if "\n" not in str(error) else "message of several lines"
    except MemoryError:
        return "out of memory"
    except RecursionError:
        return "RecursionError"
    except Exception as error:
        return _foreign(error)
    place = not_finite(found)
    return f"not finite: {place}" if place else "read"


def _foreign(error: Exception) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    ours = [one for one in frames if "clearance" in Path(one.filename).parts]
    inner = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}" if ours else frames[-1].name
    return f"{type(error).__name__} at {inner}: {error!s:.60}"


def not_finite(found: object) -> str:
    """Where a NaN or an infinity stands in what was read; empty if nowhere."""
    for i, (place, value) in enumerate(_values(found)):
        if i >= MOST_VALUES:
            break
        if isinstance(value, float) and not np.isfinite(value):
            return place
        if (
            isinstance(value, np.ndarray)
            and value.dtype.kind == "f"
            and not np.isfinite(value).all()
        ):
            return place
    return ""


def _values(found: object) -> Iterator[tuple[str, Any]]:
    """Every value in dataclasses, tuples, lists and mappings, and the name that it stands under."""
    pending: list[tuple[str, Any]] = [(type(found).__name__, found)]
    seen: set[int] = set()
    while pending:
        place, value = pending.pop()
        yield place, value
        if id(value) in seen or isinstance(value, str | bytes | np.ndarray | int | float):
            continue
        seen.add(id(value))
        pending += [
            (f"{place}.{name}", one) for name, one in _parts(value) if name not in MAY_BE_INFINITE
        ]


def _parts(value: object) -> list[tuple[str, Any]]:
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
        return [(name, getattr(value, name)) for name in names if hasattr(value, name)]
    if hasattr(value, "_asdict"):
        return list(value._asdict().items())
    if isinstance(value, dict):
        return [(str(name), one) for name, one in value.items()]
    if isinstance(value, list | tuple):
        return [("", one) for one in value]
    if hasattr(value, "model_dump"):
        return [(name, getattr(value, name)) for name in type(value).model_fields]
    return []
