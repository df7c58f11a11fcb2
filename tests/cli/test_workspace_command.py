"""`clearance workspace` from outside: what it prints, writes, refuses, and its exit codes."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree

import pytest

import clearance as cl
from clearance.cli import run
from clearance.geometry import boolean
from tests.cart import URDF
from tests.report.schemas import objections

CASE = """name: {name}
robot: {{urdf: cart.urdf, base: {{xyz: [{x}, 0, 0.05], rpy: [0, 0, {turn}]}}}}
scene:
  obstacles:
  - {{name: wall, box: {{size: [0.2, 1, 1]}}, pose: {{xyz: [{wall}, 0, 0]}}}}
trajectory: {{file: path.csv}}
"""

pytestmark = pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "cart.urdf").write_text(URDF)
    (tmp_path / "path.csv").write_text("time,rail\n0,-0.5\n1,0.7\n")
    rows = {
        "along": {"x": 0, "turn": 0, "wall": 3},
        "across": {"x": 0.3, "turn": 1.5707963267948966, "wall": 3},
        "away": {"x": 2, "turn": 0, "wall": 3},
    }
    for name, fields in rows.items():
        (tmp_path / f"{name}.yaml").write_text(CASE.format(name=name, **fields))
    return tmp_path


def paths(folder, *names):
    return [str(folder / f"{name}.yaml") for name in names]


def test_it_tells_and_writes_the_region(folder, capsys):
    out = folder / "out"
    assert run(["workspace", *paths(folder, "along", "across"), "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert told.startswith("shared at most 8.001 litres, about (0.300, 0.000, 0.050) m\n")
    assert "along/cart/slider - across/cart/slider" in told and "upper bound" in told
    figures = json.loads((out / "workspace.json").read_text())
    assert objections("workspace", figures) == []
    assert figures["volume"] == pytest.approx(0.008, rel=1e-6)
    for name in ("workspace.stl", "workspace.glb"):
        mesh = cl.read_mesh(out / name)
        assert mesh.closed and mesh.volume == pytest.approx(0.008, rel=1e-5)
        assert mesh.bounds.mean(axis=0) == pytest.approx([0.3, 0.0, 0.05], abs=1e-6)
    picture = ElementTree.parse(out / "workspace.svg").getroot()
    fills = [shape.get("fill") for shape in picture.iter("{http://www.w3.org/2000/svg}polygon")]
    colours = [tuple(map(int, fill[4:-1].split(","))) for fill in fills]
    red = [colour for colour in colours if colour[0] > 5 * max(colour[1:])]
    assert len(red) == 6 and len(colours) > 12, "three sides of the region face us, in two halves"


def test_nothing_shared_leaves_no_older_mesh(folder, capsys):
    out = folder / "out"
    run(["workspace", *paths(folder, "along", "across"), "--out", str(out)])
    capsys.readouterr()
    assert run(["workspace", *paths(folder, "along", "away"), "--out", str(out)]) == 0
    assert capsys.readouterr().out.startswith("nothing is shared by along/cart, away/cart\n")
    assert sorted(path.name for path in out.iterdir()) == ["workspace.json", "workspace.svg"]
    assert objections("workspace", json.loads((out / "workspace.json").read_text())) == []


@pytest.mark.parametrize(("limit", "code"), [("9", 0), ("7", 1)])
def test_a_limit_decides_the_exit_code(folder, limit, code):
    arguments = ["workspace", *paths(folder, "along", "across"), "--json", "--limit-litres", limit]
    assert run(arguments) == code


@pytest.mark.parametrize(
    ("names", "given", "told"),
    [
        (["along"], [], "1 robot is given; cases with two or more robots in all are needed"),
        (["along", "across"], ["--within-mm", "0"], "a length above 0"),
        (["along", "across"], ["--limit-litres", "-1"], "--limit-litres"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(folder, refusal, names, given, told):
    assert told in refusal("workspace", *paths(folder, *names), *given)


def test_suspect_input_is_not_nothing_shared(folder, capsys):
    away = folder / "away.yaml"
    away.write_text(away.read_text().replace("[2, 0, 0.05]", "[2000, 0, 0.05]"))
    assert run(["workspace", *paths(folder, "along", "away"), "--limit-litres", "0"]) == 2
    told = capsys.readouterr()
    assert "nothing is shared" in told.out and "suspect: away: CHECK UNITS" in told.err


def test_tolerances_and_paddings_that_widen_no_sweep_are_named_beside_the_answer(folder, capsys):
    case = folder / "along.yaml"
    case.write_text(case.read_text() + "tolerance: {base: {xyz: 0.2}}\n")
    assert run(["workspace", *paths(folder, "along", "away"), "--out", str(folder / "out")]) == 0
    first = capsys.readouterr().out.partition("\n")[0]
    assert first.endswith(", without the tolerances of the cases")
    assert json.loads((folder / "out" / "workspace.json").read_text())["without"] == "tolerances"


def test_samples_that_are_far_apart_make_the_pieces_no_wider(folder, capsys):
    """An arm that turns by 2 rad in one step is held by several pieces."""
    (folder / "arm.urdf").write_text(
        URDF.replace("prismatic", "revolute").replace('<axis xyz="1 0 0"/>', '<axis xyz="0 0 1"/>')
    )
    for name in ("along", "across"):
        path = folder / f"{name}.yaml"
        path.write_text(path.read_text().replace("cart.urdf", "arm.urdf"))
    assert run(["workspace", *paths(folder, "along", "across")]) == 0
    wider = re.search(r"wider by up to ([\d.]+) mm", capsys.readouterr().out)
    assert wider is not None and 0.0 < float(wider[1]) <= 5.0
