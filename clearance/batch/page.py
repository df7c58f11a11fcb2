"""The page of a batch: all cases in one table that sorts and filters, in one file that needs no network.

Numbers go as columns, curves as one byte a number, and only the rows that are in view are drawn: 10,000 cases are
2 MB and open at once. Not for: its data (`page_data`), and the page of one case (`report.page`).
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from string import Template

from markupsafe import escape

from clearance import __version__
from clearance.batch.answer import BASES, BatchAnswer
from clearance.batch.page_data import page_data
from clearance.record.wording import count
from clearance.report.head import head_of

_HERE = Path(__file__).parent


def page_of(answer: BatchAnswer, place: Path) -> str:
    """The whole page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    data = json.dumps(page_data(answer, place), allow_nan=False)
    return Template(_own("page.html")).substitute(
        head=head_of(
            f"{place.name}: {_counted(answer)}",
            _own("page.css"),
        ),
        name=escape(place.name),
        verdict=escape(_counted(answer)),
        worst=answer.status.split()[0],
        basis=escape("; ".join([_basis(answer), *answer.stale])),
        version=escape(__version__),
        data=data.replace("<", "\\u003c"),
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
    return f"{count(answer.n_cases, 'case')}: {told or 'none'}"


def _basis(answer: BatchAnswer) -> str:
    parts = [f"{n:,} {BASES[basis]}" for basis, n in answer.bases.items()] or ["nothing measured"]
    for n, what in ((answer.n_waived, "with waivers"), (answer.n_warned, "with warnings")):
        if n:
            parts.append(f"{n:,} {what}")
    return ", ".join(parts)


def _own(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
