"""An older answer that a run is to write anew: marked, so that nobody reads it as the answer of that run.

A run that comes to its end replaces it; one that is stopped leaves the mark. A page says on top that it is older;
any other file, as `summary.json`, has another name. Not for: JUnit, which is written anew (`junit`), nor what
`clearance compare` refuses (`cli.run_rows`).
"""

from __future__ import annotations

import re
from pathlib import Path

from clearance.errors import unwritable
from clearance.files import LAST, write_file

OLDER_SUMMARY = "summary.older.json"
"""The name of `summary.json` while the folder is not written anew."""

_MARK = b'<header id="older">'
_NOTE = _MARK + (
    b'<div class="title"><h1>Not finished</h1><p class="verdict violated">what follows is older</p></div>'
    b'<ul class="beside"><li>A later run into this folder has not come to its end: it was refused, or it was '
    b"stopped and the same command goes on. "
    b"This page shows the run before it.</li></ul></header>\n"
)


def withdraw_report(folder: Path) -> None:
    """Marks the report in a folder as older, if there is one; a second time changes nothing.

    Raises:
        Unwritable: it cannot be marked.
    """
    withdraw_file(folder / LAST)  # first: another name needs no room on a full disk
    withdraw_page(folder / "report.html")


def is_withdrawn(folder: Path) -> bool:
    """Whether the report in a folder is an older one."""
    return (folder / OLDER_SUMMARY).is_file() and not (folder / LAST).exists()


def older_name(file: Path) -> Path:
    """The name of a file while it is not written anew."""
    return file.with_name(f"{file.stem}.older{file.suffix}")


def withdraw_file(file: Path) -> None:
    """Gives a file the name of an older one, if it is there.

    Raises:
        Unwritable: it cannot have another name.
    """
    if file.is_file():
        with unwritable(file):
            file.replace(older_name(file))


def withdraw_page(page: Path) -> None:
    """Marks a page as older, if it is there.

    Raises:
        Unwritable: it cannot be marked.
    """
    if page.is_file() and not page.is_symlink():
        content = page.read_bytes()
        marked = marked_page(content)
        if marked != content:
            write_file(page, marked)


def marked_page(content: bytes) -> bytes:
    """A page that says in its title and on top that it is older; one that says so is left as it is."""
    if _MARK in content:
        return content
    titled = content.replace(b"<title>", b"<title>Not finished: ", 1)
    return re.sub(rb"<body[^>]*>\n?", lambda found: found[0] + _NOTE, titled, count=1)
