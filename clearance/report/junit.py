"""The record as JUnit XML, so that a build server shows a violated limit as a failed test.

Which cases there are is in `junit_cases`; here they are written. Not for: judging anything.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from clearance.extras import importing
from clearance.findings.verdict import Verdict
from clearance.report.folder import write_file
from clearance.report.junit_cases import TestResult, results_of
from clearance.report.report_data import ReportData

if TYPE_CHECKING:
    import junitparser

MOST_BYTES = 28 * 2**20
"""Of the cases together; build servers refuse files of 30 MB."""

MOST_LETTERS = 2000
"""Of a name or a message; what is longer is cut."""

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no room for, escaped or not."""


def write_junit(data: ReportData, path: str | Path) -> None:
    """Writes one test case for the verdict, and one for each thing that can fail by itself.

    What is waived is skipped, with who waives it and why. Where there are more cases than build servers read, the
    last are left out, those that fail after all others; a property of the suite says how many.

    Raises:
        Unavailable: junitparser is missing. Unwritable: the file cannot be written; an older one is left as it
            was.
    """
    with importing("report", "--junit"):
        import junitparser

    verdict, results = data.verdict, [*results_of(data)]
    kept = _that_fit(results)
    suite = junitparser.TestSuite(_shown(data.record.case.name))
    for name, value in _properties(verdict, len(results) - len(kept)).items():
        suite.add_property(name, _shown(value))
    suite.add_testcases([_case(result, name) for result, name in _named(kept)])
    root = junitparser.JUnitXml()
    root.add_testsuite(suite)
    root.update_statistics()
    write_file(Path(path), _text(root))


def _text(root: junitparser.JUnitXml) -> bytes:
    """The document, a line a case, and with nothing in it that depends on time."""
    head, tail = b'<?xml version="1.0" encoding="utf-8"?>\n', b"\n"
    content = root.tostring()
    for tag in (b"<testsuite ", b"<testcase ", b"<properties", b"</testsuite>", b"</testsuites>"):
        content = content.replace(tag, b"\n" + tag)
    return head + content + tail


def _properties(verdict: Verdict, n_left_out: int) -> dict[str, str]:
    told = {
        "verdict": verdict.status,
        "basis": verdict.basis,
        "exit_code": str(verdict.exit_code),
        "not_checked": ", ".join(verdict.not_checked),
    }
    told |= {"self_clearance": "; ".join(verdict.self_clearance)} if verdict.self_clearance else {}
    told |= {"clocks": verdict.clocks} if verdict.clocks else {}
    return told | ({"cases_left_out": str(n_left_out)} if n_left_out else {})


def _that_fit(results: list[TestResult]) -> list[TestResult]:
    """The results that a file has room for, in their order; those that fail are the last to be left out."""
    room, kept = MOST_BYTES, set()
    for i in sorted(range(len(results)), key=lambda i: (not results[i].fault, i)):
        room -= _size(results[i])
        if room < 0:
            break
        kept.add(i)
    return [result for i, result in enumerate(results) if i in kept]


def _size(result: TestResult) -> int:
    """[bytes] at most, in XML."""
    texts = [result.group, result.name, result.text]
    return 200 + sum(len(quoteattr(_shown(text)).encode()) for text in texts)


def _named(results: Iterable[TestResult]) -> Iterator[tuple[TestResult, str]]:
    """Each result with a name that no other of its group has."""
    taken: Counter[tuple[str, str]] = Counter()
    for result in results:
        group, name = _shown(result.group), _shown(result.name)
        taken[group, name] += 1
        number = taken[group, name]
        while number > 1 and taken[group, f"{name} ({number})"]:
            number += 1
        told = name if number == 1 else f"{name} ({number})"
        taken[group, told] += number > 1
        yield result, told


def _case(result: TestResult, name: str) -> junitparser.TestCase:
    import junitparser

    case = junitparser.TestCase(name, _shown(result.group))
    if result.fault:
        case.result = junitparser.Failure(_shown(result.text), result.fault)
    elif result.skipped:
        case.result = junitparser.Skipped(_shown(result.text))
    else:
        case.system_out = _shown(result.text)
    return case


def _shown(text: str) -> str:
    """A text that XML can hold; what it cannot is written as its escape, such as \\uffff."""
    found = _NO_XML.sub(lambda part: part[0].encode("unicode_escape").decode(), text)
    return found if len(found) <= MOST_LETTERS else f"{found[: MOST_LETTERS - 1]}…"
