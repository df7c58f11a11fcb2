"""Files that never end are refused before they are read; what was looked for in several places is kept."""

import os

import pytest

from clearance.errors import MissingFile
from clearance.formats.files.found_files import MODEL, OPTIONAL, PACKAGE, leads_to, note_lookup
from clearance.formats.files.input_files import InputFiles, read_bytes
from clearance.report.topics.provenance import inputs
from tests.formats.making import ARM, cube_stl
from tests.formats.making_case import changed, load_small
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


def test_a_mesh_of_a_package_is_a_search_and_no_input_of_the_report(tmp_path):
    (tmp_path / "first").mkdir()
    (tmp_path / "last" / "pk").mkdir(parents=True)
    (tmp_path / "last" / "pk" / "m.stl").write_bytes(cube_stl())
    found_by = changed("arm.urdf", "arm.urdf, package_dirs: [first, last]")
    case = load_small(tmp_path, found_by, urdf=ARM.replace("upper.stl", "package://pk/m.stl"))
    (one,) = (source for source in case.sources if not source.is_file)
    assert leads_to(one.read_from) == one.sha256 and one.path == "(lookup) mesh package://pk/m.stl"
    read = ["arm.urdf", "case.yaml", "last/pk/m.stl", "path.csv"]
    assert [row["path"] for row in inputs(case)] == read
    (tmp_path / "first" / "pk").mkdir(parents=True)
    assert leads_to(one.read_from) == one.sha256  # the folder alone is no mesh
    (tmp_path / "first" / "pk" / "m.stl").write_bytes(cube_stl())
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
