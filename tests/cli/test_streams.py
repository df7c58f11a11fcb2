"""Standard streams that are closed, full or not read, and names that cannot be: one line, 2 or 141, never 70."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from clearance.cli import run
from tests.cart import ROOT, write_cart

pytestmark = [
    pytest.mark.cold,
    pytest.mark.skipif(not Path("/dev/full").exists(), reason="other shells and devices"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cart(tmp_path_factory.mktemp("streams")).parent


def ended(folder: Path, line: str, **environment: str) -> tuple[int, str]:
    """The exit code of the command in a shell's line, in which it is `clearance`, and stderr but for progress."""
    command = f'clearance() {{ "{sys.executable}" -m clearance "$@"; }}; {line}'
    done = subprocess.run(
        ["bash", "-c", command], cwd=folder, capture_output=True, text=True, errors="surrogateescape",
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
    )  # fmt: skip
    return done.returncode, told_in(done.stderr)


def told_in(stderr: str) -> str:
    """What a command writes; on a busy machine lines on its progress come in between."""
    return re.sub(r"(?m)^.*, \d+ s so far\n", "", stderr)


def test_a_closed_output_is_told_in_one_line(folder: Path) -> None:
    code, told = ended(folder, "clearance check case.yaml --json >&-")
    assert (code, told.count("\n")) == (2, 1), told
    assert told.startswith("error: the output cannot be written: not writable")
    assert sorted(path.name for path in folder.iterdir()) == ["cart.urdf", "case.yaml", "path.csv"]


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("clearance check case.yaml --quiet --fail-mm 150 >/dev/full 2>/dev/full", 1),
        ("clearance check case.yaml >/dev/full 2>&1", 2),
    ],
)
def test_where_nothing_can_be_told_the_exit_code_tells(folder: Path, line: str, code: int) -> None:
    assert ended(folder, line) == (code, "")


def test_who_stops_reading_is_told_by_141(folder: Path) -> None:
    """Also where the verdict is "violated": nobody has read it. The pipe is closed before anything is written."""
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-m", "clearance", "check", "case.yaml", "--fail-mm", "150"], cwd=folder,
        stdout=writing, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    os.close(writing)
    assert (done.returncode, told_in(done.stderr)) == (141, "")


def test_what_is_written_is_not_mixed_with_what_libraries_print(
    folder: Path, tmp_path: Path
) -> None:
    """With a stream closed, the next file that is opened has its number."""
    assert (
        run(["check", str(folder / "case.yaml"), "--quiet", "--out", str(tmp_path / "whole")]) == 0
    )
    code, told = ended(
        folder, f"clearance check case.yaml --quiet --out {tmp_path}/closed <&- >&- 2>&-"
    )
    assert (code, told) == (0, "")
    for path in (tmp_path / "whole").iterdir():
        assert (tmp_path / "closed" / path.name).read_bytes() == path.read_bytes()


def test_characters_that_a_terminal_lacks_stop_nothing(folder: Path) -> None:
    assert ended(folder, "clearance check case.yaml >/dev/null", PYTHONIOENCODING="ascii") == (
        0,
        "",
    )
