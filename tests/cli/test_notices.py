"""Commands without a verdict write what is suspect to the error output."""

from __future__ import annotations

import pytest

from clearance.cli import run
from tests.formats.making import CASE, write_case


@pytest.fixture
def asked(tmp_path, capsys):
    """The error output of `profile sweep` on a case whose times are in milliseconds."""

    def ask(case: str, *options: str) -> str:
        path = write_case(tmp_path, case, trajectory="time,shoulder\n0,0\n900,0.5\n")
        asked = [str(path), "--plane", "xy", "--out", str(tmp_path / "s.svg"), *options]
        assert run(["profile", "sweep", *asked]) == (0 if "accept: [units]" in case else 2)
        return capsys.readouterr().err

    return ask


def test_a_sweep_says_what_is_suspect_and_not_accepted_quiet_or_not(asked):
    assert "suspect: small: CHECK UNITS: no joint moves faster" in asked(CASE)
    assert "CHECK UNITS" not in asked(CASE + "accept: [units]\n")
    assert "suspect: small: CHECK UNITS: no joint moves faster" in asked(CASE, "--quiet")
