"""The report beside a receipt: is it unchanged, and does a fresh run of the case give the same bytes?

The fresh run measures as `check` does, from the case's files. Not for: proving bounds (`verification`).
"""

from __future__ import annotations

import hashlib
import tempfile
from itertools import zip_longest
from pathlib import Path

from clearance.compile.library import processor
from clearance.errors import BadSyntax, MissingFile, NoReceipt, shown
from clearance.package_digest import package_digest
from clearance.receipt.receipt_file import FILE_NAME, REPORT, Receipt
from clearance.report.output import CONTENT
from clearance.report.topics.provenance import versions
from clearance.report.withdrawn import OLDER_SUMMARY
from clearance.run import Run

PAGE = "report.html"

ABSENT = "not in the folder"

MOST_LISTED, MOST_LETTERS = 3, 80
"""Differences between two programs, or files, that are named, and letters of each."""

SHOWN = 48
"""Letters of a line that differs, as shown."""


def maker() -> dict[str, str]:
    """The programs and the machine that make a report; if all are the same, so are the bytes."""
    own = {"sources": package_digest()[:16], "processor": " ".join(processor())}
    return versions() | own


def other_maker(receipt: Receipt) -> str:
    """How the programs and machine that made the report differ from these; empty if they do not."""
    recorded, own = receipt.head["maker"], maker()
    others = [
        f"{name} {recorded.get(name, 'unknown')}, here {own.get(name, 'unknown')}"
        for name in [*own, *sorted({*recorded} - {*own})]
        if recorded.get(name) != own.get(name)
    ]
    return listed(others)


def listed(names: list[str]) -> str:
    """The first of some names, and how many more there are."""
    more = [f"and {len(names) - MOST_LISTED} more"] if len(names) > MOST_LISTED else []
    return ", ".join([*(shown(text[:MOST_LETTERS]) for text in names[:MOST_LISTED]), *more])


def differences(run: Run, place: Path) -> dict[str, str]:
    """The first difference of each file between the report in a folder and the report of a run.

    The summary comes first, then the page. A file that the folder lacks is `ABSENT`.
    """
    with tempfile.TemporaryDirectory() as made:
        run.save(made)
        pairs = {
            name: (_content(place / name), _content(Path(made) / name))
            for name in reversed(CONTENT)
        }
    return {
        name: ABSENT if recorded is None else _first_difference(recorded, own)
        for name, (recorded, own) in pairs.items()
        if recorded != own
    }


def strangers(place: Path) -> list[str]:
    """The names of other files in the folder of a report; nothing is verified about these."""
    return sorted({path.name for path in place.iterdir()} - {*CONTENT, FILE_NAME})


def _first_difference(recorded: bytes, own: bytes | None) -> str:
    if own is None:
        return "the fresh run has no such file"
    if b"\0" not in recorded:
        rows = zip_longest(recorded.split(b"\n"), own.split(b"\n"), fillvalue=b"")
        for number, (there, here) in enumerate(rows, 1):
            if there != here:
                return f"line {number} is {_part(there, here)}, not {_part(here, there)}"
    return "its bytes differ"


def _part(line: bytes, other: bytes) -> str:
    """A line, from a little before its first difference to another one."""
    same = next((i for i, (a, b) in enumerate(zip(line, other, strict=False)) if a != b), 0)
    start = max(0, same - SHOWN // 2)
    text = line.strip() if len(line) <= SHOWN else line[start : start + SHOWN]
    return repr(shown(text.decode("utf-8", "replace")))


def hashes_of(folder: Path) -> dict[str, str]:
    """sha256 of each file of the report in a folder.

    Raises:
        MissingFile: there is none.
    """
    found = {name: _digest(folder / name) for name in CONTENT}
    for name in REPORT:
        if found[name] is None:
            raise _missing(folder, folder / name)
    return {name: digest for name, digest in found.items() if digest is not None}


def has_comparison(run: Run, folder: Path) -> bool:
    """Whether the page in a folder shows more than its run.

    Raises:
        BadInput: the report is that of another run.
    """
    for name, what in differences(run, folder).items():
        if name != PAGE:
            raise NoReceipt(
                f"not the report of this run: {what}",
                where=str(folder / name),
                valid="run.save(folder) first",
            )
        return True
    return False


def require_report(place: Path, receipt: Receipt) -> None:
    """Nothing, if the report beside the receipt is the one that it was written with.

    Raises:
        BadSyntax: the first file that is not. MissingFile: one that no report is without.
    """
    found, known = hashes_of(place), receipt.head["report"]
    for name, digest in found.items():
        if digest != known.get(name):
            problem = "is not as it was" if name in known else "was not there"
            raise BadSyntax(
                f"it {problem} when the receipt was written",
                where=str(place / name),
                valid="the report as that run wrote it is needed",
            )


def _content(path: Path) -> bytes | None:
    """A file's bytes; None where there is none.

    Raises:
        MissingFile: it cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise MissingFile(
            f"cannot be read: {error.strerror or error}",
            where=str(path),
            valid="the report is needed",
        ) from None


def _digest(path: Path) -> str | None:
    content = _content(path)
    return None if content is None else hashlib.sha256(content).hexdigest()


def _missing(place: Path, path: Path) -> MissingFile:
    if (place / OLDER_SUMMARY).is_file():
        return MissingFile(
            "a later run into this folder has not come to its end: its report is an older one",
            where=str(path),
            valid="a run that came to its end",
        )
    return MissingFile(
        "there is none",
        where=str(path),
        valid="the report that was saved with the receipt is needed",
    )
