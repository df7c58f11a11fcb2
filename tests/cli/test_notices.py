"""Commands without a verdict write what is suspect to the error output."""

import pytest

from clearance.cli import run
from tests.formats.making import CASE, write_case


@pytest.fixture
def asked(tmp_path, capsys):
    """The error output of `profile sweep` on a case whose times are in milliseconds."""

    def ask(case: str, *options: str) -> str:
        path = write_case(tmp_path, case, trajectory="time,shoulder\n0,0\n900,0.5\n")
        arguments = [
            "profile",
            "sweep",
            str(path),
            "--plane",
            "xy",
            "--out",
            str(tmp_path / "s.svg"),
            *options,
        ]
        assert run(arguments) == 0
        return capsys.readouterr().err

    return ask


def test_a_sweep_says_what_is_suspect(asked):
    assert "suspect: small: CHECK UNITS: no joint moves faster" in asked(CASE)


def test_but_not_what_the_case_accepts_nor_when_it_is_to_be_quiet(asked):
    assert "CHECK UNITS" not in asked(CASE + "accept: [units]\n")
    assert "CHECK UNITS" not in asked(CASE, "--quiet")
