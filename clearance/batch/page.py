"""The page of a batch: all cases in one table that sorts and filters, in one file that needs no network.

Numbers go as columns, curves as one byte a number, and only the rows that are in view are drawn: 10,000 cases are
2.5 MB and open at once. Not for: its data (`page_data`), and the page of one case (`report.page`).
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from clearance.batch.answer import STATUSES, BatchAnswer
from clearance.batch.case_page import FOLDER, folder_of
from clearance.batch.rows import CURVE, ERROR
from clearance.findings.finding import NOT_PROVEN
from clearance.record.status import Status
from clearance.record.wording import NOISE, count
from clearance.report.curves import millimetres
from clearance.report.rendering import render

TOPS = 4.0
"""[-] Of the warn limit, the clearance at the top of a curve."""

ABOVE = 255
"""The byte of a clearance at the top or above."""


def page_of(answer: BatchAnswer, place: Path) -> str:
    """The whole page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    return render(
        "batch.html",
        title=f"{place.name}: {_headline(answer)}",
        name=place.name,
        verdict=_headline(answer),
        shade=answer.shade,
        lines=[*answer.reservations, *answer.waiver_faults],
        beside=_beside(answer),
        data=page_data(answer, place),
    )


def unfinished_page(name: str, text: str) -> str:
    """The page of a batch that has no answer yet."""
    return render("batch_unfinished.html", title=f"{name}: not finished", name=name, text=text)


def _headline(answer: BatchAnswer) -> str:
    return f"{count(answer.n_cases, 'case')}: {answer.counted}"


def _beside(answer: BatchAnswer) -> str:
    counts = ((answer.n_waived, "with waivers"), (len(answer.warned), "with warnings"))
    return ", ".join(f"{n:,} {what}" for n, what in counts if n)


def page_data(answer: BatchAnswer, place: Path) -> dict[str, Any]:
    """The data of a page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    column, statuses = answer.column, _statuses(answer)
    reached = np.array(answer.reached, dtype=float)
    bodies, rules, headlines = _Texts(), _Texts(), _Texts()
    return {
        "store": place.name,
        "statuses": statuses,
        "names": column("case"),
        "status": [*map(statuses.index, column("status"))],
        "headline": headlines.numbers(_badges(answer)),
        "headlines": headlines.texts,
        "shade": [shade or ERROR for shade in column("shade")],
        "touches": [int(measured == Status.CONTACT) for measured in column("measured")],
        "clearance": millimetres(np.where(reached < 0.0, reached * (1.0 - NOISE), reached)),
        "bound": millimetres(np.array(column("proven"), dtype=float)),
        "time": [None if time is None else round(time, 3) for time in column("time")],
        "steps": column("n_steps"),
        "a": bodies.numbers(column("body_a")),
        "b": bodies.numbers(column("body_b")),
        "rule": rules.numbers(column("rule")),
        "bodies": bodies.texts,
        "rules": rules.texts,
        "reasons": [lines or [] for lines in column("reasons")],
        "notes": [lines or [] for lines in column("reservations")],
        "levels": _levels(column("fail"), column("warn")),
        "curves": base64.b64encode(_curves(answer.rows)).decode(),
        "n_curve": CURVE,
        "pages": _Pages(place).folders(column("case"), column("key")),
    }


class _Pages:
    """The folders of the pages of cases that are written."""

    def __init__(self, place: Path) -> None:
        self._written = {path.parent.name for path in place.glob(f"{FOLDER}/*/report.html")}

    def folders(self, names: list[str], keys: list[str | None]) -> list[str]:
        """That of each case; empty where it has none."""
        pairs = zip(names, keys, strict=True) if self._written else ()
        found = [folder_of(name, key) if key else "" for name, key in pairs]
        return [folder if folder.rpartition("/")[2] in self._written else "" for folder in found]


def _statuses(answer: BatchAnswer) -> list[str]:
    """All statuses, the better before the worse; "not proven" only where tolerances made a case so."""
    return [one for one in STATUSES if one != NOT_PROVEN or one in answer.counts]


def _badges(answer: BatchAnswer) -> list[str]:
    """The headline of each case; of one without an answer its status."""
    rows = zip(answer.column("status"), answer.column("text"), strict=True)
    return [ERROR if status == ERROR else text for status, text in rows]


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
