"""SDF worlds and models: which solids they are, where frames and includes put them, and what is told."""

import numpy as np
import pytest

import clearance as cl
from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.errors import BadInput
from clearance.formats.scene.sdf import scope
from clearance.geometry.pose import pose_from_rpy
from clearance.world.notice import Severity
from tests.formats.making import CASE, CUBE, cube_stl, write_case
from tests.formats.making_case import load_small
from tests.formats.making_glb import cube_document, glb
from tests.formats.making_sdf import (
    BOX,
    at,
    collision,
    content_of,
    include,
    library,
    link,
    model,
    obstacles_of,
    places_of,
    pose,
    sdf,
    world,
)
from tests.formats.refusal import refusal

SHAPES = [
    (BOX, cl.box((0.2, 0.4, 0.6))),
    ("<sphere><radius>0.3</radius></sphere>", cl.sphere(0.3)),
    ("<cylinder><radius>0.3</radius><length>2</length></cylinder>", cl.cylinder(radius=0.3, length=2.0)),
    ("<capsule><radius>0.3</radius><length>2</length></capsule>", cl.capsule(radius=0.3, length=2.0)),
    ("<ellipsoid><radii>0.3 0.2 0.1</radii></ellipsoid>", cl.ellipsoid((0.3, 0.2, 0.1))),
]  # fmt: skip


@pytest.mark.parametrize(("element", "shape"), SHAPES)
def test_a_shape_is_what_python_makes(tmp_path, element, shape):
    (made,) = obstacles_of(tmp_path, sdf(model(link(collision(element))))).values()
    assert made.name == "m/l/c" and np.array_equal(made.body.shape.vertices, shape.vertices)


def test_a_glb_lies_as_in_gazebo_which_does_not_turn_it(tmp_path):
    (tmp_path / "cube.glb").write_bytes(glb(*cube_document(CUBE + [0, 1, 0])))
    mesh = "<mesh><uri>cube.glb</uri><scale>1 2 3</scale></mesh>"
    (made,) = obstacles_of(tmp_path, sdf(model(link(collision(mesh))))).values()
    corners = (CUBE + [0, 1, 0]) * [1, 2, 3]
    assert sorted(made.body.shape.vertices.tolist()) == sorted(corners.tolist())


@pytest.mark.parametrize("normal", ["0 0 1", "0 0 -2", "1 0 0", "0 -1 0", "1 1 1"])
def test_a_plane_is_a_box_below_it(tmp_path, normal):
    plane = f"<plane><normal>{normal}</normal><size>1 1</size></plane>"
    document = sdf(model(link(collision(plane))))
    (made,) = obstacles_of(tmp_path, document).values()
    turn = made.world_from_body
    unit = np.array(normal.split(), dtype=float)
    along = (made.body.shape.vertices @ turn[:3, :3].T + turn[:3, 3]) @ unit / np.linalg.norm(unit)
    assert along.max() == pytest.approx(0, abs=1e-13)
    assert along.min() == pytest.approx(-20, abs=1e-12)
    assert any("is a box 20 m deep" in note for note in content_of(tmp_path, document).notes)


def test_poses_are_relative_to_what_they_say(tmp_path):
    inner = model(at(100), link(at(1000), collision()), name="in")
    frame = f'<frame name="f" attached_to="b">{at(5)}</frame>'
    joint = f'<joint name="j" type="fixed"><parent>a</parent><child>b</child>{at(7)}</joint>'
    parts = [
        link(at(1), collision(BOX, at(10)), name="a"),
        link(at(2, "a"), collision(BOX, at(20, "__model__"), name="d"), collision(), name="b"),
        link(at(0.5, "f"), collision(), name="c"),
        link(at(0.25, "j"), collision(), name="e"),
        link(at(1, "in::l"), collision(), name="g"),
    ]
    places = places_of(tmp_path, sdf(world(model(at(10000), *parts, inner, frame, joint))))
    assert places == {
        "m/a/c": 10011,
        "m/b/d": 10020,
        "m/b/c": 10003,
        "m/c/c": 10008.5,
        "m/e/c": 10010.25,
        "m/g/c": 11101,
        "m/in/l/c": 11100,
    }


def test_a_placement_frame_is_what_the_pose_is_of(tmp_path):
    placed = model(at(10), link(at(3), collision()), name="m", attributes=' placement_frame="l"')
    other = model(at(1, "m"), link(collision()), name="n")
    assert places_of(tmp_path, sdf(world(placed, other))) == {"m/l/c": 10, "n/l/c": 8}


@pytest.mark.parametrize(
    "text",
    [
        pose("1 2 3 0.1 0.2 0.3"),
        pose("1 2 3 5.729577951308232 11.459155902616464 17.188733853924695", "", ' degrees="true"'),
        pose("1 2 3 0.034270798 0.106020511 0.143572175 0.983347443", "", ' rotation_format="quat_xyzw"'),
    ],
)  # fmt: skip
def test_rotations_are_read_as_they_are_written(tmp_path, text):
    (made,) = obstacles_of(tmp_path, sdf(model(text, link(collision())))).values()
    expected = pose_from_rpy([1, 2, 3], [0.1, 0.2, 0.3])
    assert np.abs(made.world_from_body - expected).max() < 3e-9


@pytest.mark.parametrize(
    "shape", ["", "<sphere><radius>0</radius></sphere>", "<box><size>0 0.0 0</size></box>"]
)
def test_collisions_of_no_size_are_left_out_with_a_warning_that_names_them(tmp_path, shape):
    document = sdf(model(link(collision(), collision(shape, name="d"), "<collision name='e'/>")))
    assert [*obstacles_of(tmp_path, document)] == ["m/l/c"]
    (notice,) = content_of(tmp_path, document).notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "geometry")
    assert notice.text == "collisions without a size, not measured: 'm/l/d', 'm/l/e'"


def test_included_models_are_found_and_placed(tmp_path):
    library(tmp_path / "models")
    library(tmp_path / "models", "wall", config=False)
    document = sdf(
        world(
            include(),
            include("<name>two</name>", at(5)),
            include(uri="model://wall"),
            include(at(7), "<name>three</name>", uri="models/wall/model.sdf"),
        )
    )
    places = places_of(tmp_path, document, [tmp_path / "models"])
    assert places == {"post/l/c": 1, "two/l/c": 5, "wall/l/c": 1, "three/l/c": 7}
    assert content_of(tmp_path, document, [tmp_path / "models"]).notes == ()


@pytest.mark.parametrize(
    "uri",
    [
        "file://models/post",
        "file://post",
        "file://{}/models/post",
        "file://localhost{}/models/post",
    ],
)
def test_a_model_and_a_mesh_may_be_named_as_a_file(tmp_path, uri):
    library(tmp_path / "models")
    (tmp_path / "models" / "cube.stl").write_bytes(cube_stl())
    mesh = link(
        collision(f"<mesh><uri>{uri.format(tmp_path).replace('post', 'cube.stl')}</uri></mesh>")
    )
    document = sdf(world(include(uri=uri.format(tmp_path)), model(at(2), mesh)))
    places = places_of(tmp_path, document, [tmp_path / "models"])
    assert places == {"post/l/c": 1, "m/l/c": 2}


def test_a_merged_model_gives_its_links_to_what_includes_it(tmp_path):
    library(tmp_path)
    document = sdf(
        model(include(attributes=' merge="true"'), link(at(1, "l"), collision(), name="k"))
    )
    assert places_of(tmp_path, document) == {"m/l/c": 1, "m/k/c": 2}


def test_names_are_made_unique_and_shown(tmp_path):
    library(tmp_path)
    content = content_of(tmp_path, sdf(world(include(), include(at(3)))))
    names = [row["name"] for row in content.scene["obstacles"]]
    assert names == ["post/l/c", "post/l/c_2"]
    assert content.notes == ("cell.sdf: names that are there twice are numbered: 'post/l/c_2'",)
    assert places_of(tmp_path, sdf(world(include(), include(at(3)))))["post/l/c_2"] == 3


def test_comments_and_prefixes_are_as_gazebo_takes_them(tmp_path):
    shape = "<!-- gz topic --echo <box> -->" + collision(BOX) + "<gz:policies gz:type='a'/>"
    for inside in (shape, "<!-- one <!-- two -->" + collision(BOX) + "-->"):
        assert [*obstacles_of(tmp_path, sdf(model(link(inside))))] == ["m/l/c"]
    with pytest.raises(BadInput, match=r"not XML: .*line 5"):
        obstacles_of(tmp_path, sdf("<!--\n\n-- -->\n<model>"))


def test_what_is_left_out_is_told(tmp_path):
    seen = f'<visual name="v"><geometry>{BOX}</geometry></visual>'
    joint = '<joint name="j" type="revolute"><parent>a</parent><child>b</child></joint>'
    document = sdf(
        world(
            '<light name="sun"/><actor name="walker"/>',
            include(uri="model://sun"),
            model(link(seen, name="a"), link(seen, collision(), name="b"), joint, "<plugin/>"),
        )
    )
    content = content_of(tmp_path, document)
    assert content.notes == (
        "cell.sdf: left out: 2 <visual>, 1 <light>, 1 <plugin>",
        "cell.sdf: joints stand at zero, as the links are placed: 1 that could move",
        "cell.sdf: model://sun is not there: taken for the usual light and left out",
    )
    assert {notice.severity for notice in content.notices} == {Severity.WARNING}
    links, actors = (notice.text for notice in content.notices)
    assert "not measured: 'm/a'" in links and "not measured: 'walker'" in actors


def test_what_is_not_read_stands_in_a_note_or_where_it_may_be_a_place_in_a_warning(tmp_path):
    shift = "<shift><xyz>0 0 1</xyz></shift>"
    content = content_of(tmp_path, sdf(model(link(collision(), shift), "<colour>red</colour>")))
    assert content.notes == ("cell.sdf: not read: <colour>",)
    (notice,) = content.notices
    assert notice.severity is Severity.WARNING and notice.text.endswith("<shift> in link 'l'")


def test_poses_that_look_like_degrees_are_suspect_and_those_of_plugins_passed_over(tmp_path):
    other = f'<plugin name="p">{link(pose("a b c d e f"))}</plugin>'
    document = sdf(model(pose("0 0 0 0 0 90"), link(collision()), other))
    (notice,) = content_of(tmp_path, document).notices
    assert notice.severity is Severity.SUSPECT and "model 'm' has an angle of 90 rad" in notice.text


def state(text):
    return f'<state world_name="w"><model name="m">{text}</model></state>'


def test_a_saved_state_must_be_as_the_world_is_placed(tmp_path):
    placed = model(at(1), link(at(1), collision()))
    here = state(at("1.00001") + f'<link name="l">{at(2)}</link>')
    assert places_of(tmp_path, sdf(world(placed, here))) == {"m/l/c": 2}
    with pytest.raises(BadInput, match="state: model 'm': it was saved with a scale of 2 2 2"):
        content_of(tmp_path, sdf(world(placed, state("<scale>2 2 2</scale>"))))
    with pytest.raises(BadInput, match="state: model 'm': link 'l': it was saved elsewhere"):
        content_of(tmp_path, sdf(world(placed, state(f'<link name="l">{at(3)}</link>'))))


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (sdf(version="1.12"), "sdf: version 1.12 is given; 1.11 or older is read"),
        ("<robot/>", "the root element is <robot>"),
        ('<!DOCTYPE x [<!ENTITY a "b">]>' + "<sdf/>", "a document type or an entity"),
        (sdf(world(), world()), "2 worlds are given"),
        (sdf("<model/>"), "model None: <model> has no name"),
        (sdf(model(link(collision("<box/><sphere/>")))), "geometry: <box>, <sphere> is given"),
        (sdf(model(link(collision("<heightmap/>")))), "<heightmap>: it is not read: its surface is a picture"),
        (
            sdf(model(link(collision("<box><size>1 2</size></box>")))),
            "model 'm': link 'l': collision 'c': <box>: <size> is '1 2'; 3 numbers are needed",
        ),
        (sdf(model(link(collision("<sphere/>")))), "<sphere> has no <radius>"),
        (sdf(model(link(collision("<mesh><uri>a.stl</uri><submesh/></mesh>")))), "a <submesh> is asked for"),
        (sdf(model(link(at(1, "ll"), collision()))), "no frame 'll'; did you mean 'l'?"),
        (sdf(model(link(at(1, "k")), link(at(1, "l"), collision(), name="k"))), "is relative to itself"),
        (sdf(world("<population/>")), "<population> places models at random"),
        (sdf(world(include(uri="https://x/y"))), "nothing is fetched"),
        (sdf(world(include(uri="cell.sdf"))), "cell.sdf includes itself"),
        (sdf(world(include(uri="model://none"))), "there is no model"),
        (sdf(world(include(uri="a" * 5000))), "there is no model"),
        (sdf(model("<pose relativeto='x'/>", link(collision()))), "model 'm' pose: relativeto='x' is not read"),
        (sdf(model(link(at(1), at(2), collision()))), "link 'l': two <pose> are given; one"),
        (sdf(model(link("<collision name='c'>0 0 1</collision>"))), "collision 'c': the text '0 0 1' is not read"),
        (sdf(model(link(collision()), "<geom><box size='1'/></geom>")), "model 'm': <geom> is not read"),
        (sdf(model(*["<model name='x'>"] * 60, *["</model>"] * 60)), "40 deep in each other"),
    ],
)  # fmt: skip
def test_a_fault_is_one_line_with_its_place(tmp_path, document, says):
    told = refusal(content_of, tmp_path, document, of=BadInput)
    assert told.startswith("cell.sdf: ") and says in told


def test_files_that_include_each_other_many_times_end(tmp_path, monkeypatch):
    monkeypatch.setattr(scope, "MOST_SHAPES", 500)
    for i in range(12):
        parts = [include(f"<name>n{j}</name>", uri=f"model://m{i + 1}") for j in range(10)]
        library(tmp_path, f"m{i}", sdf(model(*parts)), config=False)
    library(tmp_path, "m12", config=False)
    with pytest.raises(BadInput, match="more than 500 collisions"):
        content_of(tmp_path, sdf(world(include(uri="model://m0"))))


FUEL = "https://fuel.gazebosim.org/1.0/openrobotics/models/Table"
MISSING = sdf(
    world(include(uri="model://crate"), include(at(3), uri=FUEL), model(at(2), link(collision())))
)


def with_includes(folder, said):
    case = CASE.partition("scene:")[0] + "scene: w.sdf\ntrajectory: path.csv\n"
    return load_small(folder, case + f"includes: {said}\n", w__sdf=MISSING)


def test_a_model_that_is_missing_is_left_out_or_taken_from_elsewhere_where_the_case_says_so(
    tmp_path,
):
    library(tmp_path / "own")
    case = with_includes(tmp_path, f"{{'model://crate': skip, '{FUEL}': own/post}}")
    places = {one.name: one.world_from_body[0, 3] for one in case.obstacles}
    assert places == {"post/l/c": 3, "m/l/c": 2}
    assert {one.severity for one in case.notices} == {Severity.WARNING}
    assert [one.text for one in case.notices] == [
        "included models left out, as the case says: 'model://crate'",
        f"models used in place of others, as the case says: post for '{FUEL}'",
    ]
    case = with_includes(tmp_path, f"{{'model://crate': 'file://own/post', '{FUEL}': skip}}")
    assert [one.name for one in case.obstacles] == ["post/l/c", "m/l/c"]


@pytest.mark.parametrize(
    ("said", "says"),
    [
        ("{}", 'includes: {"model://crate": skip} in the case leaves it out, a path in place of skip uses'),
        ("{'model://crate': skip}", f'includes: {{"{FUEL}": skip}} in the case leaves it out'),
        (f"{{'model://crate': skip, '{FUEL}': skip, 'model://crat': skip}}",
         "includes names 'model://crat', which the scene does not include; did you mean 'model://crate'?"),
        ("{'model://crate': none}", "there is no model"),
    ],
)  # fmt: skip
def test_an_include_that_leads_nowhere_is_refused_with_what_to_say(tmp_path, said, says):
    assert says in refusal(with_includes, tmp_path, said, of=BadInput)


def test_includes_of_what_is_no_sdf_file_are_refused(tmp_path):
    said = "includes: {'model://crate': skip}\n"
    told = refusal(load_small, tmp_path, CASE + said, of=BadInput)
    assert "includes: the scene stands in the case itself" in told
    case = CASE.partition("scene:")[0] + "scene: s.yaml\ntrajectory: path.csv\n"
    told = refusal(load_small, tmp_path, case + said, s__yaml="obstacles: []\n", of=BadInput)
    assert "includes are given, and s.yaml is no SDF file" in told


def test_new_and_convert_leave_models_out_or_take_others_too(tmp_path, monkeypatch, capsys):
    library(tmp_path / "own")
    write_case(tmp_path, w__sdf=MISSING)
    monkeypatch.chdir(tmp_path)
    said = ["--include", "model://crate=skip", "--include", f"{FUEL}=own/post"]
    words = ["--robot", "arm.urdf", "--trajectory", "path.csv", "--scene", "w.sdf"]
    assert run(["new", "out", *words]) == 2
    assert "--include model://crate=skip" in capsys.readouterr().err
    assert run(["new", "out", *words, *said]) == 0
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert f'includes: {{"model://crate": skip, "{FUEL}": ../own/post}}' in text
    places = [one.world_from_body[0, 3] for one in load_case("out/case.yaml").obstacles]
    assert places == [3, 2]
    assert run(["convert", "w.sdf", "scene.yaml", *said]) == 0
    told = "included models left out, as the case says: 'model://crate'"
    assert told in capsys.readouterr().err and told in (tmp_path / "scene.yaml").read_text()
    assert run(["convert", "path.csv", "path.yaml", *said]) == 2
    assert "--include says nothing about" in capsys.readouterr().err
