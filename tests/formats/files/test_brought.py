"""Robots that installed packages bring: by name and by path, listed, and refused in one line."""

from __future__ import annotations

import sys

import pytest

from clearance.cli import run
from clearance.errors import MissingFile, Unavailable
from clearance.formats.files.brought import brought_path
from clearance.formats.files.input_files import InputFiles, path_from, resolved
from tests.formats.refusal import refusal

LINKS = '<link name="base"/><link name="tip">{collision}</link>'
JOINT = '<joint name="j" type="{kind}"><parent link="base"/><child link="tip"/></joint>'
MESH = '<collision><geometry><mesh filename="package://example-robot-data/{file}"/></geometry></collision>'
BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'

STL = b"\0" * 80 + (7).to_bytes(4, "little") + b"\0" * 350
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1//1 2//1 3//1 4//1\n"
DAMAGED = MESH.format(file="robots/a/x.dae")
OFF = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"


def urdf(collision: str = "", kind: str = "revolute") -> str:
    return f'<robot name="r">{LINKS.format(collision=collision)}{JOINT.format(kind=kind)}</robot>'


@pytest.fixture
def robots(tmp_path, monkeypatch):
    """The folder of a package with robots; no other package brings any."""
    share = tmp_path / "site" / "cmeel.prefix" / "share" / "example-robot-data"
    meshes = "".join(MESH.format(file=f"robots/link.{kind}") for kind in ("stl", "obj", "off"))
    for path, text in {
        "ur/ur5_robot.urdf": urdf(meshes + MESH.format(file="robots/none.stl") + BOX),
        "ur/ur3.urdf": urdf(), "ur/ur3_robot.urdf": urdf(BOX), "a/twin.urdf": urdf(DAMAGED),
        "b/twin.urdf": urdf(), "c/model.urdf": urdf(), "c/table.urdf": urdf(BOX, "fixed"),
        "c/broken.urdf": "<robot", "link.obj": OBJ, "link.off": OFF, "a/x.dae": "<COLLADA",
    }.items():  # fmt: skip
        (share / "robots" / path).parent.mkdir(parents=True, exist_ok=True)
        (share / "robots" / path).write_text(text)
    (share / "robots" / "link.stl").write_bytes(STL)
    monkeypatch.setattr(sys, "path", [str(tmp_path / "site"), *sys.path])
    monkeypatch.setitem(sys.modules, "pybullet_data", None)
    return share / "robots"


@pytest.mark.parametrize(
    ("name", "path"), [("ur5", "ur/ur5_robot.urdf"), ("robots/c/model.urdf", "c/model.urdf")]
)
def test_a_robot_is_called_by_its_file_or_path(robots, tmp_path, name, path):
    given = f"example-robot-data:{name}"
    found = resolved(given, tmp_path)
    assert found == robots / path and path_from(tmp_path, given) == given
    assert InputFiles(tmp_path).shown(found) == f"example-robot-data:robots/{path}"


@pytest.mark.parametrize(
    ("given", "fault", "says"),
    [
        ("example-robot-data:ur4", MissingFile, "brings no robot 'ur4'; did you mean 'ur"),
        ("example-robot-data:robots/c/modle.urdf", MissingFile,
         "brings no file 'robots/c/modle.urdf'; did you mean 'robots/c/model.urdf'? "
         "(`clearance robots example-robot-data` lists its robots)"),
        ("example-robot-data:twin", MissingFile, "any of several; one of robots/a/twin.urdf, robots/b/"),
        ("robot_descriptions:panda", Unavailable, "needs the package robot_descriptions; pip install"),
    ],
)  # fmt: skip
def test_a_name_of_none_or_of_several_is_refused(robots, given, fault, says):
    assert says in refusal(brought_path, given, of=fault)


LISTED = """\
example-robot-data:robots/a/twin.urdf      2 links  meshes that cannot be read
example-robot-data:robots/b/twin.urdf      2 links  no collision shapes
example-robot-data:robots/c/model.urdf     2 links  no collision shapes
example-robot-data:ur3                     2 links  no collision shapes
example-robot-data:ur3_robot               2 links  1 round or box shape
example-robot-data:ur5                     2 links  12 triangles, 1 round or box shape, 1 mesh file missing
"""


def test_the_robots_of_packages_are_listed(robots, capsys):
    """7 triangles of STL, 3 of OBJ and 2 of OFF: faces of four corners are two each."""
    assert run(["robots"]) == 0
    told = capsys.readouterr()
    assert told.out == LISTED
    assert "not here: pybullet_data (pip install 'clearance[simulate]')" in told.err
    assert run(["robots", "ur", "5"]) == 0
    assert capsys.readouterr().out.startswith("example-robot-data:ur5 ")


def test_clones_of_a_package_are_found_where_it_keeps_them(robots, tmp_path, monkeypatch):
    (tmp_path / "site" / "robot_descriptions").mkdir()
    (tmp_path / "site" / "robot_descriptions" / "__init__.py").touch()
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path / "none"))
    with pytest.raises(Unavailable, match="fetched no robot yet: robot_descriptions pull NAME"):
        brought_path("robot_descriptions:ur5")
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(robots))
    for name in ("ur5", "ur5_description"):  # the package's own name of it, too
        assert brought_path(f"robot_descriptions:{name}") == robots / "ur" / "ur5_robot.urdf"
    with pytest.raises(MissingFile, match="`robot_descriptions pull NAME` fetches another"):
        brought_path("robot_descriptions:panda")
