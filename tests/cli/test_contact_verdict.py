"""`clearance check` of a path that hits something tells how deep, which way out, and how much is shared."""

from __future__ import annotations

import pytest

from clearance.cli import run
from tests.cart import write_cart

CASE = """name: rail
robot: {urdf: cart.urdf}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}
trajectory: {file: path.csv}
"""


@pytest.fixture
def folder(tmp_path):
    write_cart(tmp_path, CASE, "time,rail\n0,0.5\n1,0.8125\n2,0.85\n3,0.75\n")
    return tmp_path


def test_the_verdict_names_the_deepest_contact(folder, capsys):
    assert run(["check", str(folder / "case.yaml")]) == 1
    told = capsys.readouterr().out
    assert told.startswith("CONTACT")
    line = "step 2, slider in wall: 50.00 mm deep, 2000 cm³ shared; separation vector of the link"
    assert f"{line} (-50.00, 0.00, 0.00) mm" in told


def test_the_headline_says_how_deep(folder, capsys):
    """The deepest of two, though the other comes first in time and by name."""
    scene = "  - {name: a, box: {size: [0.2, 1, 1]}, pose: {xyz: [0.2, 0, 0]}}\n"
    (folder / "case.yaml").write_text(CASE.replace("obstacles:\n", "obstacles:\n" + scene))
    (folder / "path.csv").write_text("time,rail\n0,0.395\n1,0.5\n2,0.8125\n3,0.5\n")
    case = str(folder / "case.yaml")
    assert run(["check", case]) == 1
    assert capsys.readouterr().out.startswith(
        "CONTACT 12.50 mm deep: slider - wall at 2.000 s, step 2 (rail)\n"
    )
    assert run(["check", case, "--contact", "none"]) == 1
    assert capsys.readouterr().out.startswith(
        "CONTACT (depth not computed): slider - a at 0.000 s, step 0 (rail)\n"
    )
