"""MoveIt's scenes that are wrong, cut off or damaged: one line with the place, and only our own errors."""

import pytest

from clearance.errors import BadInput
from tests.formats.making_moveit import SECOND, content_of

OBJECT = "world: {collision_objects: [{id: a, header: {frame_id: base}, %s}]}\n"
SPHERE = "primitives: [{type: sphere, dimensions: [1]}]"


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (OBJECT % "id: b", "cell.yaml: line 1: key 'id' is there twice"),
        ("world: {collision_objects: [1]}", "collision_objects[0]: 1 is given; a mapping"),
        (OBJECT % "operation: 0", "'a': it has no shape"),
        (OBJECT % f"operation: 1, {SPHERE}", "'a': operation: 1 is given; ADD (0)"),
        (OBJECT % "planes: [{coef: [0, 0, 1, 0]}]", "planes: a plane, which has no end"),
        (OBJECT % "primitives: [{type: 4, dimensions: [1, 1]}]", "a cone is not read"),
        (OBJECT % "primitives: [{type: 1, dimensions: [1]}]", "1 dimensions of a box; 3"),
        (OBJECT % f"{SPHERE}, primitive_poses: [{{}}, {{}}]", "2 primitive_poses of 1 primitives"),
        (OBJECT % f"{SPHERE}, pose: {{orientation: [1, 1, 0, 0]}}", "orientation: the quaternion"),
        (
            OBJECT % "meshes: [{vertices: [[0, 0, 0]], triangles: [[0, 0, 1]]}]",
            "triangle [0, 0, 1] of 1 vertices",
        ),
        (OBJECT % "meshes: [{resource: none.stl}]", "there is no mesh 'none.stl'"),
        (OBJECT % SPHERE + "fixed_frame_transforms: [{child_frame_id: map}]", "frames 'base' and 'map' are used"),
        (
            "world: {octomap: {octomap: {id: ColorOcTree, resolution: 0.1, binary: true, data: [1]}}}",
            "world: octomap: an octomap of kind 'ColorOcTree' is not read; OcTree",
        ),
        (
            OBJECT % SPHERE + "link_scale: [{link_name: l, scale: 1.1}]",
            "link_scale[0]: link 'l' is scaled by 1.1",
        ),
        (
            OBJECT % SPHERE + "allowed_collision_matrix: {entry_names: [a], entry_values: [[2]]}",
            "allowed_collision_matrix: entry_values: [2] is given; true or false",
        ),
        (OBJECT % SPHERE + "allowed_collision_matrix: {entry_names: [a]}", "0 entry_values of 1 entry_names"),
        (
            "robot_state: {attached_collision_objects: [{link_name: l, object: {id: a, header: {frame_id: w}}}]}",
            "attached_collision_objects[0]: it is given in 'w', not in its link; frame_id: l",
        ),
    ],
)  # fmt: skip
def test_a_fault_is_one_line_with_its_field(tmp_path, document, says):
    with pytest.raises(BadInput) as caught:
        content_of(tmp_path, document)
    told = str(caught.value)
    assert told.startswith("cell.yaml: ") and says in told and "\n" not in told


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("sphere\n0.25", "cone\n1 2", "'post': a cone is not read"),
        ("sphere\n0.25", "blob\n1", "line 6: 'post': 'blob' is no shape; sphere, box"),
        ("0.25", "0.2 5", "line 7: 'post': '0.2 5' is given; the dimensions of a sphere: 1 numbers"),
        ("0.25", "O.25", "line 7: 'post': 'O.25' is not a number"),
        ("* ball", "ball", "line 15: 'ball' is given; * and the object's name"),
        ("* ball", "*", "line 15: '*' is given"),
        (".\n", ".\nmore", "there is more behind the point"),
        ("1\nsphere\n0.25", "9999\nsphere\n0.25", "how many shapes, as many as there are"),
    ],
)  # fmt: skip
def test_a_fault_of_text_is_one_line_with_its_line(tmp_path, old, new, says):
    document = SECOND[: -len(old)] + new if old == ".\n" else SECOND.replace(old, new, 1)
    with pytest.raises(BadInput) as caught:
        content_of(tmp_path, document, "cell.scene")
    told = str(caught.value)
    assert told.startswith("cell.scene: ") and says in told and "\n" not in told
