"""A batch as JUnit XML: one test case for each case of the batch, under its own name.

It stays below `MOST_BYTES`: where all cases do not go in, those that pass are left out, then failing ones from the
end, and what is left out is counted in a property. Not for: one case in detail (`report.junit`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import accumulate, takewhile
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from clearance.batch.answer import FAULT, BatchAnswer
from clearance.batch.rows import ERROR

MOST_BYTES = 29_000_000
"""Build servers refuse files from 30 MB on."""

MOST_TEXT = 2000
"""Letters of what is told of one case."""

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_COLUMNS = ("case", "status", "exit_code", "text", "reasons", "waived")


def junit_of(answer: BatchAnswer, name: str) -> bytes:
    """The file's content.

    Args:
        name: of the suite.
    """
    rows = answer.cases.select(_COLUMNS).to_pylist()
    stale = [_stale(text) for text in answer.stale]
    failing = [*stale, *(_case(row) for row in rows if row["exit_code"])]
    passing = [_case(row) for row in rows if not row["exit_code"]]
    if _length([*failing, *passing]) <= MOST_BYTES:
        shown = [*stale, *map(_case, rows)]
    else:
        shown = list(_that_fit([*failing, *passing]))
    n_errors = sum(row["status"] == ERROR for row in rows)
    n_failed = sum(bool(row["exit_code"]) for row in rows) - n_errors + len(stale)
    told = f'tests="{len(shown)}" failures="{n_failed}" errors="{n_errors}" skipped="0"'
    lines = ['<?xml version="1.0" encoding="utf-8"?>', f"<testsuites {told}>"]
    lines.append(f"<testsuite name={_quoted(name)} {told}>")
    left_out = f'<property name="left_out" value="{len(stale) + len(rows) - len(shown)}"/>'
    code = f'<property name="exit_code" value="{answer.exit_code}"/>'
    lines.append(f"<properties>{code}{left_out}</properties>")
    return "\n".join([*lines, *shown, "</testsuite>", "</testsuites>", ""]).encode()


def _length(cases: list[str]) -> int:
    return sum(len(case.encode()) + 1 for case in cases) + 1000


def _that_fit(cases: list[str]) -> Iterator[str]:
    ends = accumulate(len(case.encode()) + 1 for case in cases)
    fit = takewhile(lambda pair: pair[1] + 1000 <= MOST_BYTES, zip(cases, ends, strict=True))
    return (case for case, _ in fit)


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
