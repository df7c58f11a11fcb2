"""MoveIt's scenes: messages, robowflex's lists and `.scene` text; what they are, and what is told of the rest."""

import re

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, UnknownLink
from clearance.world.notice import Severity
from clearance.world.pairs import measured_pairs
from clearance.world.rules import matches
from tests.formats.making import CUBE, cube_stl
from tests.formats.making_case import CASE, TWO_JOINTS, load_small
from tests.formats.making_glb import cube_document, glb
from tests.formats.making_moveit import (
    FIRST,
    LISTS,
    MESSAGE,
    NAMED,
    SECOND,
    content_of,
    obstacles_of,
)
from tests.formats.refusal import refusal


def place(obstacle):
    return obstacle.world_from_body[:3, 3].tolist()


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
        "1 quaternion of zeros is taken for no rotation, as in MoveIt",
        "1 pairs of the scene's file may touch",
        "1 allowed pairs of the scene's file are left out: of two links",
        "bodies that are not there are left out: ghost",
        "padding of the scene's file is a distance",
    ):
        assert said in told
    (left_out,) = [one for one in case.notices if one.kind == "padding"]
    assert left_out.severity == "warning"
    assert "since no robot has such links: 'ghost'; " in left_out.text
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
    apart = {(one.link, one.obstacle) for one in cl.check(case).pair_minima}
    assert apart == {("base", "tool"), ("post", "tool"), ("upper", "post")}


def test_a_held_object_has_the_padding_of_its_link(tmp_path):
    padded = MESSAGE.replace("link_name: ghost, padding: 1.0", "link_name: tip, padding: 0.02")
    made = obstacles_of(tmp_path, padded)
    assert {name: one.padding for name, one in made.items()} == {"post": 0.0, "tool": 0.02}


@pytest.mark.parametrize("is_diff", [True, False])
def test_a_difference_to_an_unknown_scene_is_warned_of(tmp_path, is_diff):
    message = MESSAGE.replace("is_diff: false", f"is_diff: {is_diff}".lower())
    told = [(one.severity, one.kind) for one in content_of(tmp_path, message).notices]
    assert told == [(Severity.WARNING, "scene")] * is_diff


@pytest.mark.parametrize(("x", "base", "is_told"), [(0.5, 0.0, 1), (0.5, 0.5, 0), (0.0, 0.0, 0)])
def test_a_robot_that_stands_elsewhere_in_the_scene_than_in_the_case_is_suspect(
    tmp_path, x, base, is_told
):
    state = f"multi_dof_joint_state: {{joint_names: [vj], transforms: [{{translation: {{x: {x}, y: 0, z: 0}}}}]}}"
    given = NAMED.replace("arm.urdf", f"arm.urdf, base: {{xyz: [{base}, 0, 0]}}")
    message = f"robot_state: {{{state}}}\nworld: {{collision_objects: [{CRATE % 'odom'}]}}\n"
    case = load_small(tmp_path, given, cell__yaml=message)
    told = [one.severity for one in case.notices if one.kind == "frame" and "'vj'" in one.text]
    assert told == [Severity.SUSPECT] * is_told


@pytest.mark.parametrize(
    ("joints", "state", "told"),
    [
        ("", "name: [lift, shoulder], position: [0.03, 9]", "joint 'lift' at 0, and there at 0.03; "),
        (", joints: {lift: 0.01}", "name: [lift], position: [0.03]", "at 0.01, and there at 0.03; "),
        (", joints: {lift: 0.03}", "name: [lift, ghost], position: [0.03, 1]", ""),
        (", joints: {lift: 0.03}", "name: [lift], position: [.inf]", ""),
    ],
)  # fmt: skip
def test_joints_that_rest_elsewhere_than_the_scene_has_them_stand_in_the_headline(
    tmp_path, joints, state, told
):
    """The shoulder is moved by a trajectory."""
    given = NAMED.replace("arm.urdf", f"arm.urdf{joints}")
    message = f"robot_state: {{joint_state: {{{state}}}}}\nworld: {{collision_objects: [{CRATE % 'world'}]}}\n"
    found = load_small(tmp_path, given, urdf=TWO_JOINTS, cell__yaml=message).notices
    texts = [one.text for one in found if one.kind == "rest"]
    assert len(texts) == bool(told)
    assert all(told in one and "rests otherwise than the scene's file says" in one for one in texts)


def test_what_the_case_carries_is_left_to_it(tmp_path):
    text = NAMED + "carry: [{part: tool, by: tip, from: 0.5, touch: ['*']}]\n"
    (carry,) = load_small(tmp_path, text, cell__yaml=MESSAGE).carries
    assert carry.window.start == 0.5 and carry.touch == ("*",)


def test_an_object_of_several_shapes_is_carried_whole(tmp_path):
    text = NAMED + "carry: [{part: can, by: tip, from: 0.5}]\n"
    carries = load_small(tmp_path, text, cell__yaml=LISTS.replace("base_link", "base")).carries
    assert [(one.part, one.window.start) for one in carries] == [("can/0", 0.5), ("can/1", 0.5)]


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


TWO = """robots:
- {name: left, urdf: arm.urdf, trajectory: path.csv}
- {name: right, urdf: arm.urdf, trajectory: path.csv}
scene: cell.yaml
"""


def test_an_object_held_in_a_case_of_several_robots_is_refused_by_name(tmp_path):
    with pytest.raises(BadInput, match="nothing is called 'tip'; valid: left/base, left/tip"):
        load_small(tmp_path, TWO, cell__yaml=MESSAGE)


def test_a_default_stands_for_all_and_gives_way_to_what_is_forbidden(tmp_path):
    matrix = """allowed_collision_matrix:
  entry_names: [base, upper]
  entry_values: [[true, true], [true, false]]
  default_entry_names: [base, upper, tip]
  default_entry_values: [true, true, false]
"""
    content = content_of(tmp_path, matrix + LISTS)
    assert content.allow == (("base", "upper"), ("base", "*"))
    assert content.not_by_default == ("tip",)
    one_way = matrix.replace("[[true, true], [true, false]]", "[[true, false], [true, true]]")
    assert content_of(tmp_path, one_way + LISTS).allow == ()


def defaults(**values):
    """A matrix of defaults alone."""
    names, given = ", ".join(values), ", ".join(str(value).lower() for value in values.values())
    row = f"{{default_entry_names: [{names}], default_entry_values: [{given}]}}"
    return f"allowed_collision_matrix: {row}\n"


@pytest.mark.parametrize(
    ("given", "allowed"),
    [
        ({"upper": True}, {("upper", "post"), ("upper", "own/0"), ("upper", "own/1")}),
        ({"upper": True, "own": False}, {("upper", "post")}),
        ({"post": True}, {("base", "post"), ("upper", "post")}),
        ({"post": True, "base": False}, {("upper", "post")}),
        ({"own": True, "base": False}, {("upper", "own/0"), ("upper", "own/1")}),
        ({"post": False, "upper": False}, set()),
    ],
)
def test_defaults_are_of_links_and_obstacles_and_of_two_the_stricter_counts(
    tmp_path, given, allowed
):
    """As MoveIt has it; pairs of two links are those of the SRDF."""
    text = NAMED.replace("urdf: arm.urdf", "urdf: arm.urdf, self_clearance: true")
    case = load_small(tmp_path, text, cell__yaml=defaults(**given) + objects(post=1, own=2))
    excused = {(out.link, out.obstacle) for out in measured_pairs(case)[1] if "allow" in out.reason}
    assert excused == allowed
    assert all("*" not in row.between for row in case.allow)


def test_a_matrix_names_links_that_one_robot_has(tmp_path):
    """A scene is of one robot, and which one is not said."""
    cell = allowing("upper", "post") + objects(post=1)
    one = load_small(tmp_path, NAMED, cell__yaml=cell)
    assert [row.between for row in one.allow] == [("upper", "post")]
    case = load_small(tmp_path, TWO, cell__yaml=cell)
    said = "allowed pairs of the scene's file are left out, as it does not say which robot is meant"
    assert case.allow == () and f"{said}: upper - post" in case.notes
    case = load_small(tmp_path, TWO, cell__yaml=cell.replace("upper", "left/upper"))
    assert [row.between for row in case.allow] == [("left/upper", "post")]
    case = load_small(tmp_path, TWO, cell__yaml=defaults(post=True) + objects(post=1))
    assert case.allow == () and f"{said}: post - *" in case.notes


def test_rows_of_an_object_of_several_shapes_are_of_them_all(tmp_path):
    matrix = (
        "allowed_collision_matrix: {entry_names: [can, base], entry_values: [[1, 1], [1, 1]]}\n"
    )
    assert content_of(tmp_path, matrix + LISTS).allow == (("can/*", "base"),)


CRATE = "{id: a, header: {frame_id: %s}, primitives: [{type: 1, dimensions: [1, 1, 1]}]}"
FRAMED = f"world: {{collision_objects: [{CRATE}]}}\n"


@pytest.mark.parametrize(
    ("frame", "base", "is_told"),
    [
        ("base", "{}", False),
        ("world", "{xyz: [0, 0, 2]}", False),
        ("base", "{xyz: [0, 0, 2]}", True),
        ("upper", "{}", True),
    ],
)
def test_a_frame_that_is_a_link_elsewhere_is_suspect(tmp_path, frame, base, is_told):
    given = NAMED.replace("urdf: arm.urdf", f"urdf: arm.urdf, base: {base}")
    case = load_small(tmp_path, given, cell__yaml=FRAMED % frame)
    told = [(one.severity, one.kind) for one in case.notices if f"link {frame!r}" in one.text]
    assert told == [(Severity.SUSPECT, "frame")] * is_told


@pytest.mark.parametrize("frame", ["bse", "workshop"])
def test_a_frame_that_is_nowhere_is_refused_with_the_nearest_name(tmp_path, frame):
    nearest = {"bse": "did you mean 'base'?", "workshop": "valid: base, tip, upper, world"}[frame]
    told = f"frame: frame '{frame}' is no link; {re.escape(nearest)}"
    with pytest.raises(UnknownLink, match=rf"scene: cell\.yaml: {told}"):
        load_small(tmp_path, NAMED, cell__yaml=FRAMED % frame)
    own = f"obstacles: [{{name: post, box: {{size: [1, 1, 1]}}}}]\nframe: {frame}\n"
    assert re.search(told, refusal(load_small, tmp_path, NAMED, cell__yaml=own, of=UnknownLink))
    with pytest.raises(UnknownLink, match=rf"case\.yaml: scene: {told}"):
        load_small(tmp_path, CASE.replace("scene:\n", f"scene:\n  frame: {frame}\n"))


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


@pytest.mark.parametrize("name", ["po*", "po[st]", "pos?"])
def test_wildcards_in_names_of_a_matrix_or_of_touch_links_are_letters(tmp_path, name):
    document = allowing(name, "base") + objects(post=1, own=1).replace('"own"', f'"{name}"')
    (tmp_path / "cell.yaml").write_text(document)
    case = load_small(tmp_path, NAMED)
    allowed = {obstacle for link, obstacle in _left_out(case) if link == "base"}
    assert allowed == {name}
    held = MESSAGE.replace("touch_links: [upper]", f'touch_links: ["{name}"]')
    assert all(
        not matches("post", one)
        for part in content_of(tmp_path, held).attached
        for one in part.touch
    )


def _left_out(case):
    return {(out.link, out.obstacle) for out in measured_pairs(case)[1]}


def test_meshes_are_taken_from_the_message_and_from_files(tmp_path):
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    corners = "[[0, 0, 0], {x: 1.5, y: 0, z: 0}, [0, 1, 0], [0, 0, 1]]"
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


def test_a_glb_lies_as_in_moveit_which_does_not_turn_it(tmp_path):
    (tmp_path / "cube.glb").write_bytes(glb(*cube_document(CUBE + [0, 1, 0])))
    rows = "{id: panel, meshes: [{resource: cube.glb, dimensions: [1, 2, 3]}]}"
    (made,) = obstacles_of(tmp_path, f"world: {{collision_objects: [{rows}]}}").values()
    corners = (CUBE + [0, 1, 0]) * [1, 2, 3]
    assert sorted(made.body.shape.vertices.tolist()) == sorted(corners.tolist())


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


OBJECT = "world: {collision_objects: [{id: a, header: {frame_id: base}, %s}]}\n"
SPHERE = "primitives: [{type: sphere, dimensions: [1]}]"


@pytest.mark.parametrize(
    ("document", "says"),
    [
        ("world: {collision_objects: [1]}", "collision_objects[0]: 1 is given; a mapping"),
        (OBJECT % "operation: 0", "'a': it has no shape"),
        (OBJECT % f"operation: 1, {SPHERE}", "'a': operation: 1 is given; ADD (0)"),
        (OBJECT % "planes: [{coef: [0, 0, 1, 0]}]", "planes: a plane, which has no end"),
        (OBJECT % "primitives: [{type: 4, dimensions: [1, 1]}]", "a cone is not read"),
        (OBJECT % "primitives: [{type: 1, dimensions: [1]}]", "1 dimensions of a box; 3"),
        (OBJECT % f"{SPHERE}, primitive_poses: [{{}}, {{}}]", "2 primitive_poses of 1 primitives"),
        (OBJECT % f"{SPHERE}, pose: {{position: [0, 0, 0], orientation: [1, 1, 0, 0]}}", "orientation: the q"),
        (
            OBJECT % "meshes: [{vertices: [[0, 0, 0]], triangles: [[0, 0, 1]]}]",
            "triangle [0, 0, 1] of 1 vertices",
        ),
        (OBJECT % f"{SPHERE}, pose: {{position: {{x: 1}}}}", "position: {'x': 1} is given; x, y, z are needed"),
        (OBJECT % f"{SPHERE}, pose: {{orientation: {{w: 1}}}}", "'a': 'position' is missing; x, y, z"),
        (OBJECT % SPHERE + "link_padding: [{link_name: l, gap: 1}]", "link_padding[0]: unknown field 'gap'"),
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
        (allowing("base", "base") + OBJECT % SPHERE, "two entry_names have the name 'base'"),
        (OBJECT % SPHERE + "allowed_collision_matrix: {entry_names: [a], entry_values: [1]}",
         "entry_values: 1 is given; 1 of true or false"),
        (
            "robot_state: {attached_collision_objects: [{link_name: l, object: {id: a, header: {frame_id: w}}}]}",
            "attached_collision_objects[0]: it is given in 'w', not in its link; frame_id: l",
        ),
    ],
)  # fmt: skip
def test_a_fault_is_one_line_with_its_field(tmp_path, document, says):
    told = refusal(content_of, tmp_path, document, of=BadInput)
    assert told.startswith("cell.yaml: ") and says in told


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("sphere\n0.025", "cone\n1 2", "'post': a cone is not read"),
        ("sphere\n0.025", "blob\n1", "line 6: 'post': 'blob' is no shape; sphere, box"),
        ("0.025", "0.2 5", "line 7: 'post': '0.2 5' is given; the dimensions of a sphere: 1 numbers"),
        ("0.025", "O.25", "line 7: 'post': 'O.25' is not a number"),
        ("* ball", "ball", "line 15: 'ball' is given; * and the object's name"),
        ("* ball", "*", "line 15: '*' is given"),
        (".\n", ".\nmore", "there is more behind the point"),
        ("1\nsphere\n0.025", "9999\nsphere\n0.025", "how many shapes, as many as there are"),
    ],
)  # fmt: skip
def test_a_fault_of_text_is_one_line_with_its_line(tmp_path, old, new, says):
    document = SECOND[: -len(old)] + new if old == ".\n" else SECOND.replace(old, new, 1)
    told = refusal(content_of, tmp_path, document, "cell.scene", of=BadInput)
    assert told.startswith("cell.scene: ") and says in told
