"""Commands without a verdict write what is suspect to the error output."""

from __future__ import annotations

import pytest

from clearance.cli import run
from scripts.makers.point_sketches import irreducible, shaken, sketched
from tests.formats.making import CASE, write_case
from tests.profiles.moving import drawn


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


@pytest.fixture
def folder(tmp_path, monkeypatch):
    points, edges = irreducible(12, 3)
    sketched(points, shaken(points, 0.2, 3), edges).save(tmp_path / "cluster.yaml")
    drawn([(0, 0), (1, 0), (1, 1), (0, 1)]).save(tmp_path / "square.yaml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_fit_stops_and_names_what_does_not_hold(folder, refusal):
    asked = ["profile", "fit", "cluster.yaml", "square.yaml", "--out", "new.yaml"]
    told = refusal(*asked, "--most-seconds", 0)
    assert told.startswith("error: cluster.yaml: not solved within 0 s: distance")
    assert "a longer time limit may help" in told
    refusal(*asked, "--most-seconds", -1)
