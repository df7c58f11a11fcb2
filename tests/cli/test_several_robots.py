"""Commands that take cases: of several robots, and of suspect input."""

from __future__ import annotations

import json

import pytest

from clearance.case import case_file
from clearance.cli import run
from clearance.geometry import boolean
from clearance.run import CheckOptions
from tests import cells
from tests.formats.making import CASE, write_case
from tests.formats.making_cell import load_cell


@pytest.fixture
def cell(tmp_path, monkeypatch):
    """A path that reads as a cell."""
    monkeypatch.setattr(case_file, "load_case", lambda path: cells.cell(0))
    path = tmp_path / "cell.yaml"
    path.write_text("name: cell\n")
    return path


@pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")
def test_a_workspace_of_one_case(cell, tmp_path, capsys):
    out = tmp_path / "out"
    assert run(["workspace", str(cell), "--within-mm", "100", "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "not counted: what right shares with track, on which it stands" in told
    assert json.loads((out / "workspace.json").read_text())["robots"] == ["left", "right", "track"]


@pytest.mark.slow
def test_a_profile_of_the_links_of_one_robot_and_what_it_carries(cell, tmp_path, capsys):
    out = tmp_path / "left.yaml"
    options = ["--plane", "xz", "--tolerance", "10", "--per-link"]
    arguments = ["profile", "sweep", str(cell), *options, "--links", "left/*", "--out", str(out)]
    assert run(arguments) == 0
    told = capsys.readouterr().out
    bodies = [line.split(":")[0].strip() for line in told.splitlines() if line.startswith("  ")]
    assert bodies == ["left/boom", "left/tool", "part", "lid"]


@pytest.mark.parametrize(
    ("options", "levels"),
    [
        ({}, {"default": (5, 20), "own": (1, 1), "inherited": (5, 30)}),
        ({"fail": 0.025}, {"default": (25, 25), "own": (1, 1), "inherited": (25, 30)}),
        ({"fail": 0.08}, {"default": (80, 80), "own": (1, 1), "inherited": (80, 80)}),
        ({"warn": 0.09}, {"default": (5, 90), "own": (1, 1), "inherited": (5, 30)}),
    ],
)
def test_a_limit_of_the_command_line_holds_for_rules_that_give_none(tmp_path, options, levels):
    names = (
        "{name: at the",
        "{name: own, between: [right/*, post], fail: 0.001}\n    - {name: at the",
    )
    rules = *names, "{between: [workpiece", "{name: inherited, between: [workpiece"
    limits = CheckOptions(**options).apply(load_cell(tmp_path, *rules)).limits
    told = {rule.name: limits.of_rule(i) for i, rule in enumerate(limits.rules, 1)}
    told["default"] = limits.of_rule(0)
    for name, level in levels.items():
        assert (1000 * told[name].fail, 1000 * told[name].warn) == pytest.approx(level)


@pytest.fixture
def asked(tmp_path, capsys):
    """The error output of `profile sweep` on a case whose times are in milliseconds."""

    def ask(case: str, *options: str) -> str:
        path = write_case(tmp_path, case, trajectory="time,shoulder\n0,0\n900,0.5\n")
        asked = [str(path), "--plane", "xy", "--out", str(tmp_path / "s.svg"), *options]
        assert run(["profile", "sweep", *asked]) == (0 if "accept: [units]" in case else 2)
        return capsys.readouterr().err

    return ask


@pytest.mark.slow
def test_a_sweep_says_what_is_suspect_and_not_accepted_quiet_or_not(asked):
    assert "suspect: small: CHECK UNITS: no joint moves faster" in asked(CASE)
    assert "CHECK UNITS" not in asked(CASE + "accept: [units]\n")
    assert "suspect: small: CHECK UNITS: no joint moves faster" in asked(CASE, "--quiet")
