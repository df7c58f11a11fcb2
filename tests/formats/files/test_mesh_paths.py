"""Where `package://` leads: folders above the URDF, ROS's variables, and never in silence to another file."""

import os
from pathlib import Path

import pytest

from clearance.errors import MissingFile
from clearance.formats.files import mesh_paths
from clearance.formats.files.input_files import InputFiles
from clearance.world.notice import Severity
from tests.formats.making import cube_stl
from tests.formats.making_urdf import collision, link, load_robot, robot
from tests.formats.refusal import refusal

ASKED = robot(link(collision('<mesh filename="package://arms/meshes/part.stl"/>')))


@pytest.fixture(autouse=True)
def no_ros(monkeypatch):
    for name in mesh_paths.VARIABLES:
        monkeypatch.delenv(name, raising=False)


def part(*places):
    """A mesh at the end of each path."""
    for place in places:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(cube_stl())


@pytest.mark.parametrize(
    ("urdf_in", "variable", "value", "place"),
    [
        ("arms/urdf/deep", "", "", "arms"),
        ("other/urdf", "", "", "arms"),
        ("case", "ROS_PACKAGE_PATH", "{}/none:{}/ws/src", "ws/src/arms"),
        ("case", "ROS_PACKAGE_PATH", "{}/ws/src/arms", "ws/src/arms"),
        ("case", "AMENT_PREFIX_PATH", "{}/none:{}/install", "install/share/arms"),
        ("case", "GZ_SIM_RESOURCE_PATH", "{}/none:{}/models", "models/arms"),
        ("case", "GAZEBO_MODEL_PATH", "{}/none:{}/models", "models/arms"),
    ],
)
def test_the_package_is_found_above_the_urdf_or_by_ros_variables(
    tmp_path, monkeypatch, urdf_in, variable, value, place
):
    if variable:
        monkeypatch.setenv(variable, value.format(tmp_path, tmp_path))
    folder = tmp_path / urdf_in
    folder.mkdir(parents=True)
    part(tmp_path / place / "meshes" / "part.stl")
    found = load_robot(folder, ASKED)
    shown = Path(os.path.relpath(tmp_path / place / "meshes" / "part.stl", folder)).as_posix()
    assert found.bodies[0].origin == shown and found.notices == ()
    told = f"${variable} leads to package://arms/meshes/part.stl as {shown}"
    assert found.notes == (told,) * bool(variable)


def test_a_file_of_the_same_name_stands_in_as_suspect_input_that_names_both(tmp_path):
    part(tmp_path / "meshes" / "part.stl", tmp_path / "meshes" / "end.stl")
    two = collision('<mesh filename="package://arms/meshes/part.stl"/>')
    two += collision('<mesh filename="package://arms/meshes/end.stl"/>')
    (notice,) = load_robot(tmp_path, robot(link(two))).notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "package")
    assert notice.text == (
        "CHECK PACKAGE: package 'arms' was not found: package://arms/meshes/part.stl is taken from meshes/part.stl"
        ", and 1 more in the same way; is it the same file? give the package's folder in package_dirs"
    )


def test_an_error_lists_where_it_looked(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/opt/ws/src")
    (tmp_path / "given").mkdir()
    told = refusal(load_robot, tmp_path, ASKED, [tmp_path / "given"], of=MissingFile)
    assert "there is no mesh 'package://arms/meshes/part.stl'" in told
    above = f"in the file's folder and the {len(tmp_path.parents)} above it"
    assert f"robot.package_dirs ('given'), {above}" in told
    assert "$ROS_PACKAGE_PATH (/opt/ws/src) and $AMENT_PREFIX_PATH (not set)" in told


@pytest.mark.parametrize("place", ["package:/", "file:///root/share"])
def test_an_error_says_that_the_package_is_here_without_the_file(tmp_path, place):
    package(tmp_path / "given")
    (tmp_path / "given/meshes/part.stl").rename(tmp_path / "given/meshes/renamed.stl")
    assert "package 'arms' is here, without meshes/part.stl: is it of another version?" in refusal(
        load_robot, tmp_path, ASKED.replace("package:/", place), [tmp_path], of=MissingFile
    )


def package(folder, name="arms"):
    """A package with its manifest and a mesh."""
    part(folder / "meshes" / "part.stl")
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")


@pytest.mark.parametrize("place", ["ws/src/robots/arm_files", "ws/install/arms/share/arms"])
def test_a_workspace_is_searched_all_the_way_down(tmp_path, place):
    (tmp_path / "case").mkdir()
    package(tmp_path / place)
    part(tmp_path / "ws" / "build" / "arms" / "meshes" / "part.stl")
    (tmp_path / "ws" / "install" / "other").mkdir(parents=True, exist_ok=True)
    found = load_robot(tmp_path / "case", ASKED, [tmp_path / "ws"])
    assert found.bodies[0].origin == f"../{place}/meshes/part.stl" and found.notices == ()
    asked = "arms", tmp_path / "case", [tmp_path / "ws"]
    assert mesh_paths.package_folder(*asked).path == tmp_path / place


@pytest.mark.parametrize(
    "before", ["file:///home/jane/ws/src", "/home/jane/ws/src", "file://localhost/opt"]
)
def test_a_path_of_another_machine_is_looked_for_by_its_package(tmp_path, before):
    given = f"{before}/arms/meshes/part.stl"
    asked = robot(link(collision(f'<mesh filename="{given}"/>')))
    folder = tmp_path / "case"
    folder.mkdir()
    told = refusal(load_robot, folder, asked, of=MissingFile)
    assert "there is no mesh " in told and "; give the folder of its package" in told
    package(tmp_path / "here" / "arms-2")
    found = load_robot(folder, asked, [tmp_path / "here"])
    shown = "../here/arms-2/meshes/part.stl"
    assert found.bodies[0].origin == shown and found.notices == ()
    told = f"path of another machine, found in the same package here: {given} is read from {shown}"
    assert found.notes == (told,)


@pytest.mark.parametrize("given", ["arms", "."])
def test_the_folder_that_a_suspect_path_asks_for_settles_it(tmp_path, given):
    part(tmp_path / "arms" / "meshes" / "part.stl")
    asked = robot(link(collision('<mesh filename="file:///home/jane/arms/meshes/part.stl"/>')))
    (notice,) = load_robot(tmp_path, asked).notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "package")
    told = "file:///home/jane/arms/meshes/part.stl is taken from arms/meshes/part.stl"
    assert told in notice.text
    assert load_robot(tmp_path, asked, [tmp_path / given]).notices == ()


def test_a_pointer_of_git_lfs_is_named_as_such(tmp_path):
    part(tmp_path / "arms" / "meshes" / "part.stl")
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"
    (tmp_path / "arms" / "meshes" / "part.stl").write_bytes(pointer)
    with pytest.raises(MissingFile, match=r"part\.stl' is a pointer of git LFS.*; git lfs pull"):
        load_robot(tmp_path, ASKED)
    (tmp_path / "path.csv").write_bytes(pointer)
    with pytest.raises(MissingFile, match=r"'path\.csv' is a pointer of git LFS"):
        InputFiles(tmp_path).unread(tmp_path / "path.csv")
