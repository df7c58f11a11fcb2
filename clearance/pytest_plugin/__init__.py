"""Cases as tests of pytest: `*.clearance.yaml` is collected, one test a rule, and a fixture checks a case by path.

Nothing that measures is imported before a case is. Not for: what a case comes to (`run`), nor JUnit of a check
(`report.junit_cases`).
"""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from clearance.errors import BadInput, ClearanceError
from clearance.options import SWITCH, Option, flag_of, options_in
from clearance.pytest_plugin.assertion import assert_clear
from clearance.run.options import CASE_SUFFIXES, USUAL, CheckOptions

if TYPE_CHECKING:
    from clearance.pytest_plugin.collected import CaseListFile
    from clearance.run import Run

__all__ = ["assert_clear", "clearance_case"]

PREFIX = "clearance_"
"""Of an option among all of pytest's."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options."""
    group = parser.getgroup("clearance", "how close robots come to anything")
    for name, one in options_in(CheckOptions).items():
        if one.said:
            _add(group, name, one, USUAL.get(name, one.default))
    group.addoption(
        "--clearance-out",
        metavar="DIR",
        help="Write the report of each case into a folder of its own here",
    )


def _add(group: pytest.OptionGroup, name: str, known: Option, default: Any) -> None:
    """Adds an option of a check: `--clearance-` and what the command line calls it."""
    flag, place = f"--clearance-{flag_of(name, known)}", f"{PREFIX}{name}"
    if known.sort is SWITCH:
        text = known.help.replace("%", "%%")
        group.addoption(flag, dest=place, action="store_const", const=True, help=text)
        if known.off:
            off = f"--clearance-{known.off.replace('_', '-')}"
            group.addoption(off, dest=place, action="store_const", const=False, help=text)
        return
    usual = "" if default in (None, ()) else f"  [default: {known.sort.shown(default)}]"
    group.addoption(
        flag,
        dest=place,
        action="append" if known.many else "store",
        type=partial(_read, known),
        metavar=known.sort.form,
        help=f"{known.help}{usual}".replace("%", "%%"),
    )


def _read(known: Option, text: str) -> Any:
    try:
        return known.sort.read(text)
    except BadInput as error:
        raise ArgumentTypeError(str(error)) from None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> CaseListFile | None:
    """The tests of a file that is called so."""
    if not file_path.name.endswith(CASE_SUFFIXES):
        return None
    from clearance.pytest_plugin.collected import CaseListFile

    return CaseListFile.from_parent(parent, path=file_path)


@pytest.fixture
def clearance_case(request: pytest.FixtureRequest) -> Callable[[str | PathLike[str]], Run]:
    """A function from the path of a case file, seen from the test's folder, to its run."""

    def checked(path: str | PathLike[str]) -> Run:
        from clearance.pytest_plugin.collected import check_case

        __tracebackhide__ = True
        try:
            return check_case(request.path.parent / path, request.config)
        except ClearanceError as error:  # the frame of the test is enough
            raise error.with_traceback(None) from None

    return checked
