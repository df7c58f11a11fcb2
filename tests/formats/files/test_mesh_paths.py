"""Where `package://` leads: folders above the URDF, ROS's variables, and never in silence to another file."""

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
    ("urdf_in", "origin"),
    [("arms/urdf/deep", "../../meshes/part.stl"), ("other/urdf", "../../arms/meshes/part.stl")],
)
def test_the_package_is_found_above_the_urdf_or_beside_folders_above_it(tmp_path, urdf_in, origin):
    folder = tmp_path / urdf_in
    folder.mkdir(parents=True)
    part(tmp_path / "arms" / "meshes" / "part.stl")
    found = load_robot(folder, ASKED)
    assert found.bodies[0].origin == origin
    assert found.notices == ()


def test_a_folder_of_another_name_is_the_package_that_its_manifest_names(tmp_path):
    folder = tmp_path / "arms-2.1" / "urdf"
    folder.mkdir(parents=True)
    (tmp_path / "arms-2.1" / "package.xml").write_text("<package><name> arms </name></package>")
    part(tmp_path / "arms-2.1" / "meshes" / "part.stl")
    found = load_robot(folder, ASKED)
    assert found.bodies[0].origin == "../meshes/part.stl"
    assert found.notices == ()


@pytest.mark.parametrize(
    ("variable", "value", "place"),
    [
        ("ROS_PACKAGE_PATH", "{}/none:{}/ws/src", "ws/src/arms"),
        ("ROS_PACKAGE_PATH", "{}/ws/src/arms", "ws/src/arms"),
        ("AMENT_PREFIX_PATH", "{}/none:{}/install", "install/share/arms"),
        ("GZ_SIM_RESOURCE_PATH", "{}/none:{}/models", "models/arms"),
        ("GAZEBO_MODEL_PATH", "{}/none:{}/models", "models/arms"),
    ],
)
def test_the_package_is_found_by_ros_variables(tmp_path, monkeypatch, variable, value, place):
    monkeypatch.setenv(variable, value.format(tmp_path, tmp_path))
    folder = tmp_path / "case"
    folder.mkdir()
    part(tmp_path / place / "meshes" / "part.stl")
    found = load_robot(folder, ASKED)
    shown = f"../{place}/meshes/part.stl"
    assert found.bodies[0].origin == shown and found.notices == ()
    assert found.notes == (f"${variable} leads to package://arms/meshes/part.stl as {shown}",)


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
    said = refusal(load_robot, tmp_path, ASKED, [tmp_path / "given"], of=MissingFile)
    told = said
    n_above = len(tmp_path.parents)
    assert "there is no mesh 'package://arms/meshes/part.stl'" in told
    assert f"robot.package_dirs ('given'), in the file's folder and the {n_above} above it" in told
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


WORKSPACES = [
    ("ws", "ws/src/robots/arm_files"),
    ("ws", "ws/install/arms/share/arms"),
]


@pytest.mark.parametrize(("given", "place"), WORKSPACES)
def test_a_workspace_is_searched_all_the_way_down(tmp_path, given, place):
    (tmp_path / "case").mkdir()
    package(tmp_path / place)
    part(tmp_path / "ws" / "build" / "arms" / "meshes" / "part.stl")
    (tmp_path / "ws" / "install" / "other").mkdir(parents=True, exist_ok=True)
    found = load_robot(tmp_path / "case", ASKED, [tmp_path / given])
    assert found.bodies[0].origin == f"../{place}/meshes/part.stl" and found.notices == ()
    asked = "arms", tmp_path / "case", [tmp_path / given]
    assert mesh_paths.package_folder(*asked).path == tmp_path / place


@pytest.mark.parametrize(
    "before", ["file:///home/jane/ws/src", "/home/jane/ws/src", "file://localhost/opt"]
)
def test_a_path_of_another_machine_is_looked_for_by_its_package(tmp_path, before):
    given = f"{before}/arms/meshes/part.stl"
    asked = robot(link(collision(f'<mesh filename="{given}"/>')))
    folder = tmp_path / "case"
    folder.mkdir()
    with pytest.raises(MissingFile, match=r"there is no mesh .*; give the folder of its package"):
        load_robot(folder, asked)
    package(tmp_path / "here" / "arms-2")
    (tmp_path / "here" / "arms-2" / "package.xml").write_text(
        "<package><name>arms</name></package>"
    )
    found = load_robot(folder, asked, [tmp_path / "here"])
    shown = "../here/arms-2/meshes/part.stl"
    assert found.bodies[0].origin == shown and found.notices == ()
    told = f"path of another machine, found in the same package here: {given} is read from {shown}"
    assert found.notes == (told,)


def test_a_folder_that_is_only_called_as_on_another_machine_is_suspect(tmp_path):
    part(tmp_path / "meshes" / "part.stl")
    asked = robot(link(collision('<mesh filename="file:///home/jane/arms/meshes/part.stl"/>')))
    (notice,) = load_robot(tmp_path, asked).notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "package")
    assert "file:///home/jane/arms/meshes/part.stl is taken from meshes/part.stl" in notice.text


@pytest.mark.parametrize("given", ["arms", "."])
def test_the_folder_that_a_suspect_path_asks_for_settles_it(tmp_path, given):
    part(tmp_path / "arms" / "meshes" / "part.stl")
    asked = robot(link(collision('<mesh filename="file:///home/jane/arms/meshes/part.stl"/>')))
    assert load_robot(tmp_path, asked).notices
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
