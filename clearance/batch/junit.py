"""A batch as JUnit XML: one test case for each case of the batch, under its own name.

It stays below `MOST_BYTES`: where all cases do not go in, those that pass are left out, then failing ones from the
end, and what is left out is counted in a property. Not for: one case in detail (`report.junit`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import accumulate, islice, takewhile
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from clearance.batch.answer import FAULT, BatchAnswer
from clearance.batch.rows import ERROR

MOST_BYTES = 29_000_000
"""Build servers refuse files from 30 MB on."""

MOST_TEXT = 2000
"""Letters of what is told of one case."""

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_COLUMNS = ["case", "status", "exit_code", "text", "reasons", "waived"]


def junit_of(answer: BatchAnswer, name: str) -> Iterator[str]:
    """The file's content, part by part.

    Args:
        name: of the suite.
    """
    n_all = len(answer.stale) + answer.n_cases
    n_shown = _n_that_fit(_in_order(answer))
    is_cut = n_shown < n_all
    if is_cut:
        n_shown = _n_that_fit(_failing_first(answer))
    n_errors = answer.counts.get(ERROR, 0)
    n_failed = answer.n_failing - n_errors + len(answer.stale)
    told = f'tests="{n_shown}" failures="{n_failed}" errors="{n_errors}" skipped="0"'
    code = f'<property name="exit_code" value="{answer.exit_code}"/>'
    left_out = f'<property name="left_out" value="{n_all - n_shown}"/>'
    yield f'<?xml version="1.0" encoding="utf-8"?>\n<testsuites {told}>\n'
    yield f"<testsuite name={_quoted(name)} {told}>\n"
    yield f"<properties>{code}{left_out}</properties>\n"
    shown = _failing_first(answer) if is_cut else _in_order(answer)
    for case in islice(shown, n_shown):
        yield f"{case}\n"
    yield "</testsuite>\n</testsuites>\n"


def _n_that_fit(cases: Iterable[str]) -> int:
    """How many of some cases, from the first on, go into a file."""
    ends = accumulate(len(case.encode()) + 1 for case in cases)
    return sum(1 for _ in takewhile(lambda end: end + 1000 <= MOST_BYTES, ends))


def _in_order(answer: BatchAnswer) -> Iterator[str]:
    yield from map(_stale, answer.stale)
    yield from map(_case, _rows(answer))


def _failing_first(answer: BatchAnswer) -> Iterator[str]:
    yield from map(_stale, answer.stale)
    yield from (_case(row) for row in _rows(answer) if row["exit_code"])
    yield from (_case(row) for row in _rows(answer) if not row["exit_code"])


def _rows(answer: BatchAnswer) -> Iterator[dict[str, Any]]:
    yield from answer.rows.select(_COLUMNS).to_pylist()


def _case(row: dict[str, Any]) -> str:
    begin = f'<testcase classname="batch" name={_quoted(row["case"])}'
    if not row["exit_code"]:
        waived = "; ".join(f"waived: {line}" for line in row["waived"] or ())[:MOST_TEXT]
        told = f"<system-out>{escape(clean(waived))}</system-out>"
        return f"{begin}>{told}</testcase>" if waived else f"{begin}/>"
    tag = "error" if row["status"] == ERROR else "failure"
    kind = {ERROR: "BadInput", "suspect": "SuspectInput"}.get(row["status"], "NotPassed")
    kind = "Fault" if row["exit_code"] == FAULT else kind
    text = "; ".join(row["reasons"] or [row["text"]])[:MOST_TEXT]
    return f'{begin}><{tag} type="{kind}" message={_quoted(text)}/></testcase>'


def _stale(text: str) -> str:
    """The case of a waiver that should go."""
    name, failure = (
        _quoted(text[:MOST_TEXT]),
        f'<failure type="StaleWaiver" message={_quoted(text)}/>',
    )
    return f'<testcase classname="waiver" name={name}>{failure}</testcase>'


def _quoted(text: str) -> str:
    return quoteattr(clean(text), {"\n": "&#10;", "\t": "&#9;", "\r": "&#13;"})


def clean(text: str) -> str:
    """The text with characters that XML cannot hold as their escapes."""
    return _NO_XML.sub(lambda found: found[0].encode("unicode_escape").decode(), text)
