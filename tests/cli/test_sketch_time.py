"""Commands say which sketch is not solved in time, and what of it does not hold."""

from __future__ import annotations

import pytest

from clearance.cli import run
from clearance.sketch import Sketch
from scripts.makers.point_sketches import irreducible, shaken, sketched


@pytest.fixture
def folder(tmp_path, monkeypatch):
    points, edges = irreducible(12, 3)
    sketched(points, shaken(points, 0.2, 3), edges).save(tmp_path / "cluster.yaml")
    square = Sketch()
    corners = [square.point(*place) for place in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        square.segment(a, b)
    square.save(tmp_path / "square.yaml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_fit_stops_and_names_what_does_not_hold(folder, capsys):
    asked = ["profile", "fit", "cluster.yaml", "square.yaml", "--out", "new.yaml"]
    assert run([*asked, "--most-seconds", "0"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: cluster.yaml: not solved within 0 s: distance")
    assert "a longer time limit may help" in told and told.count("\n") == 1
    assert not (folder / "new.yaml").exists()
    assert run([*asked, "--most-seconds", "-1"]) == 2
