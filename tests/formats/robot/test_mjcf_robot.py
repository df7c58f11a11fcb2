"""MJCF as a robot: which shapes, which joints, what is told, and what is refused in one line."""

import numpy as np
import pytest

from clearance.errors import BadInput, BadSyntax, ClearanceError, MissingFile
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import RobotRequest, read_robot
from clearance.world.pairs import measured_pairs
from clearance.world.robot import JointKind
from tests.formats.making_case import changed, load_small
from tests.formats.making_mjcf import BALL, load_mjcf, mjcf, write_mjcf
from tests.formats.refusal import refusal

ARM = mjcf(
    f'<body name="upper" pos="0 0 0.1"><joint name="shoulder" axis="0 0 1" range="-90 90"/>{BALL}'
    '<body name="hand" pos="0 0 1"><joint name="grip" type="slide" axis="2 0 0" range="0 0.1"/>'
    f"{BALL}</body></body>"
)


def test_bodies_are_links_and_the_world_is_the_root(tmp_path):
    loaded = load_mjcf(tmp_path, ARM)
    assert (loaded.name, loaded.link_names) == ("toy", ("world", "upper", "hand"))
    shoulder, grip = loaded.joints
    assert (shoulder.kind, grip.kind) == (JointKind.REVOLUTE, JointKind.PRISMATIC)
    np.testing.assert_allclose(
        (shoulder.lower, shoulder.upper), (-np.pi / 2, np.pi / 2), rtol=1e-15
    )
    assert (grip.lower, grip.upper, grip.axis.tolist()) == (0.0, 0.1, [1, 0, 0])
    assert [body.name for body in loaded.bodies] == ["upper", "hand"]
    assert loaded.notices == () and loaded.notes == ("toy.xml: geoms: 2 collide",)


SEEN = mjcf(
    f'<body name="a"><joint/>{BALL}<geom size="0.12" contype="0" conaffinity="0" group="2"/></body>'
    '<body name="b"><geom size="0.03" contype="0" conaffinity="0"/></body>'
    f'<body name="c"><geom size="0.04" group="3"/></body>'
)


@pytest.mark.parametrize(
    ("geometry", "radii"),
    [
        ("collision", {"a": 0.1, "c": 0.04}),
        ("visual", {"a": 0.12, "b": 0.03}),
        ("collision_or_visual", {"a": 0.1, "b": 0.03, "c": 0.04}),
    ],
)
def test_geoms_collide_or_are_seen(tmp_path, geometry, radii):
    loaded = load_mjcf(tmp_path, SEEN, geometry)
    assert {b.name: pytest.approx(b.shape.bounds[1, 2], abs=1e-6) for b in loaded.bodies} == radii
    assert "toy.xml: geoms: 2 are only seen, 2 collide" in loaded.notes
    told = [notice.text for notice in loaded.notices]
    if geometry == "collision":
        assert told[0].startswith(
            "1 link has a visual but no collision shape and is not measured: 'b'"
        )


def test_geoms_of_the_world_stand_with_the_robot_planes_among_them(tmp_path):
    loaded = load_mjcf(tmp_path, mjcf(f'<geom type="plane" size="1 1 1" name="floor"/>{BALL}'))
    (world,) = loaded.bodies
    assert world.name == "world" and world.origin == "sphere, box"
    np.testing.assert_allclose(world.shape.bounds, [[-20, -20, -20], [20, 20, 0.1]], atol=1e-4)
    stand = "2 geoms of the world itself stand with the robot, as its link 'world'"
    assert (
        f"toy.xml: {stand}; self_clearance: true measures the other links against it"
        in loaded.notes
    )
    assert "toy.xml: planes are boxes 40 m wide and 20 m deep below them: 'floor'" in loaded.notes
    assert loaded.notices == ()


def test_a_mocap_body_with_a_shape_is_warned_of(tmp_path):
    target = '<body name="target" mocap="true"/>'
    for on_cart in (BALL, f'<body name="top">{BALL}</body>'):
        cart = f'<body name="cart" mocap="true">{on_cart}</body>'
        (told,) = load_mjcf(tmp_path, mjcf(target + cart)).notices
        assert told.line == "mocap bodies stand where the file has them: 'cart' [CL222]"


SRDF = ", srdf: toy.srdf"

FOLLOWS = (
    f'<body name="a"><joint name="j" ref="10" type="slide"/>{BALL}<body name="b"><joint name="k" ref="0.5" '
    f'type="slide"/>{BALL}</body></body>'
)


@pytest.mark.parametrize(
    ("row", "mimic", "says"),
    [
        ('<joint joint1="k" joint2="j" polycoef="1 2 0 0 0"/>', ("j", 2.0, 0.5 + 1 - 20), "follows 'j'"),
        ('<joint joint1="k" joint2="j" polycoef="1 2 3 0 0"/>', None, "it is no line but a polynomial"),
        ('<joint joint1="k" joint2="j" active="false"/>', None, "is not active"),
        ('<joint joint1="k" polycoef="0.1 0 0 0 0"/>', None, "it is held at 0.6"),
        ('<joint joint1="k" joint2="j"/><joint joint1="k" joint2="j"/>', ("j", 1.0, -9.5), "follows 'j' already"),
        ('<weld body1="a" body2="b"/>', None, "close loops are not followed (1 weld)"),
    ],
)  # fmt: skip
def test_equalities_of_joints_are_followed_or_told(tmp_path, row, mimic, says):
    loaded = load_mjcf(tmp_path, mjcf(FOLLOWS, f"<equality>{row}</equality>"))
    found = loaded.joints[1].mimic
    assert (found and (found.joint, found.multiplier, found.offset)) == mimic
    assert says in " ".join([*loaded.notes, *(notice.text for notice in loaded.notices)])


def test_pairs_that_are_excluded_are_not_measured_and_told(tmp_path):
    bodies = f'{FOLLOWS}<body name="c" pos="3 0 0"><joint name="m"/>{BALL}</body>'
    excluded = mjcf(bodies, '<contact><exclude body1="c" body2="b"/></contact>')
    said = "self_clearance without srdf leaves out (<exclude> in the model): b - c"
    assert said in load_mjcf(tmp_path, excluded).notes[-1]
    path = "time,j,k,m\n0,0,0,0\n1,0.1,0.1,0.1\n"
    for text, keys, n_links in ((mjcf(bodies), "", 2), (excluded, "", 1), (excluded, SRDF, 3)):
        asked = f"urdf: toy.xml, self_clearance: true{keys}"
        case = load_small(
            tmp_path, changed("urdf: arm.urdf", asked), trajectory=path, toy__xml=text,
            toy__srdf='<robot name="toy"><group name="g"/></robot>',
        )  # fmt: skip
        pairs, left_out = measured_pairs(case)
        assert sum(not pair.b.is_obstacle for pair in pairs) == n_links
        why = {(one.link, one.obstacle): one.reason for one in left_out}
        told = "excused: <exclude> in the model"
        assert (why.get(("c", "b")) == told) == (n_links == 1)


def test_a_hollow_mesh_stays_hollow(tmp_path):
    """A U of three cubes: MuJoCo collides with its hull, which fills it."""
    boxes = "".join(
        f"o b{i}\n" + "".join(
            f"v {x + a} {y + b} {c}\n" for a in (-0.5, 0.5) for b in (-0.5, 0.5) for c in (-0.5, 0.5)
        ) + "".join(f"f {' '.join(str(8 * i + 1 + k) for k in face)}\n" for face in
                    ([0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]))
        for i, (x, y) in enumerate([(-1, 0), (0, -1), (1, 0)])
    )  # fmt: skip
    text = mjcf('<body><geom type="mesh" mesh="u"/></body>', '<asset><mesh file="u.obj"/></asset>')
    (body,) = load_mjcf(tmp_path, text, u__obj=boxes).bodies
    assert body.shape.volume == pytest.approx(3.0)


def test_a_mesh_without_faces_is_the_hull_of_its_points_in_double_precision(tmp_path):
    points = "0 0 0  0.1 0 0  0 0.1 0  0 0 0.1  0.01 0.01 0.01"
    text = mjcf(
        '<body><geom type="mesh" mesh="h"/></body>',
        f'<asset><mesh name="h" vertex="{points}"/></asset>',
    )
    (body,) = load_mjcf(tmp_path, text).bodies
    assert body.shape.n_faces == 4 and body.shape.volume == pytest.approx(1e-3 / 6)
    np.testing.assert_allclose(body.shape.bounds, [[0, 0, 0], [0.1, 0.1, 0.1]], rtol=0, atol=1e-16)


def test_what_is_included_stands_where_it_is_included(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "one.xml").write_text(
        f'<mujocoinclude><body name="b">{BALL}</body></mujocoinclude>'
    )
    text = mjcf('<body name="a"><joint/><include file="parts/one.xml"/></body>')
    files = InputFiles(tmp_path)
    text = text.replace("<joint/>", f"<joint/>{BALL}")
    loaded = read_robot(RobotRequest(write_mjcf(tmp_path, text)), MeshStore(files))
    assert loaded.link_names == ("world", "a", "b")
    assert [source.path for source in files.sources] == ["parts/one.xml", "toy.xml"]


def test_files_from_outside_the_models_folder_are_told(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "one.xml").write_text(
        f'<mujocoinclude><body name="b">{BALL}</body></mujocoinclude>'
    )
    loaded = load_mjcf(tmp_path / "in", mjcf('<include file="../one.xml"/>'))
    assert "files outside the model's folder: ../one.xml" in loaded.notes


@pytest.mark.filterwarnings("error")  # numbers that overflow say nothing on the terminal
@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        (mjcf('<body><joint type="slide" axis="1 1e308 0"/><geom size="0.1"/></body>'), BadInput, "axis"),
        (mjcf(f'<body quat="1 0 0 -inf">{BALL}</body>'), ClearanceError, "finite numbers are needed"),
        (mjcf('<body><geom type="hfield" hfield="h"/></body>',
              '<asset><hfield name="h" file="h.png" size="1 1 1 1"/></asset>'), BadInput, "a hfield is not read"),
        (mjcf('<body><geom type="mesh" mesh="n"/></body>', '<asset><mesh name="n" file="n.stl"/></asset>'),
         MissingFile, "mesh 'n': there is no mesh 'n.stl'"),
        (mjcf('<body><geom type="mesh" mesh="n"/></body>', '<asset><mesh name="n" file="http://x/n.stl"/></asset>'),
         BadSyntax, "nothing is fetched"),
        (mjcf('<body><geom type="mesh" mesh="a"/></body>', '<asset><mesh file="a.stl" scale="1 0 1"/></asset>'),
         ClearanceError, "scale"),
        (mjcf('<body><geom siz="1"/></body>'), BadSyntax, "unrecognized attribute: 'siz'"),
        (mjcf("<body><composite/></body>"), BadInput,
         "<composite> '' is not read: it makes bodies that are made by rule"),
        (mjcf("", '<asset><model name="m" file="m.xml"/></asset>'), BadInput, "<model> 'm' is not read"),
        (mjcf('<flexcomp name="f"/>'), BadInput, "a body that bends"),
        (mjcf('<include file="no.xml"/>'), MissingFile, "there is no file 'no.xml'"),
        (mjcf('<include file="toy.xml"/>'), BadInput, "'toy.xml' is included twice"),
        (mjcf("<include/>"), BadInput, "<include> has no file"),
        (mjcf(f'<replicate count="300"><replicate count="300">{BALL}</replicate></replicate>'), BadInput,
         "it makes 90000 bodies"),
        (mjcf(f'<replicate count="1e9">{BALL}</replicate>'), BadInput, "count='1e9'"),
        ('<!DOCTYPE mujoco><mujoco/>', BadSyntax, "a document type or an entity"),
        ("<mujocoinclude/>", BadSyntax, "the root element is <mujocoinclude>; <mujoco> is needed"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_the_file(tmp_path, capfd, text, fault, says):
    told = refusal(load_mjcf, tmp_path, text, of=fault)
    assert told.startswith("toy.xml: ") and says in told and ", line" not in told
    assert capfd.readouterr() == ("", "")


def test_no_library_no_reading(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    with pytest.raises(ClearanceError, match=r"reading MJCF needs mujoco.*clearance\[mujoco\]"):
        load_mjcf(tmp_path, ARM)
