"""`--tolerance` and `--unproven-ok`, and the same in Python: what they change, and what they refuse."""

import pytest

from clearance.cli import run
from tests.formats.making import CASE, write_case

TOO_MUCH = "base: {xyz: 0.4}\n"
OPEN = "limit not proven with tolerances (contact not ruled out, 5 mm required)"


@pytest.fixture
def case_file(tmp_path):
    """The nearest is some 0.45 m; its limits are 5 and 20 mm."""
    text = CASE.replace("xyz: [2, 0, 0]", "xyz: [0.8, 0, 0.5]")
    assert text != CASE
    return write_case(tmp_path, text)


def checked(capsys, *given):
    code = run(["check", *map(str, given)])
    return code, capsys.readouterr()


def test_a_limit_that_is_not_proven_fails_the_run(case_file, tmp_path, capsys):
    own = tmp_path / "t.yaml"
    own.write_text(TOO_MUCH)
    code, told = checked(capsys, case_file, "--tolerance", own)
    assert code == 1 and told.out.startswith(f"FAIL: {OPEN}")
    code, told = checked(capsys, case_file, "--tolerance", own, "--unproven-ok")
    assert code == 0 and told.out.startswith(f"ACCEPTED: {OPEN}")
    code, told = checked(capsys, case_file)
    assert code == 0 and told.out.startswith("CLEAR ")
