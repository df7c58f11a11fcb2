"""`clearance check --watch`: checks again whenever a file changes that the last check has read, until Ctrl-C.

The page of the report looks for a script beside it and loads anew when that names another page: a page that lies
on disk may load scripts, and nothing else. Not for: checking (`check`).
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NoReturn

import click

from clearance.errors import ClearanceError
from clearance.files import write_file
from clearance.formats.files.input_files import FileState, files_opened, state_of
from clearance.progress import doing

EVERY = 0.5
"""[s] Between two looks at the files."""

SCRIPT = "watch.js"
PAGE = "report.html"

_MARK = b"\n<script>/* clearance check --watch */"
_POLL = """
function reportIs(page) { if (page !== "%s") location.reload(); }
setInterval(() => {
  const look = document.createElement("script");
  look.src = "watch.js?" + Date.now();
  look.onload = look.onerror = () => look.remove();
  document.head.append(look);
}, 1000);
</script>
"""


def watch(check_once: Callable[[], object], out: Path | None, *, quiet: bool) -> NoReturn:
    """Checks, and checks again at every change of a file that was read; returns never, but is interrupted.

    Args:
        out: the folder of the report, if there is one.
    """
    from clearance.record.wording import count

    try:
        while True:
            with files_opened() as opened:
                is_bad = _checked(check_once)
            publish(out)
            before = dict(opened)
            if is_bad:  # a file that is missing may come
                before |= {one.parent: state_of(one.parent) for one in opened}
            if not quiet:
                click.echo(f"watching {count(len(opened), 'file')}; Ctrl-C ends it", err=True)
            with doing(lambda: ""):
                wait_for_change(before)
    finally:
        unpublish(out)


def _checked(check_once: Callable[[], object]) -> bool:
    """Checks once; True for bad input, which is said."""
    try:
        check_once()
    except ClearanceError as error:
        click.echo(f"error: {error.line}", err=True)
        return True
    return False


def wait_for_change(before: Mapping[Path, FileState | None]) -> None:
    """Returns when a file is another than it was, and nobody writes any more."""
    now = last = before
    while now == before or now != last:
        time.sleep(EVERY)
        last, now = now, {path: state_of(path) for path in before}


def publish(out: Path | None) -> None:
    """Lets the page in a folder look for a newer one, and says which one is there."""
    page = _page_in(out)
    if page is None:
        return
    content = page.read_bytes().partition(_MARK)[0]
    name = hashlib.sha256(content).hexdigest()[:16]
    write_file(page, content + _MARK + (_POLL % name).encode())
    write_file(page.with_name(SCRIPT), f'reportIs("{name}");\n'.encode())


def unpublish(out: Path | None) -> None:
    """Leaves the page in a folder as the report has it."""
    page = _page_in(out)
    if page is not None:
        write_file(page, page.read_bytes().partition(_MARK)[0])
        page.with_name(SCRIPT).unlink(missing_ok=True)


def _page_in(out: Path | None) -> Path | None:
    page = None if out is None else out / PAGE
    return page if page is not None and page.is_file() else None
