"""Cases as tests of pytest: `*.clearance.yaml` is collected, one test a rule, and a fixture checks a case by path.

Nothing that measures is imported before a case is. Not for: what a case comes to (`run`), nor JUnit of a check
(`report.junit`).
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from clearance.pytest_plugin.assertion import assert_clear

if TYPE_CHECKING:
    from clearance.pytest_plugin.collected import CaseListFile
    from clearance.run import Run

__all__ = ["assert_clear", "clearance_case"]

SUFFIXES = (".clearance.yaml", ".clearance.yml")

NEEDS = ("steps", "pairs", "limit", "minimum")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options."""
    group = parser.getgroup("clearance", "how close robots come to anything")
    group.addoption(
        "--clearance-need",
        choices=NEEDS,
        default="limit",
        help="What is asked of each case, as --need of `clearance check`; default: limit",
    )
    group.addoption(
        "--clearance-out",
        metavar="DIR",
        help="Write the report of each case into a folder of its own here",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> CaseListFile | None:
    """The tests of a file that is called so."""
    if not file_path.name.endswith(SUFFIXES):
        return None
    from clearance.pytest_plugin.collected import CaseListFile

    return CaseListFile.from_parent(parent, path=file_path)


@pytest.fixture
def clearance_case(request: pytest.FixtureRequest) -> Callable[[str | PathLike[str]], Run]:
    """A function from the path of a case file, seen from the test's folder, to its run."""

    def checked(path: str | PathLike[str]) -> Run:
        from clearance.pytest_plugin.checked import check_case

        return check_case(request.path.parent / path, request.config)

    return checked
