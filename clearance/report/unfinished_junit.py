"""JUnit XML of a run that has no answer yet, so that an older file, green perhaps, is not taken for its answer.

Not for: answers (`junit`, `batch.junit`).
"""

from __future__ import annotations

from xml.sax.saxutils import quoteattr


def unfinished_junit(suite: str, text: str) -> bytes:
    """A file with one case that is an error, and says why.

    Args:
        suite: its name; of both texts XML can hold each letter.
    """
    told = 'tests="1" failures="0" errors="1" skipped="0"'
    error = f'<error type="Incomplete" message={quoteattr(text)}/>'
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        f"<testsuites {told}>",
        f"<testsuite name={quoteattr(suite)} {told}>",
        f'<testcase classname="verdict" name="finished">{error}</testcase>',
        "</testsuite>",
        "</testsuites>",
        "",
    ]
    return "\n".join(lines).encode()
