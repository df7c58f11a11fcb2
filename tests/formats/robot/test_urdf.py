"""URDF to a robot: shapes in their link's frame, and joints as written."""

import math

import numpy as np
import pytest

import clearance as cl
from clearance.errors import NothingToMeasure
from clearance.world.kinematics import link_poses, moving_positions
from clearance.world.notice import Severity
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind
from clearance.world.trajectory import Trajectory
from tests.formats.making import ARM, CUBE, CUBE_TRIANGLES, binary_stl, cube_stl
from tests.formats.making_case import changed, load_small
from tests.formats.making_urdf import BOX, collision, joint, link, load_robot, robot


def world_from_link(robot, **positions):
    empty = Trajectory(np.zeros(1), (), np.zeros((1, 0)))
    placed = PlacedRobot(robot, empty)
    given = np.array([list(positions.values())], dtype=float).reshape(1, -1)
    poses = link_poses(placed, moving_positions(placed, tuple(positions), given))[0]
    return dict(zip(robot.link_names, poses, strict=True))


def test_an_arm_has_its_links_joints_and_bodies(tmp_path):
    arm = load_robot(tmp_path, ARM)
    assert arm.name == "arm"
    assert arm.link_names == ("base", "upper", "tip")
    assert [j.name for j in arm.joints] == ["shoulder", "flange"]
    assert [body.name for body in arm.bodies] == ["base", "upper"]
    assert [body.origin for body in arm.bodies] == ["box", "upper.stl"]
    shoulder = arm.joints[0]
    assert (shoulder.kind, shoulder.lower, shoulder.upper) == (JointKind.REVOLUTE, -1, 1)
    assert shoulder.axis.tolist() == [0, 0, 1]
    assert shoulder.parent_from_joint[:3, 3].tolist() == [0, 0, 0.1]
    assert arm.bodies[1].shape.bounds.tolist() == [[-0.5, -0.5, 0], [0.5, 0.5, 1]]
    assert arm.notes == ("arm.urdf: 1 link without any shape: tip",)


@pytest.mark.parametrize(
    ("shape", "size", "volume"),
    [
        ('<box size="1,2,3"/>', [1, 2, 3], 6),
        ('<cylinder radius="0.5" length="2"/>', [1, 1, 2], np.pi / 2),
        ('<sphere radius="0.5"/>', [1, 1, 1], np.pi / 6),
        ('<capsule radius="0.5" length="2"/>', [1, 1, 3], np.pi / 2 + np.pi / 6),
    ],
)
def test_primitive_shapes_hold_the_true_solid_and_little_more(tmp_path, shape, size, volume):
    body = load_robot(tmp_path, robot(link(collision(shape)))).bodies[0]
    extent = body.shape.bounds[1] - body.shape.bounds[0]
    assert (extent >= size).all()
    assert extent == pytest.approx(size, abs=2 * 1.01e-4)
    assert volume <= body.shape.volume * (1 + 1e-12) <= volume * 1.002


@pytest.mark.parametrize("version", ["1.1", "1.2"])
def test_a_quaternion_turns_as_the_angles_do(tmp_path, version):
    """Source: urdfdom, README, "URDF Versioning"."""
    half = 0.5**0.5
    for turn in ('rpy="0 0 1.5707963267948966"', f'quat_xyzw="0 0 {half} {half}"'):
        shape = collision('<box size="1 2 3"/>', f'<origin xyz="1 0 0" {turn}/>')
        text = robot(link(shape)).replace("<robot", f'<robot version="{version}"')
        bounds = load_robot(tmp_path, text).bodies[0].shape.bounds
        assert bounds == pytest.approx(np.array([[0, -0.5, -1.5], [2, 0.5, 1.5]]), abs=1e-15)


SLIDE = '<axis xyz="1 0 0"/><limit lower="0" upper="9"/>'


def follows(joint: str, multiplier: float = 1, offset: float = 0) -> str:
    return f'<mimic joint="{joint}" multiplier="{multiplier}" offset="{offset}"/>'


def test_mimic_chains_follow_their_master(tmp_path):
    joints = (
        joint("third", "c", "d", "prismatic", SLIDE + follows("second", multiplier=-3)),
        joint("first", "a", "b", "prismatic", SLIDE),
        joint("second", "b", "c", "prismatic", SLIDE + follows("first", multiplier=2, offset=1)),
    )
    arm = load_robot(tmp_path, robot(*(link("", name) for name in "abcd"), *joints))
    assert [j.name for j in arm.moving_joints] == ["first"]
    poses = world_from_link(arm, first=0.5)
    assert [poses[name][0, 3] for name in "abcd"] == [0, 0.5, 2.5, -3.5]


def test_a_mimic_of_a_fixed_joint_stays_where_it_is(tmp_path):
    turn = '<axis xyz="0 0 1"/>' + follows("still", offset=0.5)
    joints = (
        joint("still", "a", "b", "fixed", ""),
        joint("slide", "a", "c", "prismatic", SLIDE + follows("still", offset=0.25)),
        joint("turn", "a", "d", "continuous", turn),
    )
    arm = load_robot(tmp_path, robot(*(link("", name) for name in "abcd"), *joints))
    assert arm.moving_joints == ()
    assert "joint 'slide' follows fixed joint 'still' and stays at 0.25" in arm.notes[0]
    poses = world_from_link(arm)
    assert poses["c"][:3, 3].tolist() == [0.25, 0, 0]
    assert poses["d"][:2, 0] == pytest.approx([np.cos(0.5), np.sin(0.5)])


@pytest.mark.parametrize(
    ("kind", "inner", "limits"),
    [
        ("revolute", '<limit lower="-2" upper="1" effort="1" velocity="1"/>', (-2, 1)),
        ("revolute", '<limit upper="1"/>', (0, 1)),
        ("revolute", '<limit effort="1" velocity="1"/>', (-np.inf, np.inf)),
        ("revolute", "", (-np.inf, np.inf)),
        ("continuous", '<limit lower="-2" upper="1"/>', (-np.inf, np.inf)),
        ("prismatic", '<limit lower="0.1" upper="0.1"/>', (0.1, 0.1)),
    ],
)
def test_limits(tmp_path, kind, inner, limits):
    arm = load_robot(
        tmp_path, robot(link("", "a"), link("", "b"), joint("j", "a", "b", kind, inner))
    )
    assert (arm.joints[0].lower, arm.joints[0].upper) == limits


@pytest.mark.parametrize(
    ("given", "place"),
    [
        ("package://pkg/meshes/part.stl", "dirs/pkg/meshes"),
        ("package://pkg/meshes/part.stl", "dirs/meshes"),
        ("meshes/part.stl", "meshes"),
        ("model://pkg/meshes/part.stl", "dirs/pkg/meshes"),
        ("meshes\\part.stl", "meshes"),
        ("file://{folder}/meshes/part.stl", "meshes"),
    ],
)
def test_meshes_are_found(tmp_path, given, place):
    (tmp_path / "dirs").mkdir()
    (tmp_path / place).mkdir(parents=True, exist_ok=True)
    (tmp_path / place / "part.stl").write_bytes(cube_stl())
    mesh = f'<mesh filename="{given.format(folder=tmp_path)}"/>'
    arm = load_robot(tmp_path, robot(link(collision(mesh))), [tmp_path / "dirs"])
    assert arm.bodies[0].origin == f"{place}/part.stl"


def test_what_is_not_read_stands_in_a_note_or_where_it_may_be_a_shape_in_a_warning(tmp_path):
    axis_free = joint(
        "j", "a", "b", inner='<limit lower="-1" upper="1" velocity="2,5"/><stiffness value="3"/>'
    )
    contact = f"<contact>{BOX}</contact>"
    loop = '<loop_joint><link1 link="a" rpy="0 0 1"/></loop_joint>'
    made = load_robot(tmp_path, robot(link(BOX + contact), link(BOX, "b"), axis_free, loop))
    assert made.notes == (
        "arm.urdf: joints without <axis>, taken as x: 'j'",
        "arm.urdf: velocities that are no numbers, taken as unlimited: '2,5' of 'j'",
        "arm.urdf: not read: <stiffness>",
    )
    (notice,) = made.notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "geometry")
    assert notice.text == (
        "not read, though it may give a shape or a place: <contact> in link 'a', <loop_joint> in robot 'r'"
    )


def test_a_default_namespace_changes_nothing(tmp_path):
    elements = link(BOX, "a"), link(BOX, "b"), joint("j", "a", "b")
    plain = robot(*elements)
    named = plain.replace("<robot ", '<robot xmlns="http://drake.mit.edu" ', 1)
    prefixed = (
        plain.replace("<", "<u:")
        .replace("<u:/", "</u:")
        .replace("<u:robot ", '<u:robot xmlns:u="urn:u" ')
    )
    expected = load_robot(tmp_path, plain)
    for text in (named, prefixed):
        found = load_robot(tmp_path, text)
        assert found.link_names == expected.link_names
        assert [body.shape.n_faces for body in found.bodies] == [6, 6]
        assert [j.name for j in found.joints] == [j.name for j in expected.joints]


@pytest.mark.parametrize("empty", [collision('<box size="0 0.0 .0"/>'), "<collision/>"])
def test_shapes_of_no_size_are_left_out_with_a_warning_that_names_them(tmp_path, empty):
    arm = load_robot(tmp_path, robot(link(BOX + empty), link(empty, "b"), joint("j", "a", "b")))
    assert [body.name for body in arm.bodies] == ["a"]
    assert np.array_equal(arm.bodies[0].shape.vertices, cl.box((1.0, 1.0, 1.0)).vertices)
    (notice,) = arm.notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "geometry")
    assert notice.text.endswith("measured: link 'a' collision[1], link 'b' collision[0]")


def test_joints_that_should_have_limits_and_have_none_are_named(tmp_path):
    joints = [
        joint("j", "a", "b", inner=""),
        joint("k", "b", "c", "prismatic", '<limit effort="1" velocity="1"/>'),
        joint("l", "c", "d"),
        joint("m", "d", "e", "continuous", ""),
    ]
    arm = load_robot(tmp_path, robot(*(link(BOX, name) for name in "abcde"), *joints))
    told = "arm.urdf: joints without <limit>, taken as unlimited: 'j', 'k'"
    assert [note for note in arm.notes if "without <limit>" in note] == [told]


@pytest.mark.parametrize(
    "given, velocity",
    [
        ('<limit lower="-1" upper="1" velocity="2.5"/>', 2.5),
        ('<limit lower="-1" upper="1" velocity="0"/>', math.inf),
        ('<limit lower="-1" upper="1" velocity="fast"/>', math.inf),
        ("", math.inf),
    ],
)
def test_a_speed_that_is_one_is_read_and_nothing_is_refused_for_it(tmp_path, given, velocity):
    text = robot(link("", "a"), link(BOX, "b"), joint("j", "a", "b", inner=given))
    (made,) = load_robot(tmp_path, text).joints
    assert made.velocity == velocity and "velocity" not in repr(made)


VISUAL = '<visual><geometry><box size="2 2 2"/></geometry></visual>'
INSIDE = VISUAL.replace("2 2 2", "0.8 0.8 0.8")


def arm(base: str, *others: str) -> str:
    """A base and links that turn on it, by what they are made of."""
    links = [link(shapes, f"link{i}") for i, shapes in enumerate(others)]
    joints = [joint(f"joint{i}", "base", f"link{i}") for i in range(len(others))]
    return robot(link(base, "base"), *links, *joints)


def test_links_that_are_seen_but_not_measured_are_a_warning_of_their_own(tmp_path):
    (notice,) = load_robot(tmp_path, arm(BOX, VISUAL, "", VISUAL, BOX + INSIDE)).notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "geometry")
    assert notice.text.startswith(
        "2 links have a visual but no collision shape and are not measured: 'link0', 'link2'; "
    )
    assert "geometry: collision_or_visual" in notice.text
    (notice,) = load_robot(tmp_path, arm(BOX, *([VISUAL] * 9))).notices
    assert "9 links have" in notice.text and "'link5' and 3 more" in notice.text


def test_visual_shapes_that_reach_far_out_of_the_collision_shapes_are_warned_of(tmp_path):
    """Fingers drawn later, from 0.1 to 0.5 m, on a cube that ends at 0.05 m."""

    def warned(visual, asked="collision"):
        hand = collision('<box size="0.1 0.1 0.1"/>') + visual
        read = load_robot(tmp_path, robot(link(hand)), geometry=asked)
        return [one.text for one in read.notices if one.severity is Severity.WARNING]

    fingers = _seen('<box size="0.4 0.1 0.1"/>', 0.3)
    for asked in ("collision", "collision_or_visual"):
        assert warned(fingers, asked) == [
            "visual shapes reach out of the collision shapes, and are not measured there: "
            "link 'a' by 0.45 m; add collision shapes, or give robot: {geometry: visual}"
        ]
    assert warned(fingers, "visual") == []
    for near in (_seen('<box size="0.2 0.2 0.2"/>', 0.0), _seen('<sphere radius="0.001"/>', 1.0)):
        assert warned(near) == []


def test_visual_meshes_that_reach_far_out_of_the_collision_shapes_are_warned_of(
    tmp_path, monkeypatch
):
    """The tube of a telescope arm, 0.2 m long, of which the collision mesh has the cap alone."""
    large = binary_stl(CUBE[np.tile(CUBE_TRIANGLES, (2, 1))])
    for name, data in {"cube": cube_stl(), "cut": cube_stl()[:-1], "large": large}.items():
        (tmp_path / f"{name}.stl").write_bytes(data)
    cap, tube, bead = (
        f'"cube.stl" scale="{one}"' for one in ("0.1 0.1 0.1", "0.2 0.1 0.1", "0.02 0.02 0.02")
    )

    def read(mesh, x, asked="collision"):
        arm = collision(f"<mesh filename={cap}/>") + _seen(f"<mesh filename={mesh}/>", x)
        made = load_robot(tmp_path, robot(link(arm)), geometry=asked)
        return [one.text for one in made.notices], made.notes

    for asked in ("collision", "collision_or_visual"):
        (text,), _ = read(tube, 0.1, asked)
        assert "link 'a' by 0.15 m; add collision shapes" in text
    for mesh, x in ((tube, 0.0), (bead, 0.3), (cap, 0.05)):
        assert read(mesh, x) == ([], ())
    monkeypatch.setattr("clearance.formats.robot.urdf.robot.LARGEST", len(cube_stl()))
    for unreadable in ('"not_there.stl"', '"cut.stl"', '"large.stl"'):
        texts, (note,) = read(unreadable, 0.0)
        assert not texts
        assert note == (
            "arm.urdf: visual shapes that are not read, nor compared with the collision shapes: 'a'"
        )


CAP = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"


@pytest.mark.parametrize(
    ("obj", "reach"),
    [
        (f"{CAP}f 1 2 3\nf 1 2 4\n", None),
        (f"{CAP}v 0.9 0 0\nf 1 2 5\n", "0.8 m"),
        (f"{CAP}v 0.9 0 0\nf 1 2 5\n".replace("\n", "\r"), "0.8 m"),
        (f"{CAP}v 0.9 \\\n 0 0\nf 1 2 5\n", "0.8 m"),
        (f"{CAP}\t v\t0.9 0 0 1.0\nf 1 2 5\n", "0.8 m"),
        (f"{CAP}v 0.9 0 0\nf 1 2 3\n", None),
        (f"{CAP}v nan 0 0\nv 0.9 0 0\nf 1 2 6\n", "0.8 m"),
    ],
    ids=["all near", "far", "old line ends", "a line goes on", "tabs", "no face uses it", "not finite"],
)  # fmt: skip
def test_how_far_a_visual_obj_reaches_is_that_of_what_its_faces_use(tmp_path, obj, reach):
    """Points are looked at first, and faces only where these lie far out."""
    (tmp_path / "shell.obj").write_bytes(obj.encode())
    shapes = collision('<box size="0.2 0.4 0.4"/>')
    shapes += collision('<mesh filename="shell.obj"/>').replace("collision", "visual")
    made = load_robot(tmp_path, robot(link(shapes)))
    assert [f"by {reach};" in one.text for one in made.notices] == ([True] if reach else [])
    assert not made.notes


def _seen(shape, x):
    return collision(shape, f'<origin xyz="{x} 0 0"/>').replace("collision", "visual")


def test_collision_or_visual_measures_all_that_has_a_shape(tmp_path):
    urdf = arm(BOX + INSIDE, VISUAL, "")
    found = load_robot(tmp_path, urdf, geometry="collision_or_visual")
    assert found.notices == ()
    sizes = {body.name: float(body.shape.bounds[1, 0]) for body in found.bodies}
    assert sizes == {"base": 0.5, "link0": 1.0}
    case = changed("arm.urdf", "arm.urdf, geometry: collision_or_visual")
    loaded = load_small(tmp_path, case, urdf=urdf.replace("joint0", "shoulder"))
    assert len(loaded.robots[0].robot.bodies) == 2


@pytest.mark.parametrize(
    ("shape", "asked", "other"), [(VISUAL, "collision", "visual"), (BOX, "visual", "collision")]
)
def test_a_robot_of_the_other_kind_of_shapes_is_told_what_to_give(tmp_path, shape, asked, other):
    with pytest.raises(NothingToMeasure) as caught:
        load_robot(tmp_path, arm(shape, shape), geometry=asked)
    assert str(caught.value) == (
        f"arm.urdf: no link has a {asked} shape, 2 links have a {other} shape; "
        f"give robot: {{geometry: {other}}}"
    )


def test_couplings_and_limits_of_a_controller_are_told(tmp_path):
    coupled = (
        '<ros2_control><joint name="{}"><param name="mimic">first</param></joint></ros2_control>'
    )
    soft = '<safety_controller soft_lower_limit="-1" k_velocity="2"/>'
    slides = (
        joint("first", "a", "b", "prismatic", SLIDE + soft),
        joint("free", "b", "c", "prismatic", SLIDE),
        joint("bound", "c", "d", "prismatic", SLIDE + '<mimic joint="first"/>'),
    )
    links = [link(BOX, "a"), *(link("", name) for name in "bcd")]
    made = load_robot(
        tmp_path, robot(*links, *slides, coupled.format("free"), coupled.format("bound"))
    )
    (notice,) = made.notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "equality")
    assert "are free here: 'free';" in notice.text
    assert any(note.endswith("soft limits are not used: joint 'first'") for note in made.notes)
