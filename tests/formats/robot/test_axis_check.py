"""COLLADA up axes in a URDF: the ROS way by default, suspect where the shapes fit only the other way."""

import numpy as np
import pytest

from clearance.errors import BadInput
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import RobotRequest, read_robot
from clearance.world.notice import Severity
from tests.formats.making import CUBE, CUBE_TRIANGLES, binary_stl
from tests.formats.making_case import changed, load_small
from tests.formats.making_glb import document_of, glb
from tests.formats.making_meshes import collada, primitive
from tests.formats.making_urdf import joint, link, robot

BAR = CUBE * [0.1, 0.2, 1.0] + [0.0, 0.0, 0.5]
"""A bar that stands on its joint, one metre along z."""

LYING = BAR[:, [0, 2, 1]] * [1.0, 1.0, -1.0]
"""The bar as a program with y up writes it: what is turned to z up is `BAR`."""


def dae(corners: np.ndarray, up: str = "Y_UP") -> bytes:
    numbers = " ".join(map(str, corners.ravel().tolist()))
    triangles = " ".join(map(str, CUBE_TRIANGLES.ravel()))
    faces = primitive("triangles", len(CUBE_TRIANGLES), f"<p>{triangles}</p>")
    return collada(f'<unit meter="1"/><up_axis>{up}</up_axis>', numbers, faces)


def shape(kind: str, file: str) -> str:
    return f'<{kind}><geometry><mesh filename="{file}"/></geometry></{kind}>'


def load(
    folder, way="ros", geometry="collision", *, collision="bar.dae", visual="seen.stl", **files
):
    """A robot of one bar below a base, and what stands at the bar's far end."""
    files = {"seen.stl": binary_stl(BAR[CUBE_TRIANGLES])} | {
        k.replace("__", "."): v for k, v in files.items()
    }
    for name, data in files.items():
        (folder / name).write_bytes(data)
    bar = shape("collision", collision) + (shape("visual", visual) if visual else "")
    at_end = '<origin xyz="0 0 1"/><limit lower="-1" upper="1"/>'
    path = folder / "bar.urdf"
    joints = joint("j", "a", "b"), joint("k", "b", "c", inner=at_end)
    path.write_text(robot(link("", "a"), link(bar, "b"), link("", "c"), *joints))
    request = RobotRequest(path, (), geometry, way)
    return read_robot(request, MeshStore(InputFiles(folder)))


def made(corners: np.ndarray, file: str) -> dict[str, bytes | str]:
    """The bar of such corners in a file of a y-up format, as `load` takes it."""
    indices = CUBE_TRIANGLES.ravel().astype("<u2")
    data = dae(corners)
    if file.endswith("glb"):
        data = glb(*document_of(corners.astype("<f4"), indices, primitive={"indices": 1}))
    return {"collision": file, file.replace(".", "__"): data}


@pytest.mark.parametrize("file", ["bar.dae", "bar.glb"])
def test_ros_leaves_a_file_as_it_lies_and_file_turns_it(tmp_path, file):
    as_it_lies = load(tmp_path, **made(LYING, file)).bodies[0].shape.bounds
    assert as_it_lies == pytest.approx(np.array([LYING.min(axis=0), LYING.max(axis=0)]), abs=1e-7)
    turned = load(tmp_path, "file", **made(LYING, file)).bodies[0].shape.bounds
    assert turned == pytest.approx(np.array([BAR.min(axis=0), BAR.max(axis=0)]), abs=1e-7)


@pytest.mark.parametrize("file", ["bar.dae", "bar.glb"])
def test_shapes_that_lie_together_only_the_other_way_are_suspect(tmp_path, file):
    (notice,) = load(tmp_path, "ros", **made(LYING, file)).notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "axis")
    assert "shapes of 1 link lie apart with robot: {collada_up_axis: ros}" in notice.text
    assert notice.text.endswith("together with file: 'b'")
    (notice,) = load(tmp_path, "file", **made(BAR, file)).notices
    assert notice.text.endswith("together with ros: 'b'")


@pytest.mark.parametrize(
    ("way", "corners", "up"), [("ros", BAR, "Y_UP"), ("file", LYING, "Y_UP"), ("ros", BAR, "Z_UP")]
)
def test_shapes_that_lie_together_are_not(tmp_path, way, corners, up):
    assert load(tmp_path, way, bar__dae=dae(corners, up)).notices == ()


def test_where_both_shapes_turn_together_the_joints_tell(tmp_path):
    for visual in ("bar.dae", ""):
        (notice,) = load(tmp_path, "ros", visual=visual, bar__dae=dae(LYING)).notices
        assert (notice.severity, notice.kind) == (Severity.SUSPECT, "axis")
        assert notice.text.endswith("at them with file: 'b'")
        assert load(tmp_path, "file", visual=visual, bar__dae=dae(LYING)).notices == ()
        assert load(tmp_path, "ros", visual=visual, bar__dae=dae(BAR)).notices == ()


def test_a_case_chooses_the_way(tmp_path):
    urdf = robot(
        link(shape("collision", "bar.dae"), "base"),
        link("", "tip"),
        joint("shoulder", "base", "tip"),
    )
    case = changed("arm.urdf", "arm.urdf, collada_up_axis: file")
    turned = load_small(tmp_path, case, urdf=urdf, bar__dae=dae(LYING)).robots[0].robot
    assert turned.bodies[0].shape.bounds[1].tolist() == BAR.max(axis=0).tolist()
    with pytest.raises(
        BadInput, match=r"robot\.collada_up_axis: 'z' is given; 'ros' or 'file' is needed"
    ):
        load_small(tmp_path, changed("arm.urdf", "arm.urdf, collada_up_axis: z"))
