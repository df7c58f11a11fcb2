"""Where `package://` leads: folders above the URDF, ROS's variables, and never in silence to another file."""

import pytest

from clearance.errors import MissingFile
from clearance.load.files import mesh_paths
from clearance.world.notice import Severity
from tests.load.making import cube_stl
from tests.load.making_urdf import collision, link, load_urdf, robot

ASKED = robot(link(collision('<mesh filename="package://arms/meshes/part.stl"/>')))


@pytest.fixture(autouse=True)
def no_ros(monkeypatch):
    for name in mesh_paths._VARIABLES:
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
    found = load_urdf(folder, ASKED)
    assert found.bodies[0].origin == origin
    assert found.notices == ()


def test_a_folder_of_another_name_is_the_package_that_its_manifest_names(tmp_path):
    folder = tmp_path / "arms-2.1" / "urdf"
    folder.mkdir(parents=True)
    (tmp_path / "arms-2.1" / "package.xml").write_text("<package><name> arms </name></package>")
    part(tmp_path / "arms-2.1" / "meshes" / "part.stl")
    found = load_urdf(folder, ASKED)
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
    found = load_urdf(folder, ASKED)
    shown = f"../{place}/meshes/part.stl"
    assert found.bodies[0].origin == shown and found.notices == ()
    assert found.notes == (f"${variable} leads to package://arms/meshes/part.stl as {shown}",)


def test_a_file_of_the_same_name_stands_in_as_suspect_input_that_names_both(tmp_path):
    part(tmp_path / "meshes" / "part.stl", tmp_path / "meshes" / "end.stl")
    two = collision('<mesh filename="package://arms/meshes/part.stl"/>')
    two += collision('<mesh filename="package://arms/meshes/end.stl"/>')
    (notice,) = load_urdf(tmp_path, robot(link(two))).notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "package")
    assert notice.text == (
        "CHECK PACKAGE: package 'arms' is not there: package://arms/meshes/part.stl is taken from meshes/part.stl"
        ", and 1 more likewise; is it the same file? give the package's folder in package_dirs"
    )


def test_the_package_itself_comes_before_a_file_of_the_same_name(tmp_path):
    given = tmp_path / "given"
    part(given / "meshes" / "part.stl", tmp_path / "arms" / "meshes" / "part.stl")
    found = load_urdf(tmp_path, ASKED, [given])
    assert found.bodies[0].origin == "arms/meshes/part.stl"
    assert found.notices == ()


def test_an_error_lists_where_it_looked(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/opt/ws/src")
    (tmp_path / "given").mkdir()
    with pytest.raises(MissingFile) as caught:
        load_urdf(tmp_path, ASKED, [tmp_path / "given"])
    told = str(caught.value)
    n_above = len(tmp_path.parents)
    assert "there is no mesh 'package://arms/meshes/part.stl'" in told
    assert f"robot.package_dirs ('given'), in the file's folder and the {n_above} above it" in told
    assert "$ROS_PACKAGE_PATH (/opt/ws/src) and $AMENT_PREFIX_PATH (not set)" in told
    assert "\n" not in told
