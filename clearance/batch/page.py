"""The page of a batch: all cases in one table that sorts and filters, in one file that needs no network.

Numbers go as columns, curves as one byte a number, and only the rows that are in view are drawn: 10,000 cases are
2 MB and open at once. Not for: the page of one case (`report.page`).
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from markupsafe import escape

from clearance import __version__
from clearance.batch.answer import STATUSES, BatchAnswer
from clearance.batch.case_page import FOLDER, folder_of
from clearance.batch.rows import CURVE
from clearance.findings.finding import NOT_PROVEN
from clearance.report.head import head_of
from clearance.report.wording import count

_HERE = Path(__file__).parent

_NOT_PROVEN = ".tag.not { background: var(--violated); }\n"

TOPS = 4.0
"""[-] Of the warn limit, the clearance at the top of a curve."""

ABOVE = 255
"""The byte of a clearance at the top or above."""


def page_of(answer: BatchAnswer, place: Path) -> str:
    """The whole page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    return Template(_own("page.html")).substitute(
        head=head_of(
            f"{place.name}: {_counted(answer)}",
            _own("page.css") + (_NOT_PROVEN if NOT_PROVEN in answer.counts else ""),
        ),
        name=escape(place.name),
        verdict=escape(_counted(answer)),
        worst=answer.status.split()[0],
        basis=escape("; ".join([_basis(answer), *answer.stale])),
        version=escape(__version__),
        data=json.dumps(_data(answer, place), allow_nan=False).replace("<", "\\u003c"),
        script=re.sub(r"</(?=script)", r"<\\/", _own("page.js"), flags=re.IGNORECASE),
    )


def unfinished_page(name: str, text: str) -> str:
    """The page of a batch that has no answer yet."""
    head = head_of(f"{name}: not finished")
    return Template(_own("unfinished.html")).substitute(
        head=head, name=escape(name), text=escape(text), version=escape(__version__)
    )


def _counted(answer: BatchAnswer) -> str:
    told = ", ".join(f"{n:,} {status}" for status, n in reversed(answer.counts.items()))
    return f"{count(answer.cases.num_rows, 'case')}: {told or 'none'}"


def _basis(answer: BatchAnswer) -> str:
    told = {"motion": "proven for the motion", "samples": "looked at the samples only"}
    parts = [f"{n:,} {told[basis]}" for basis, n in answer.bases.items()] or ["nothing measured"]
    for column, what in (("waived", "with waivers"), ("warnings", "with warnings")):
        if n := answer.n_with(column):
            parts.append(f"{n:,} {what}")
    return ", ".join(parts)


def _data(answer: BatchAnswer, place: Path) -> dict[str, Any]:
    table = answer.cases
    names, statuses = table["case"].to_pylist(), _statuses(answer)
    bodies, rules = _Texts(), _Texts()
    keys = table["key"].to_pylist()
    written = {path.parent.name for path in place.glob(f"{FOLDER}/*/report.html")}
    pages = zip(names, keys, strict=True) if written else ()
    folders = [folder_of(name, key) if key else "" for name, key in pages]
    return {
        "store": place.name,
        "statuses": statuses,
        "names": names,
        "status": [statuses.index(status) for status in table["status"].to_pylist()],
        "clearance": _millimetres(table["clearance"].to_pylist()),
        "bound": _millimetres(table["lower_bound"].to_pylist()),
        "time": _rounded(table["time"].to_pylist(), 3),
        "steps": table["n_steps"].to_pylist(),
        "a": bodies.numbers(table["body_a"].to_pylist()),
        "b": bodies.numbers(table["body_b"].to_pylist()),
        "rule": rules.numbers(table["rule"].to_pylist()),
        "bodies": bodies.texts,
        "rules": rules.texts,
        "reasons": [lines or [] for lines in table["reasons"].to_pylist()],
        "beside": [*map(_beside, *(table[name].to_pylist() for name in ("warnings", "waived")))],
        "levels": _levels(table["fail"].to_pylist(), table["warn"].to_pylist()),
        "curves": _curves(table["curve"].to_pylist(), table["warn"].to_pylist()),
        "n_curve": CURVE,
        "pages": [folder if folder.rpartition("/")[2] in written else "" for folder in folders],
    }


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


def _rounded(values: Sequence[float | None], digits: int) -> list[float | None]:
    return [None if value is None else round(value, digits) for value in values]


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


def _curves(curves: Sequence[list[float] | None], warns: Sequence[float | None]) -> str:
    """All curves, `CURVE` bytes each, as base64: 1 + the height, 0 where there is none."""
    heights = np.zeros((len(curves), CURVE), dtype=np.uint8)
    for row, curve, warn in zip(heights, curves, warns, strict=True):
        if curve:
            values = np.array(curve)[np.arange(CURVE) * len(curve) // CURVE]
            row[:] = 1 + np.clip(values / _top(warn), 0.0, 1.0) * (ABOVE - 1)
    return base64.b64encode(heights.tobytes()).decode()


def _own(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
