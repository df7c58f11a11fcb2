"""Files that never end are refused before they are read; what was looked for in several places is kept."""

import os

import pytest
import trimesh

from clearance.case.case_file import load_case
from clearance.errors import MissingFile
from clearance.formats.files.found_files import MODEL, OPTIONAL, PACKAGE, leads_to, note_lookup
from clearance.formats.files.input_files import InputFiles, read_bytes
from clearance.report.topics.provenance import inputs
from tests.formats.refusal import refusal


@pytest.mark.parametrize("name", ["/dev/zero", "pipe"])
def test_pipes_and_devices_are_refused_without_waiting(tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / name
    files = InputFiles(tmp_path)
    for read in (
        lambda: read_bytes(path, name),
        lambda: files.read(path),
        lambda: files.unread(path),
    ):
        assert "is a pipe or a device; a path to a file on disk" in refusal(read, of=MissingFile)


URDF = """<robot name="cart"><link name="ground"/>
  <link name="slider"><collision><geometry><mesh filename="package://pk/m.stl"/></geometry></collision></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="slider"/>
    <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="9" velocity="9"/></joint></robot>"""

CASE = """robot: {urdf: cart.urdf, package_dirs: [first, last]}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}
trajectory: t.csv
limits: {fail: 0.05}
"""


def searched(sources):
    return [one for one in sources if not one.is_file]


def test_a_mesh_of_a_package_is_a_search_and_no_input_of_the_report(tmp_path):
    (tmp_path / "cart.urdf").write_text(URDF)
    (tmp_path / "case.yaml").write_text(CASE)
    (tmp_path / "t.csv").write_text("time,rail\n0,0\n1,0.1\n")
    (tmp_path / "first").mkdir()
    (tmp_path / "last" / "pk").mkdir(parents=True)
    trimesh.creation.box([0.2] * 3).export(tmp_path / "last" / "pk" / "m.stl")
    case = load_case(tmp_path / "case.yaml")
    (one,) = searched(case.sources)
    assert leads_to(one.read_from) == one.sha256 and one.path == "(lookup) mesh package://pk/m.stl"
    assert [row["path"] for row in inputs(case)] == [
        "cart.urdf",
        "case.yaml",
        "last/pk/m.stl",
        "t.csv",
    ]
    (tmp_path / "first" / "pk").mkdir(parents=True)
    assert leads_to(one.read_from) == one.sha256  # the folder alone is no mesh
    trimesh.creation.box([0.2] * 3).export(tmp_path / "first" / "pk" / "m.stl")
    assert leads_to(one.read_from) != one.sha256


def noted(folder, *asked):
    files = InputFiles(folder)
    note_lookup(files, *asked)
    return files.sources


def test_a_search_that_leads_nowhere_has_a_hash_too_which_a_receipt_asks_for(tmp_path):
    (one,) = noted(tmp_path, OPTIONAL, "model.config", tmp_path, (), None)
    assert len(one.sha256) == 64 and leads_to(one.read_from) == one.sha256
    (tmp_path / "model.config").write_text("")
    assert leads_to(one.read_from) != one.sha256


def test_the_folder_of_a_package_is_a_search_and_a_plain_path_is_none(tmp_path):
    (tmp_path / "last" / "pk").mkdir(parents=True)
    dirs = (tmp_path / "first", tmp_path / "last")
    (one,) = noted(tmp_path, PACKAGE, "pk", tmp_path, dirs, tmp_path / "last" / "pk")
    assert leads_to(one.read_from) == one.sha256
    (tmp_path / "first" / "pk").mkdir(parents=True)
    assert leads_to(one.read_from) != one.sha256
    assert noted(tmp_path, MODEL, "sun/model.sdf", tmp_path, (), tmp_path) == ()
