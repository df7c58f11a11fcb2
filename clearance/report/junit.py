"""JUnit XML of anything that has test cases: a run, a batch, and a run that has no answer yet.

Which cases there are is in `junit_cases` and `batch.output`; here they are written. Not for: judging anything.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from clearance.files import written_file

MOST_BYTES = 28 * 2**20
"""Of the cases together; build servers refuse files of 30 MB."""

MOST_LETTERS = 2000
"""Of a name or a message; what is longer is cut."""

LEFT_OUT = "cases_left_out"
"""The property that says how many cases a file has no room for."""

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no room for, escaped or not."""

_AS_THEY_ARE = {"\n": "&#10;", "\t": "&#9;", "\r": "&#13;"}
"""Signs that a reader turns into spaces where they stand in an attribute."""


@dataclass(frozen=True)
class TestResult:
    """One test case.

    Attributes:
        group: of several that belong together. fault: the kind of failure; empty where it does not fail.
        errs: whether that is an error, of a case that has no answer.
    """

    __test__ = False

    group: str
    name: str
    text: str = ""
    fault: str = ""
    skipped: bool = False
    errs: bool = False

    @property
    def outcome(self) -> str:
        """The element that says how it stands."""
        if self.fault:
            return "error" if self.errs else "failure"
        return "skipped" if self.skipped else "system-out"


def write_junit(
    suite: str, results: Sequence[TestResult], path: Path, properties: Mapping[str, str]
) -> None:
    """Writes a suite of test cases, the same bytes for the same cases.

    Where there are more than build servers read, the last are left out, those that fail after all others, and a
    property says how many.

    Raises:
        Unwritable: the file cannot be written; an older one is left as it was.
    """
    fitting = _that_fit(results)
    n_left_out = len(results) - len(fitting)
    all_properties = dict(properties) | ({LEFT_OUT: str(n_left_out)} if n_left_out else {})
    with written_file(path) as file:
        for part in _parts(suite, fitting, all_properties):
            file.write(part.encode())


def write_unfinished(suite: str, text: str, path: Path, fault: str = "Incomplete") -> None:
    """Writes the file of a run that has no answer, or none yet, so that an older one, green perhaps, is not taken
    for its answer: one case that is an error, and says why.

    Raises:
        Unwritable: as `write_junit`.
    """
    write_junit(suite, [TestResult("verdict", "finished", text, fault, errs=True)], path, {})


def _parts(
    suite: str, results: Sequence[TestResult], properties: Mapping[str, str]
) -> Iterator[str]:
    n = Counter(result.outcome for result in results)
    counted = f'tests="{len(results)}" failures="{n["failure"]}" errors="{n["error"]}" skipped="{n["skipped"]}"'
    yield f'<?xml version="1.0" encoding="utf-8"?>\n<testsuites {counted}>\n'
    yield f"<testsuite name={_quoted(suite)} {counted}>\n"
    if properties:
        rows = (f"<property name={_quoted(k)} value={_quoted(v)}/>" for k, v in properties.items())
        yield f"<properties>{''.join(rows)}</properties>\n"
    for result, name in _named(results):
        yield f"{_case(result, name)}\n"
    yield "</testsuite>\n</testsuites>\n"


def _case(result: TestResult, name: str) -> str:
    begin = f"<testcase classname={_quoted(result.group)} name={_quoted(name)}"
    if not result.text:
        return f"{begin}/>"
    kind = f"type={_quoted(result.fault)} " if result.fault else ""
    body = f"<{result.outcome} {kind}message={_quoted(result.text)}/>"
    if result.outcome == "system-out":
        body = f"<system-out>{escape(shown(result.text))}</system-out>"
    return f"{begin}>{body}</testcase>"


def _that_fit(results: Sequence[TestResult]) -> Sequence[TestResult]:
    """The results that a file has room for, in their order; those that fail are the last to be left out."""
    n_free, fitting = MOST_BYTES, set()
    for i in sorted(range(len(results)), key=lambda i: (not results[i].fault, i)):
        n_free -= len(_case(results[i], results[i].name).encode()) + 16
        if n_free < 0:
            break
        fitting.add(i)
    return [result for i, result in enumerate(results) if i in fitting]


def _named(results: Iterable[TestResult]) -> Iterator[tuple[TestResult, str]]:
    """Each result with a name that no other of its group has."""
    n_of: Counter[tuple[str, str]] = Counter()
    for result in results:
        group, name = shown(result.group), shown(result.name)
        n_of[group, name] += 1
        number = n_of[group, name]
        while number > 1 and n_of[group, f"{name} ({number})"]:
            number += 1
        numbered = name if number == 1 else f"{name} ({number})"
        n_of[group, numbered] += number > 1
        yield result, numbered


def shown(text: str) -> str:
    """A text that XML can hold; what it cannot is written as its escape, such as \\uffff."""
    found = _NO_XML.sub(lambda part: part[0].encode("unicode_escape").decode(), text)
    return found if len(found) <= MOST_LETTERS else f"{found[: MOST_LETTERS - 1]}…"


def _quoted(text: str) -> str:
    return quoteattr(shown(text), _AS_THEY_ARE)
