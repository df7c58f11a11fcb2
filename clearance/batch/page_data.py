"""What the page of a batch shows, as one JSON object of columns that is written part by part.

Numbers go as they are, texts that many cases share by number, curves as one byte a number. Not for: the page
around it (`page`).
"""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from clearance.batch.answer import STATUSES, BatchAnswer, reach_of
from clearance.batch.case_page import FOLDER, folder_of
from clearance.batch.rows import CURVE
from clearance.findings.finding import NOT_PROVEN

TOPS = 4.0
"""[-] Of the warn limit, the clearance at the top of a curve."""

ABOVE = 255
"""The byte of a clearance at the top or above."""

Members = Iterator[tuple[str, Iterable[str]]]
"""Names and values of a JSON object, the parts of each value in order."""


def object_of(members: Members) -> Iterator[str]:
    """A JSON object, part by part; a member is asked for once all of the one before is there."""
    for i, (name, parts) in enumerate(members):
        yield f"{', ' if i else '{'}{_json(name)}: "
        yield from parts
    yield "}"


def page_data(answer: BatchAnswer, place: Path) -> Members:
    """The data of a page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    rows, statuses = _Columns(answer), _statuses(answer)
    bodies, rules = _Texts(), _Texts()
    yield "store", [_json(place.name)]
    yield "statuses", [_json(statuses)]
    yield "names", rows.listed(list, "case")
    yield "status", rows.listed(lambda found: [*map(statuses.index, found)], "status")
    yield "clearance", rows.listed(_reached, "clearance", "penetration")
    yield "bound", rows.listed(_millimetres, "lower_bound")
    yield "time", rows.listed(_seconds, "time")
    yield "steps", rows.listed(list, "n_steps")
    yield "a", rows.listed(bodies.numbers, "body_a")
    yield "b", rows.listed(bodies.numbers, "body_b")
    yield "rule", rows.listed(rules.numbers, "rule")
    yield "bodies", [_json(bodies.texts)]
    yield "rules", [_json(rules.texts)]
    yield "reasons", rows.listed(lambda found: [lines or [] for lines in found], "reasons")
    yield "beside", rows.listed(lambda *both: [*map(_beside, *both)], "warnings", "waived")
    yield "waived", rows.listed(lambda found: [int(bool(lines)) for lines in found], "waived")
    yield "levels", rows.listed(_levels, "fail", "warn")
    yield "curves", _base64(map(_curves, rows.parts("curve", "warn")))
    yield "n_curve", [_json(CURVE)]
    yield "pages", rows.listed(_Pages(place).folders, "case", "key")


class _Columns:
    """Columns of the rows of an answer."""

    def __init__(self, answer: BatchAnswer) -> None:
        self._rows = answer.rows

    def parts(self, *columns: str) -> Iterator[pa.Table]:
        """Some columns of all rows, some rows after others."""
        return self._rows.parts(columns)

    def listed(self, made: Callable[..., list], *columns: str) -> Iterator[str]:
        """What is made of some columns, as one JSON array."""
        before = "["
        for part in self.parts(*columns):
            told = _json(made(*(part[name].to_pylist() for name in columns)))[1:-1]
            if told:
                yield before + told
                before = ", "
        yield "]" if before == ", " else "[]"


class _Pages:
    """The folders of the pages of cases that are written."""

    def __init__(self, place: Path) -> None:
        self._written = {path.parent.name for path in place.glob(f"{FOLDER}/*/report.html")}

    def folders(self, names: list[str], keys: list[str | None]) -> list[str]:
        """That of each case; empty where it has none."""
        pairs = zip(names, keys, strict=True) if self._written else ()
        found = [folder_of(name, key) if key else "" for name, key in pairs]
        return [folder if folder.rpartition("/")[2] in self._written else "" for folder in found]


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False)


def _base64(parts: Iterable[bytes]) -> Iterator[str]:
    """Bytes as a JSON string."""
    yield '"'
    left = b""
    for part in parts:
        left += part
        n_whole = len(left) // 3 * 3
        yield base64.b64encode(left[:n_whole]).decode()
        left = left[n_whole:]
    yield base64.b64encode(left).decode() + '"'


def _statuses(answer: BatchAnswer) -> list[str]:
    """All statuses, the better before the worse; "not proven" only where tolerances made a case so."""
    return [one for one in STATUSES if one != NOT_PROVEN or one in answer.counts]


def _beside(warnings: list[str] | None, waived: list[str] | None) -> list[str]:
    return [f"warning: {line}" for line in warnings or ()] + [
        f"waived: {line}" for line in waived or ()
    ]


class _Texts:
    """Texts by number, each once."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    @property
    def texts(self) -> list[str]:
        return list(self._numbers)

    def numbers(self, texts: Sequence[str | None]) -> list[int]:
        """The number of each text; -1 for none."""
        of = self._numbers
        return [-1 if text is None else of.setdefault(text, len(of)) for text in texts]


def _seconds(values: Sequence[float | None]) -> list[float | None]:
    return [None if value is None else round(value, 3) for value in values]


def _reached(
    clearances: Sequence[float | None], penetrations: Sequence[float | None]
) -> list[float | None]:
    """[mm] The clearances, below 0 by how deep bodies in contact are."""
    return _millimetres([*map(reach_of, clearances, penetrations)])


def _millimetres(lengths: Sequence[float | None]) -> list[float | None]:
    """[mm] to a thousandth, rounded down."""
    return [
        None if length is None or not np.isfinite(length) else float(np.floor(length * 1e6) / 1e3)
        for length in lengths
    ]


def _top(warn: float | None) -> float:
    """[m] The clearance at the top of a curve."""
    return TOPS * warn if warn else 0.1


def _levels(fails: Sequence[float | None], warns: Sequence[float | None]) -> list[list[float]]:
    """How high the two limits lie in each curve, from 0 to 1."""
    return [
        [round((level or 0.0) / _top(warn), 3) for level in (fail, warn)]
        for fail, warn in zip(fails, warns, strict=True)
    ]


def _curves(part: pa.Table) -> bytes:
    """The curves of some rows, `CURVE` bytes each: 1 + the height, 0 where there is none."""
    column = part["curve"].combine_chunks()
    n_each = pc.fill_null(pc.list_value_length(column), 0).to_numpy()
    values = pc.list_flatten(column).to_numpy().astype(np.float64)
    heights = np.zeros((len(n_each), CURVE), dtype=np.uint8)
    drawn = n_each > 0
    begins = (np.cumsum(n_each) - n_each)[drawn, np.newaxis]
    found = values[begins + np.arange(CURVE) * n_each[drawn, np.newaxis] // CURVE]
    tops = np.array([*map(_top, part["warn"].to_pylist())])[drawn, np.newaxis]
    heights[drawn] = 1 + np.clip(found / tops, 0.0, 1.0) * (ABOVE - 1)
    return heights.tobytes()
