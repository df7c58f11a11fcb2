"""MoveIt's scenes: messages, robowflex's lists and `.scene` text; what they are, and what is told of the rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance import cli
from clearance.errors import BadInput
from clearance.world.pairs import measured_pairs
from clearance.world.rules import matches
from tests.examples import examples
from tests.load.making import CASE, CUBE, cube_stl, write_case
from tests.load.making_case import load_small
from tests.load.making_moveit import FIRST, LISTS, MESSAGE, SECOND, content_of, obstacles_of

NAMED = CASE.partition("scene:")[0] + "scene: cell.yaml\ntrajectory: path.csv\n"


def place(obstacle):
    return obstacle.world_from_body[:3, 3].tolist()


def test_objects_of_a_message_stand_where_they_are(tmp_path):
    made = obstacles_of(tmp_path, MESSAGE)
    assert list(made) == ["post", "tool"] and place(made["post"]) == [1, 2, 0]
    box = cl.box((0.1, 0.1, 1.0))
    assert np.array_equal(made["post"].body.shape.vertices, box.vertices)
    assert made["tool"].mount.on == "tip" and made["tool"].mount.pose[2, 3] == 0.1


def test_lists_are_read_too_and_frames_followed(tmp_path):
    made = obstacles_of(tmp_path, LISTS)
    assert {name: place(one) for name, one in made.items()} == {
        "can/0": [0.5, 0, 4],
        "can/1": [0.25, 0, 4],
    }
    can = cl.cylinder(radius=0.03, length=0.14)
    assert np.array_equal(made["can/0"].body.shape.vertices, can.vertices)
    assert np.array_equal(made["can/1"].world_from_body[:2, :2], -np.eye(2))
    notes = content_of(tmp_path, LISTS).notes
    assert notes == ("cell.yaml: frame 'base_link' is taken for the world of the case",)


def test_what_may_touch_and_padding_go_into_the_case(tmp_path):
    case = load_small(tmp_path, NAMED, cell__yaml=MESSAGE)
    rows = [row.between for row in case.allow]
    assert rows == [("base", "post")]
    assert case.robots[0].padding == {"upper": 0.01}
    told = "\n".join(case.notes)
    for said in (
        "the robot's state is not taken",
        "1 pairs of the scene's file may touch",
        "1 allowed pairs of the scene's file are left out: of two links",
        "bodies that are not there are left out: ghost",
        "padding of the scene's file is a distance",
        "padding of links that are not there is left out: 'ghost'",
    ):
        assert said in told
    assert cl.check(case).worst["clearance"] == pytest.approx(0.05, abs=0.02)


def test_what_a_robot_holds_is_carried_all_the_time(tmp_path):
    message = MESSAGE.replace("touch_links: [upper]", "touch_links: [upper, finger_of_another]")
    case = load_small(tmp_path, NAMED, cell__yaml=message)
    (carry,) = case.carries
    assert (carry.part, carry.by, carry.touch) == ("tool", "tip", ("upper",))
    assert (carry.window.start, carry.window.end) == (0.0, np.inf)
    told = "\n".join(case.notes)
    assert "attached objects of the scene's file are carried all the time: tool by tip" in told
    assert "touch_links that are not there are left out: finger_of_another" in told
    record = cl.check(case).record
    apart = {(one.link, one.obstacle) for one in record.pair_minima}
    assert apart == {("base", "tool"), ("post", "tool"), ("upper", "post")}


def test_what_the_case_carries_is_left_to_it(tmp_path):
    text = NAMED + "carry: [{part: tool, by: tip, from: 0.5, touch: ['*']}]\n"
    (carry,) = load_small(tmp_path, text, cell__yaml=MESSAGE).carries
    assert carry.window.start == 0.5 and carry.touch == ("*",)


def test_an_octomap_of_free_cells_is_no_obstacle(tmp_path):
    """One cell, of log odds -0.405 and +0.847: free, and occupied."""
    for bytes_, found in (([31, -103, -49, -66, 0], 0), ([220, 217, 88, 63, 0], 1)):
        map_ = (
            f"octomap: {{octomap: {{id: OcTree, resolution: 0.1, binary: false, data: {bytes_}}}}}"
        )
        content = content_of(tmp_path, LISTS.replace("world:", f"world:\n  {map_}"))
        names = [row["name"] for row in content.scene["obstacles"]]
        assert names.count("<octomap>") == found
        told = any("no cell of the octomap is occupied" in note for note in content.notes)
        assert told == (not found)


def test_subframes_and_the_place_of_the_robot_are_said_to_be_passed_over(tmp_path):
    document = LISTS.replace("  - id: can\n", "  - id: can\n    subframe_names: [a, b]\n") + (
        "robot_state: {multi_dof_joint_state: {joint_names: [virtual_joint]}}\n"
    )
    notes = content_of(tmp_path, document).notes
    assert (
        "cell.yaml: 2 subframes of objects are passed over: nothing here is given in them" in notes
    )
    assert any("the robot's state is not taken" in note for note in notes)


def test_an_object_held_in_a_case_of_several_robots_is_refused_by_name(tmp_path):
    robots = "".join(
        f"- {{name: {name}, urdf: arm.urdf, trajectory: path.csv}}\n" for name in ("left", "right")
    )
    text = f"robots:\n{robots}scene: cell.yaml\n"
    with pytest.raises(BadInput, match="nothing is called 'tip'; valid: left/base, left/tip"):
        load_small(tmp_path, text, cell__yaml=MESSAGE)


def test_the_padding_of_the_case_goes_before(tmp_path):
    text = NAMED.replace("arm.urdf}", 'arm.urdf, padding: {"*": 0.02}}')
    case = load_small(tmp_path, text, cell__yaml=MESSAGE)
    assert case.robots[0].padding["upper"] == 0.02


def test_rounded_quaternions_are_made_of_length_one_and_told(tmp_path):
    document = LISTS.replace("orientation: [0, 0, 1, 0]", "orientation: [0.707, 0, 0, 0.707]")
    turn = obstacles_of(tmp_path, document)["can/1"].world_from_body[:3, :3]
    assert np.abs(turn - [[1, 0, 0], [0, 0, -1], [0, 1, 0]]).max() < 1e-15
    assert content_of(tmp_path, document).notes[-1] == (
        "cell.yaml: 1 quaternion is rounded to three digits or so and made of length 1"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n", "more", "told"),
    [(200, "#" * 200_000, "or 30000 shapes"), (1000, "", "the aliases repeat too much")],
)
def test_a_file_that_names_its_parts_again_and_again_ends(tmp_path, n, more, told):
    shapes, objects = ", ".join(["*s"] * n), ", ".join(["*o"] * n)
    document = f"""robot_model_name: &s {{type: 2, dimensions: [1]}}
name: &o {{id: a, primitives: [{shapes}]}}
world: {{collision_objects: [{objects}]}}
{more}"""
    with pytest.raises(BadInput, match=told):
        content_of(tmp_path, document)


def test_an_octomap_has_a_pose_for_its_origin(tmp_path):
    map_ = "octomap: {origin: 1, octomap: {id: OcTree, resolution: 0.1, binary: false, data: [1]}}"
    with pytest.raises(BadInput, match=r"octomap: origin: 1 is given; a mapping is needed"):
        content_of(tmp_path, LISTS.replace("world:", f"world:\n  {map_}"))


def test_a_default_stands_for_all_and_gives_way_to_what_is_forbidden(tmp_path):
    matrix = """allowed_collision_matrix:
  entry_names: [base, upper]
  entry_values: [[true, true], [true, false]]
  default_entry_names: [base, upper, tip]
  default_entry_values: [true, true, false]
"""
    assert content_of(tmp_path, matrix + LISTS).allow == (("base", "upper"), ("base", "*"))


def test_rows_of_an_object_of_several_shapes_are_of_them_all(tmp_path):
    matrix = (
        "allowed_collision_matrix: {entry_names: [can, base], entry_values: [[1, 1], [1, 1]]}\n"
    )
    assert content_of(tmp_path, matrix + LISTS).allow == (("can/*", "base"),)


BALL = "{id: a, header: {frame_id: %s}, primitives: [{type: 2, dimensions: [1]}]}"
FRAMED = f"world: {{collision_objects: [{BALL}]}}\n"


@pytest.mark.parametrize(
    ("frame", "base", "is_told"),
    [
        ("base", "{}", False),
        ("world", "{xyz: [0, 0, 2]}", False),
        ("base", "{xyz: [0, 0, 2]}", True),
        ("upper", "{}", True),
    ],
)
def test_a_frame_that_is_a_link_elsewhere_is_a_warning(tmp_path, frame, base, is_told):
    given = NAMED.replace("urdf: arm.urdf", f"urdf: arm.urdf, base: {base}")
    case = load_small(tmp_path, given, cell__yaml=FRAMED % frame)
    told = [one.text for one in case.notices if one.kind == "frame"]
    assert [f"the frame of link {frame!r}" in text for text in told] == [True] * is_told


def objects(**n_shapes):
    """A world of spheres on one spot, by name how many."""
    ball = "{type: 2, dimensions: [0.05]}"
    rows = [
        f'  - {{id: "{name.replace("_", "/")}", primitives: [{", ".join([ball] * n)}]}}\n'
        for name, n in n_shapes.items()
    ]
    return "world:\n  collision_objects:\n" + "".join(rows)


def allowing(one, other):
    """A matrix in which two names may touch."""
    row = f'{{entry_names: ["{one}", "{other}"], entry_values: [[0, 1], [1, 0]]}}'
    return f"allowed_collision_matrix: {row}\n"


def test_an_object_named_below_another_is_no_shape_of_it(tmp_path):
    both = allowing("can", "base") + objects(can=2, can_lid=1)
    assert content_of(tmp_path, both).allow == (("can/0", "base"), ("can/1", "base"))
    gone = allowing("can", "base") + objects(can_lid=1)
    assert content_of(tmp_path, gone).allow == (("can", "base"),)


@pytest.mark.parametrize("name", ["po*", "po[st]", "pos?"])
def test_wildcards_in_names_of_a_matrix_or_of_touch_links_are_letters(tmp_path, name):
    document = allowing(name, "base") + objects(post=1, own=1).replace('"own"', f'"{name}"')
    (tmp_path / "cell.yaml").write_text(document)
    case = load_small(tmp_path, NAMED)
    allowed = {obstacle for link, obstacle in _left_out(case) if link == "base"}
    assert allowed == {name}
    held = MESSAGE.replace("touch_links: [upper]", f'touch_links: ["{name}"]')
    assert all(
        not matches("post", one) for part in content_of(tmp_path, held).held for one in part.touch
    )


def _left_out(case):
    return {(out.link, out.obstacle) for out in measured_pairs(case)[1]}


def test_a_name_that_has_two_rows_in_a_matrix_is_refused(tmp_path):
    with pytest.raises(BadInput, match="two entry_names have the name 'base'"):
        content_of(tmp_path, allowing("base", "base") + LISTS)


def test_meshes_are_taken_from_the_message_and_from_files(tmp_path):
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    corners = "[[0, 0, 0], {x: 1.5}, {y: 1}, {z: 1}]"
    faces = "[[0, 2, 1], {vertex_indices: [0, 1, 3]}, [0, 3, 2], [1, 2, 3]]"
    document = f"""world:
  collision_objects:
  - {{id: inline, meshes: [{{vertices: {corners}, triangles: {faces}}}]}}
  - {{id: file, meshes: [{{resource: cube.stl, dimensions: [1, 2, 3]}}], mesh_poses: [{{position: [1, 0, 0]}}]}}
"""
    made = obstacles_of(tmp_path, document)
    shape = made["inline"].body.shape
    assert shape.closed and shape.vertices.max(axis=0).tolist() == [1.5, 1, 1]
    assert sorted(made["file"].body.shape.vertices.tolist()) == sorted((CUBE * [1, 2, 3]).tolist())
    case = load_small(tmp_path, NAMED, cell__yaml=document)
    assert [one.path for one in case.sources if "mesh0" in one.path] == []


def test_text_of_the_first_version(tmp_path):
    made = obstacles_of(tmp_path, FIRST, "cell.scene")
    assert {name: place(one) for name, one in made.items()} == {
        "a post": [0, 2, 0],
        "cube/0": [0, 2, 0],
        "cube/1": [0, 0, 0],
    }
    assert sorted(made["cube/0"].body.shape.vertices.tolist()) == sorted(CUBE.tolist())
    cylinder = cl.cylinder(radius=0.5, length=2.0)
    assert np.array_equal(made["cube/1"].body.shape.vertices, cylinder.vertices)


def test_text_of_the_second_version_has_poses_of_objects_and_subframes(tmp_path):
    made = obstacles_of(tmp_path, SECOND, "cell.scene")
    assert {name: place(one) for name, one in made.items()} == {
        "post": [1, 2, 0],
        "ball": [0, 2, 5],
    }


def test_a_case_names_it_as_its_scene(tmp_path):
    text = NAMED.replace("cell.yaml", "cell.scene")
    case = load_small(tmp_path, text, cell__scene=SECOND)
    assert [one.name for one in case.obstacles] == ["post", "ball"]


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
    import json

    only_our_own(tmp_path_factory.getbasetemp(), json.dumps(raw).encode(), "cell.yaml")


def test_the_command_line_answers_with_one_line(tmp_path, capsys):
    document = OBJECT % "primitives: [{type: spere, dimensions: [1]}]"
    assert cli.run(["check", str(write_case(tmp_path, NAMED, cell__yaml=document))]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "did you mean 'sphere'?" in told
    assert "case.yaml: scene: cell.yaml: world: collision_objects[0]: 'a': primitives[0]" in told
