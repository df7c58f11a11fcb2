"""MoveIt's scenes that are wrong, cut off or damaged: one line with the place, and only our own errors."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import cli
from clearance.errors import BadInput
from tests.examples import examples
from tests.formats.making import write_case
from tests.formats.making_moveit import FIRST, LISTS, MESSAGE, NAMED, SECOND, content_of

OBJECT = "world: {collision_objects: [{id: a, header: {frame_id: base}, %s}]}\n"
SPHERE = "primitives: [{type: sphere, dimensions: [1]}]"


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (OBJECT % "id: b", "cell.yaml: line 1: found duplicate key"),
        ("world: {collision_objects: [{}]}", "collision_objects[0]: 'id' is missing"),
        ("world: {collision_objects: [1]}", "collision_objects[0]: 1 is given; a mapping"),
        ("world: {collision_objects: 3}", "collision_objects: 3 is given; a list is needed"),
        ("world: 7", "cell.yaml: world: 7 is given; a mapping is needed"),
        (OBJECT % "operation: 0", "'a': it has no shape"),
        (OBJECT % f"operation: 1, {SPHERE}", "'a': operation: 1 is given; ADD (0)"),
        (OBJECT % "planes: [{coef: [0, 0, 1, 0]}]", "planes: a plane, which has no end"),
        (OBJECT % "primitives: [{type: 4, dimensions: [1, 1]}]", "a cone is not read"),
        (OBJECT % "primitives: [{type: blob, dimensions: [1]}]", "'blob' is no kind of shape"),
        (OBJECT % "primitives: [{type: 1, dimensions: [1]}]", "1 dimensions of a box; 3"),
        (OBJECT % "primitives: [{type: 2, dimensions: [0]}]", "above 0 m"),
        (OBJECT % "primitives: [{type: 2, dimensions: [.nan]}]", "a finite number"),
        (OBJECT % f"{SPHERE}, primitive_poses: [{{}}, {{}}]", "2 primitive_poses of 1 primitives"),
        (OBJECT % f"{SPHERE}, pose: {{position: [1, 2]}}", "position: [1, 2] is given; x, y, z"),
        (OBJECT % f"{SPHERE}, pose: {{orientation: [1, 1, 0, 0]}}", "orientation: the quaternion"),
        (
            OBJECT % "meshes: [{vertices: [[0, 0, 0]], triangles: [[0, 0, 1]]}]",
            "triangle [0, 0, 1] of 1 vertices",
        ),
        (OBJECT % "meshes: [{resource: none.stl}]", "there is no mesh 'none.stl'"),
        (
            OBJECT % SPHERE + "fixed_frame_transforms: [{child_frame_id: map}]",
            "frames 'base' and 'map' are used",
        ),
        (
            "world: {octomap: {octomap: {id: ColorOcTree, resolution: 0.1, binary: true, data: [1]}}}",
            "world: octomap: an octomap of kind 'ColorOcTree' is not read; OcTree",
        ),
        (
            OBJECT % SPHERE + "link_scale: [{link_name: l, scale: 1.1}]",
            "link_scale[0]: link 'l' is scaled by 1.1",
        ),
        (OBJECT % SPHERE + "link_padding: [{link_name: l, padding: -1}]", "padding is -1.0 m"),
        (
            OBJECT % SPHERE + "allowed_collision_matrix: {entry_names: [a], entry_values: [[2]]}",
            "allowed_collision_matrix: entry_values: [2] is given; true or false",
        ),
        (
            OBJECT % SPHERE + "allowed_collision_matrix: {entry_names: [a]}",
            "0 entry_values of 1 entry_names",
        ),
        (
            "robot_state: {attached_collision_objects: [{link_name: l, object: {id: a, header: {frame_id: w}}}]}",
            "attached_collision_objects[0]: it is given in 'w', not in its link; frame_id: l",
        ),
    ],
)
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
        (
            "0.25",
            "0.2 5",
            "line 7: 'post': '0.2 5' is given; the dimensions of a sphere: 1 numbers",
        ),
        ("0.25", "O.25", "line 7: 'post': 'O.25' is not a number"),
        ("* ball", "ball", "line 15: 'ball' is given; * and the object's name"),
        ("* ball", "*", "line 15: '*' is given"),
        (".\n", ".\nmore", "there is more behind the point"),
        ("1\nsphere\n0.25", "9999\nsphere\n0.25", "how many shapes, as many as there are"),
    ],
)
def test_a_fault_of_text_is_one_line_with_its_line(tmp_path, old, new, says):
    document = SECOND[: -len(old)] + new if old == ".\n" else SECOND.replace(old, new, 1)
    with pytest.raises(BadInput) as caught:
        content_of(tmp_path, document, "cell.scene")
    told = str(caught.value)
    assert told.startswith("cell.scene: ") and says in told and "\n" not in told


def only_our_own(folder, document, name):
    try:
        content_of(folder, document, name)
    except BadInput as error:
        assert str(error).startswith(name) and "\n" not in str(error)
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("document", [FIRST, SECOND], ids=["first", "second"])
def test_text_cut_off_anywhere_is_refused(tmp_path, document):
    for n in range(document.rindex(".")):
        assert not only_our_own(tmp_path, document[:n].encode(), "cell.scene")


@pytest.mark.slow
@pytest.mark.parametrize("document", [MESSAGE, LISTS], ids=["message", "lists"])
def test_messages_cut_off_anywhere_are_refused_in_one_line_or_whole(tmp_path, document):
    for n in range(0, len(document), 1 if document is LISTS else 7):
        only_our_own(tmp_path, document[:n].encode(), "cell.yaml")


@examples(100)
@given(st.data())
def test_exchanged_parts_bring_only_our_own_errors(tmp_path_factory, data):
    name, document = data.draw(
        st.sampled_from([("cell.scene", FIRST), ("cell.scene", SECOND), ("cell.yaml", LISTS)])
    )
    damaged = bytearray(document.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    only_our_own(tmp_path_factory.getbasetemp(), bytes(damaged), name)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from(["a", "", "box", "\0"]),
    lambda inner: st.lists(inner, max_size=4)
    | st.dictionaries(
        st.sampled_from(
            ["id", "primitives", "type", "dimensions", "meshes", "vertices", "triangles", "pose", "position",
             "orientation", "x", "header", "frame_id", "operation", "octomap", "data", "link_name", "object"]
        ),
        inner,
        max_size=5,
    ),
    max_leaves=20,
)  # fmt: skip


@examples(200)
@given(
    st.dictionaries(
        st.sampled_from(
            ["world", "robot_state", "allowed_collision_matrix", "fixed_frame_transforms", "link_padding",
             "link_scale"]
        ),
        VALUES | st.builds(lambda v: {"collision_objects": v, "attached_collision_objects": v}, VALUES),
        min_size=1,
    )
)  # fmt: skip
def test_values_of_any_kind_bring_only_our_own_errors(tmp_path_factory, raw):
    only_our_own(tmp_path_factory.getbasetemp(), json.dumps(raw).encode(), "cell.yaml")


def test_the_command_line_answers_with_one_line(tmp_path, capsys):
    document = OBJECT % "primitives: [{type: spere, dimensions: [1]}]"
    assert cli.run(["check", str(write_case(tmp_path, NAMED, cell__yaml=document))]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "did you mean 'sphere'?" in told
    assert "case.yaml: scene: cell.yaml: world: collision_objects[0]: 'a': primitives[0]" in told
