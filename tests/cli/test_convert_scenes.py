"""`clearance convert` of scenes: the same results from what is made, what is left out told, all files or none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.world.notice import Severity
from tests.formats.making import CASE, cube_stl, write_case
from tests.formats.making_case import TWO_JOINTS
from tests.formats.making_mjcf import mjcf, tetrahedron_stl
from tests.formats.making_moveit import FIRST, LISTS, MESSAGE
from tests.formats.making_octree import data_of, octree
from tests.formats.making_sdf import collision, link, model, pose, sdf, world

MESH = "<mesh><uri>cube.stl</uri><scale>0.1 0.1 0.1</scale></mesh>"
SDF = sdf(world(model(pose("2 0 0 0.1 0.2 0.3"), link(collision(), collision(MESH, name="d")))))
MJCF = mjcf(
    '<body name="table" pos="2 0 0" euler="0 0 30"><geom type="box" size="0.5 0.25 0.1"/>'
    '<geom type="mesh" mesh="a/turned"/><geom type="mesh" mesh="b/turned"/></body>',
    '<asset><mesh name="a/turned" file="a.stl" scale="0.1 0.2 0.3" refquat="0.5 0.5 0.5 0.5"/>'
    '<mesh name="b/turned" file="a.stl" scale="0.3 0.3 0.3" refpos="1 0 0"/></asset>',
)
OCTOMAP = (
    "world: {octomap: {octomap: {id: OcTree, binary: true, resolution: 0.1, "
    f"data: {data_of(octree({(15, 0, 2): True, (15, 1, 2): True}))}}}}}}}\n"
)
OURS = """obstacles:
- {name: "post, 2", box: {size: [0.1, 0.1, 1]}, pose: {xyz: [2, 0, 1e-3], rpy: [0.1, 0.2, 0.3]}}
- {name: cube, mesh: {file: cube.stl, scale: 0.1}, pose: {xyz: [0.9, 0.9, 0]}, padding: 0.01}
- {name: scan, points: {file: scan.xyz, radius: 0.05}}
- {name: tool, sphere: {radius: 0.02}, on: tip, pose: {xyz: [0, 0, 0.1]}}
- {name: door, box: {size: [0.5, 0.1, 1]}, moves: {file: door.csv, start: 0.25}}
"""
DOOR = "time,x,y,z,qx,qy,qz,qw\n0,-2,0,0,0,0,0,1\n1,-2,1,0,0,0,0,1\n"
SAID = """robot: {urdf: arm.urdf, padding: {upper: 0.01}}
allow: [[base, post]]
carry: [{part: tool, by: tip, from: 0.0, touch: [upper]}]
"""


@pytest.fixture(autouse=True)
def cell(tmp_path, monkeypatch):
    """A case whose scene is still to be named, and the files that scenes name."""
    write_case(tmp_path, urdf=TWO_JOINTS)
    for name in ("cube.stl", "a.stl"):
        (tmp_path / name).write_bytes(cube_stl() if name == "cube.stl" else tetrahedron_stl())
    (tmp_path / "scan.xyz").write_text("2 0 0\n2 0 1\n")
    (tmp_path / "door.csv").write_text(DOOR)
    (tmp_path / "made").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def convert(*arguments: object) -> int:
    return run(["convert", *map(str, arguments)])


def results(scene: str, said: str = "robot: {urdf: arm.urdf}\n"):
    """The run of a case that names a scene."""
    head = CASE.partition("robot:")[0]
    Path("case.yaml").write_text(f"{head}{said}scene: {scene}\ntrajectory: path.csv\n")
    return check(load_case("case.yaml"), contact="none")


def same_bytes(one, other) -> bool:
    bounds = [run.record.certificate.lower_bound for run in (one, other)]
    pairs = [[(pair.link, pair.obstacle) for pair in r.pair_minima] for r in (one, other)]
    return (
        one.record.clearances.tobytes() == other.record.clearances.tobytes()
        and bounds[0].tobytes() == bounds[1].tobytes()
        and pairs[0] == pairs[1]
        and one.record.steps.equals(other.record.steps)
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("w.sdf", SDF, ""),
        ("m.xml", MJCF, ""),
        ("held.yaml", MESSAGE, SAID),
        ("map.yaml", OCTOMAP, ""),
        ("ours.yaml", OURS, ""),
    ],
)
def test_a_case_has_the_same_bytes_of_results_with_the_scene_that_is_made(name, text, said):
    Path(name).write_text(text)
    assert convert(name, "made/scene.yaml") == 0
    theirs = results(name)
    ours = results("made/scene.yaml", *([said] if said else []))
    assert same_bytes(theirs, ours)
    assert np.isfinite(theirs.record.clearances).all()
    assert convert("made/scene.yaml", "again.yml") == 0  # ours to ours, into another folder
    assert same_bytes(ours, results("again.yml", *([said] if said else [])))


def test_meshes_of_names_that_no_file_can_have_stay_apart():
    Path("m.xml").write_text(MJCF)
    assert convert("m.xml", "made/scene.yaml") == 0
    files = sorted(path.name for path in Path("made").iterdir())
    assert files == ["m.xml.a%2fturned.off", "m.xml.b%2fturned.off", "scene.yaml"]


def test_what_a_scene_cannot_hold_is_told_with_what_a_case_says(capsys):
    Path("held.yaml").write_text(MESSAGE)
    assert convert("held.yaml", "made/scene.yaml") == 0
    told = capsys.readouterr()
    for line in (
        "note: held.yaml: the robot's state is not taken: joints are as the case says",
        "note: held.yaml: left out: which pairs may touch; a case says it: allow: [[base, post]]",
        "note: held.yaml: left out: 2 pairs of links that may touch, which srdf says",
        "note: held.yaml: left out: that links carry what rides on them; a case says it: "
        "carry: [{part: tool, by: tip, from: 0.0, touch: [upper]}]",
    ):
        assert line in told.out.splitlines()
    assert "warning: padding of links that held.yaml gives is left out" in told.err
    assert "robot: {padding: {upper: 0.01, ghost: 1.0}}" in told.err
    assert "note: held.yaml: left out: its comments" not in told.out
    text = Path("made/scene.yaml").read_text()
    assert "# - [base, post]" in text and "# - {part: tool, by: tip" in text


def test_warnings_and_the_frame_of_a_file_stay_with_the_scene(capsys):
    seen = link("<visual name='v'/>", name="seen")
    Path("w.sdf").write_text(sdf(world(model(link(collision()), seen))))
    assert convert("w.sdf", "made/scene.yaml") == 0
    assert "warning: 1 link has a visual but no collision shape" in capsys.readouterr().err
    results("made/scene.yaml")
    (notice,) = [one for one in load_case("case.yaml").notices if one.kind == "scene"]
    assert "'m/seen'" in notice.text
    Path("lists.yaml").write_text(LISTS.replace("base_link", "tip"))
    assert convert("lists.yaml", "made/scene.yaml", "--force") == 0
    results("made/scene.yaml")
    (notice,) = load_case("case.yaml").notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "frame")
    assert "frame of link 'tip'" in notice.text
    text = Path("case.yaml").read_text()
    inline = "scene: {obstacles: [{name: b, sphere: {radius: 0.1}}], frame: tip, warnings: [half]}"
    Path("case.yaml").write_text(text.replace("scene: made/scene.yaml", inline))
    assert [one.text[:4] for one in load_case("case.yaml").notices] == ["half", "CHEC"]


def test_input_that_is_suspect_is_refused(capsys):
    Path("w.sdf").write_text(sdf(world(model(pose("2 0 0 90 0 0"), link(collision())))))
    assert convert("w.sdf", "made/scene.yaml") == 2
    told = capsys.readouterr().err
    assert "CHECK UNITS: model 'm' has an angle of 90 rad" in told and "accept: [units]" in told
    assert not any(Path("made").iterdir())


def test_meshes_beside_the_scene_are_not_overwritten_unasked(refusal):
    Path("cell.scene").write_text(FIRST)
    Path("made/cell.scene.mesh0.off").write_text("mine")
    told = refusal("convert", "cell.scene", "made/scene.yaml")
    assert "made/cell.scene.mesh0.off: already exists" in told
    assert not Path("made/scene.yaml").exists()


def test_packages_of_a_scene_are_found_in_the_folders_that_are_named(capsys):
    (Path("packages") / "parts").mkdir(parents=True)
    Path("cube.stl").rename("packages/parts/cube.stl")
    uri = MESH.replace("cube.stl", "package://parts/cube.stl")
    Path("w.sdf").write_text(sdf(world(model(link(collision(uri))))))
    assert convert("w.sdf", "made/scene.yaml") == 2
    assert convert("w.sdf", "made/scene.yaml", "--package-dir", "packages") == 0
    assert "file: ../packages/parts/cube.stl" in Path("made/scene.yaml").read_text()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["cell.scene", "made/scene.csv"], "no suffix to write for a scene; one of .yaml, .yml"),
        (["cell.scene", "no/scene.yaml"], "no/scene.yaml: cannot write here: there is no such folder"),
        (["cell.scene", "made/s.yaml", "--which", "2"], "cell.scene: --which says nothing about a scene"),
        (["path.csv", "made/s.yaml", "--package-dir", "."], "--package-dir says nothing about a trajectory"),
        (["nothing.yaml", "made/s.yaml"], "nothing.yaml: there is no obstacle in it"),
        (["what.yaml", "made/s.yaml"], "the content of this file is not recognised; --kind says it: trajectory"),
        (["what.yaml", "made/s.yaml", "--kind", "scene"], "unknown key 'a'"),
        (["case.yaml", "made/s.yaml"], "this is a case file, not a trajectory, a scene or poses; `clearance"),
        (["gone.yaml", "made/s.yaml"], "no.stl"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_and_leaves_nothing(refusal, words, says):
    Path("cell.scene").write_text(FIRST)
    Path("nothing.yaml").write_text("obstacles: []\n")
    Path("what.yaml").write_text("a: 1\n")
    Path("gone.yaml").write_text("obstacles: [{name: a, mesh: {file: no.stl}}]\n")
    assert says in refusal("convert", *words)
