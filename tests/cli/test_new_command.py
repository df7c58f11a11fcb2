"""`clearance new`: the case has the results of the files it is made from; nothing is overwritten or left half."""

import json
import os
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from clearance import load_case
from clearance.cli import run
from clearance.cli.new_given import naming_options
from clearance.errors import BadSyntax
from clearance.formats.files.input_files import path_from
from tests.formats.making import CASE, PATH, cube_stl
from tests.formats.making_case import TWO_JOINTS
from tests.formats.making_messages import ROS2
from tests.formats.making_moveit import FIRST, MESSAGE
from tests.formats.making_sdf import collision, link, model, sdf, world
from tests.programs.arms import FILES

ARM = TWO_JOINTS.replace(
    '<link name="tip"/>',
    '<link name="tip"><collision><origin xyz="0 0 1.5"/><geometry><sphere radius="0.1"/></geometry>'
    "</collision></link>",
)
HELD = MESSAGE.replace("- {link_name: ghost, padding: 1.0}\n", "")
_HEAD, _, _TAIL = HELD.partition("  attached_collision_objects:")
PLANNING = _HEAD + _TAIL[_TAIL.index("allowed_collision_matrix:") :]
SRDF = """<robot name="arm"><disable_collisions link1="base" link2="upper" reason="Adjacent"/>
<disable_collisions link1="upper" link2="tip" reason="Adjacent"/>
<group_state name="home" group="arm"><joint name="shoulder" value="0"/><joint name="lift" value="0.02"/>
</group_state>
<group_state name="out" group="arm"><joint name="shoulder" value="0.5"/></group_state></robot>
"""
SCENE = """obstacles:
- {name: "post, 2", box: {size: [0.1, 0.1, 1]}, pose: {xyz: [2, 0, 1e-3]}}
- {name: cube, mesh: {file: cube.stl, scale: 0.1}, pose: {xyz: [0.9, 0.9, 0]}, padding: 0.01}
- {name: door, box: {size: [0.5, 0.1, 1]}, moves: {file: door.csv, start: 0.25}}
"""
DOOR = "time,x,y,z,qx,qy,qz,qw\n0,-2,0,0,0,0,0,1\n1,-2,1,0,0,0,0,1\n"
DEGREES = "t;shoulder [deg];lift [mm]\n".replace("t;", "time [ms];") + "0;0,5;0\n500;11,25;12,5\n"


@pytest.fixture(autouse=True)
def cell(tmp_path, monkeypatch):
    """The files of a stranger, in `cell`, beside which the cases are made."""
    files = {
        "arm.urdf": ARM, "one.urdf": TWO_JOINTS, "arm.srdf": SRDF,
        "path.csv": PATH, "degrees.csv": DEGREES, "path.yaml": ROS2,
        "scene.yaml": SCENE, "door.csv": DOOR, "world.sdf": sdf(world(model(link(collision())))),
        "case.yaml": CASE, "planning.yaml": PLANNING, "held.yaml": HELD, "cell.scene": FIRST,
    }  # fmt: skip
    (tmp_path / "cell").mkdir()
    for name, text in files.items():
        (tmp_path / "cell" / name).write_text(text)
    (tmp_path / "cell" / "upper.stl").write_bytes(cube_stl())
    (tmp_path / "cell" / "cube.stl").write_bytes(cube_stl())
    monkeypatch.chdir(tmp_path)
    return tmp_path


USUAL = ("--trajectory", "cell/path.csv", "--scene", "cell/scene.yaml")


def new(*words, robot="cell/arm.urdf"):
    return run(["new", "out", "--robot", robot, *map(str, words)])


def summary(capsys, path):
    capsys.readouterr()
    code = run(["check", str(path), "--json"])
    told = json.loads(capsys.readouterr().out)
    return code, {key: told[key] for key in told if key not in ("inputs", "notes")}


def direct(scene, trajectory):
    """The new case with the files that it was made from in place of ours."""
    case = YAML(typ="safe").load(Path("out/case.yaml").read_text())
    case["robot"].pop("padding", None)
    case = {key: case[key] for key in case if key not in ("allow", "carry")}
    case |= {"trajectory": trajectory} | ({} if scene is None else {"scene": scene})
    Path("out/direct.yaml").write_text(json.dumps(case))
    return "out/direct.yaml"


SCRIPT = "movej([{},0,0,0,0,0])\ngrip()\nmovej([0.1,0,0,0,0,0])\n"


@pytest.mark.slow
def test_a_program_stays_the_file_that_it_is(capsys):
    Path("cell/move.script").write_text(SCRIPT.format(0.0))
    words = ["--program", "cell/move.script", "--skip", "grip", "--program-keys", "axes_as: plain"]
    words += ["--flange", "tool_tip", "--scene", "cell/cell.scene"]
    words += [
        "--program-keys",
        "axes: {joint_5: {sign: 1}}",
        "--program-keys",
        "axes: {joint_4: {sign: 1}}",
    ]
    start = ["--start", ",".join(f"joint_{i}={0.2 if i == 1 else 0}" for i in range(1, 7))]
    assert new(*words, *start, robot=str(FILES["heron6"])) == 0
    one = load_case("out/case.yaml").robots[0].trajectory
    assert one.positions[0, 0] == 0.2 and one.positions[-1, 0] == 0.1 and not one.has_way_in
    Path("cell/move.script").write_text(SCRIPT.format(0.4))
    assert new(*words, "--force", robot=str(FILES["heron6"])) == 0
    two = load_case("out/case.yaml").robots[0].trajectory
    assert two.positions[0, 0] == 0.4 and two.has_way_in
    told = capsys.readouterr().out
    assert "trajectory from ../cell/move.script" in told or "from cell/move.script" in told
    assert "axes: {joint_5: {sign: 1}, joint_4: {sign: 1}}" in Path("out/case.yaml").read_text()


HOME, FAR = "movej([0,0,0,0,0,0])", "set_tcp(p[0,0,0,0,0,0])\nmovej(p[0.4,0,0.4,0,0,0])"
TIP = ["--flange", "tool_tip"]


@pytest.mark.parametrize(
    ("more", "move", "told"),
    [
        ([], HOME, "--flange: cell/move.script: there is no link 'tool0'"),
        (["--flange", "hand"], HOME, "--flange: cell/move.script: there is no link 'hand'"),
        (["--entry", "weld"], HOME, "--entry: cell/move.script: there is no function 'weld'"),
        ([*TIP, "--start", "home"], HOME, "--start: state 'home' is in no file; --srdf FILE"),
        (TIP, FAR, "--program: cell/move.script: line 2: the first move ends at a pose, and the joints at its "
         "beginning are unknown; --start JOINT=VALUE"),
        (TIP, "movel(p[0.4,0,0.4,0,0,0])", "; --program-keys '{tools: {tcp: {xyz: […]}}}'"),
        ([*TIP, "--start", "joint_1=x"], HOME, "joint_1=0.5,joint_2=0, or a state"),
        (["--program-keys", "[1]"], HOME, "'[1]' has no keys; as in 'zones: {CNT: 0.05}'"),
        (["--program-keys", "a: b: c"], HOME, "'a: b: c': line 1: not YAML"),
        (["--program-keys", "file: cell/other.script, axes_as: ur"], HOME,
         "file is given twice: cell/move.script and cell/other.script; one of them"),
        (TIP, "set_tcp(p[0,0,0,0,0,0])\n" + HOME, "--program: cell/move.script: axes: with the axes of Universal "
         "Robots at 0, "),
    ],
)  # fmt: skip
def test_an_error_of_a_program_names_the_option_that_answers_it(more, move, told, refusal):
    Path("cell/move.script").write_text(move + "\n")
    asked = ("--robot", FILES["heron6"], "--program", "cell/move.script", *more)
    said = refusal("new", "out", *asked)
    assert told in said and "trajectory" not in said


@pytest.mark.parametrize(
    ("scene", "trajectory"),
    [
        (None, "path.yaml"),
        ("scene.yaml", "degrees.csv"),
        ("held.yaml", "path.csv"),
    ],
)
@pytest.mark.slow
def test_it_has_the_results_of_the_files_it_is_made_from(capsys, scene, trajectory):
    words = ["--trajectory", f"cell/{trajectory}", *(["--scene", f"cell/{scene}"] if scene else [])]
    assert new(*words, "--srdf", "cell/arm.srdf") == 0
    ours = summary(capsys, "out/case.yaml")
    path = direct(scene and f"../cell/{scene}", f"../cell/{trajectory}")
    theirs = summary(capsys, path)
    origins = [[one.pop("origin", None) for one in told["obstacles"]] for _, told in (ours, theirs)]
    assert ours == theirs and len(origins[0]) == len(origins[1])
    text = Path("out/case.yaml").read_text()
    assert ("padding" in text) == (scene == "held.yaml")
    assert ("\ncarry:" in text) == (scene == "held.yaml")


def test_it_says_what_it_took_and_what_it_assumed(capsys):
    assert new(*USUAL) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == (
        "took      robot 'arm' from cell/arm.urdf: 3 links, 3 of them with a shape, 2 joints to move"
    )
    assert "took      trajectory from cell/path.csv: 3 samples of 1 joint, 0 to 1 s" in told
    assert "took      scene from cell/scene.yaml: 3 obstacles" in told
    assert "assumed   link 'base' stands at the origin of the world" in told
    assert "assumed   joints that nothing moves rest at 0: lift" in told
    assert (
        "assumed   fail limit 0 mm: only contact fails, any gap passes; "
        "--fail-mm 5, or limits: in case.yaml, asks for 5 mm" in told
    )
    assert told[-1] == "run       clearance check out/case.yaml --out out/report"
    text = Path("out/case.yaml").read_text()
    assert "#   lift: 0.0  # assumed: nothing moves it" in text and "urdf: ../cell/arm.urdf" in text
    assert "file: ../cell/cube.stl" in Path("out/scene.yaml").read_text()
    assert run(["check", "out/case.yaml"]) in (0, 1)
    warned = "warning     1 of 2 joints is given by nobody and stays at 0: 'lift'"
    assert warned in capsys.readouterr().out


def test_how_a_file_was_read_stays_in_the_case(capsys):
    words = ["--trajectory", "cell/degrees.csv", "--scene", "cell/planning.yaml", "--check"]
    assert new(*words) == 0
    told = capsys.readouterr().out.partition("\nrun ")[0]
    read = "cell/degrees.csv: columns are separated by semicolons, decimals written with commas"
    frame = "cell/planning.yaml: "
    assert f"note      {read}" in told and f"note      {frame}" in told
    assert f"# {read}" in Path("out/case.yaml").read_text()
    assert f"# {frame}" in Path("out/scene.yaml").read_text()


@pytest.mark.slow
def test_a_scene_whose_reader_warns_stays_the_file_that_it_is(capsys):
    seen = sdf(world(model(link(collision()), link("<visual name='v'/>", name="seen"))))
    Path("cell/world.sdf").write_text(seen)
    assert new("--trajectory", "cell/path.csv", "--scene", "cell/world.sdf", "--check") == 1
    told = capsys.readouterr().out
    assert "stays the file that it is" in told and "warning" in told.partition("run  ")[2]
    assert not Path("out/scene.yaml").exists()
    assert "scene: ../cell/world.sdf" in Path("out/case.yaml").read_text()


def test_states_of_the_srdf_make_a_motion_and_rest(capsys):
    assert new("--srdf", "cell/arm.srdf", "--states", "home,out,home") == 0
    told = capsys.readouterr().out
    assert "assumed   from state to state all joints move straight, 2 s each" in told
    assert Path("out/trajectory.csv").read_text() == (
        "time,shoulder,lift\n0.0,0.0,0.02\n2.0,0.5,0.02\n4.0,0.0,0.02\n"
    )
    words = ["--trajectory", "cell/path.csv", "--srdf", "cell/arm.srdf", "--force"]
    assert new(*words, "--rest", "home") == 0
    assert load_case("out/case.yaml").robots[0].fixed_positions == {"lift": 0.02}
    assert new(*words) == 0
    text = Path("out/case.yaml").read_text()
    assert "# state: home  # where a state says; there are [home, out]" in text


def test_the_base_is_where_the_states_put_it(capsys):
    srdf = Path("cell/arm.srdf")
    text, root = srdf.read_text(), '<joint name="root" value="0 0 0.5 0 0 0 1"/>'
    srdf.write_text(text.replace('name="home" group="arm">', f'name="home" group="arm">{root}'))
    assert new("--srdf", "cell/arm.srdf", "--states", "home,out") == 0
    assert "link 'base' stands at the origin" not in capsys.readouterr().out
    case = load_case("out/case.yaml")
    assert case.robots[0].world_from_base[:3, 3].tolist() == [0.0, 0.0, 0.5]
    moved = srdf.read_text().replace(
        'name="out" group="arm">', f'name="out" group="arm">{root.replace("0.5", "0.6")}'
    )
    srdf.write_text(moved)
    assert new("--srdf", "cell/arm.srdf", "--states", "home,out", "--force") == 2
    assert "joint 'root': it puts the robot's base elsewhere" in capsys.readouterr().err


def test_a_base_that_moves_and_that_nobody_places_is_left_to_the_check(capsys):
    srdf, root = Path("cell/arm.srdf"), '<virtual_joint name="root" type="planar"/></robot>'
    srdf.write_text(srdf.read_text().replace("</robot>", root))
    assert new("--srdf", "cell/arm.srdf", "--states", "home,out") == 0
    written = Path("out/case.yaml")
    row = "base: {xyz: [0.0, 0.0, 0.0], rpy: [0.0, 0.0, 0.0]}  # assumed: link 'base' stands at the origin"
    for text, is_warned in (
        (written.read_text(), True),
        (written.read_text().replace(f"  # {row}", f"  {row}"), False),
    ):
        written.write_text(text)
        capsys.readouterr()
        assert run(["check", "out/case.yaml"]) in (0, 1)
        told = capsys.readouterr().out
        assert ("virtual joint 'root' of the SRDF moves the base" in told) == is_warned


def test_what_a_scene_says_is_held_is_carried_also_between_states():
    words = ["--srdf", "cell/arm.srdf", "--states", "home,out", "--scene", "cell/held.yaml"]
    assert new(*words) == 0
    (carry,) = load_case("out/case.yaml").carries
    assert (carry.part, carry.by, carry.window.start) == ("tool", "tip", 0.0)


@pytest.mark.slow
def test_limit_files_are_named_where_they_lie(capsys):
    Path("cell/l.yaml").write_text(
        "joint_limits: {shoulder: {has_velocity_limits: true, max_velocity: 0.1}}"
    )
    assert new(*USUAL, "--joint-limits", "cell/l.yaml", "--check") == 0
    told = capsys.readouterr().out
    assert "joint 'shoulder' moves at up to 0.5 rad/s, its limit is 0.1" in told
    assert "joint_limits: ../cell/l.yaml" in Path("out/case.yaml").read_text()


def test_visual_shapes_are_taken_where_there_are_no_others(capsys):
    Path("cell/arm.urdf").write_text(ARM.replace("collision>", "visual>"))
    assert new(*USUAL) == 0
    told = capsys.readouterr().out
    assert "assumed   no link has a collision shape: the visual shapes are measured" in told
    assert "geometry: visual" in Path("out/case.yaml").read_text()
    assert new(*USUAL, "--geometry", "collision", "--force") == 2
    assert "no link has a collision shape" in capsys.readouterr().err


def test_joints_that_cannot_be_at_zero_rest_at_their_limit(capsys):
    Path("cell/arm.urdf").write_text(
        ARM.replace('lower="0" upper="0.1"', 'lower="0.05" upper="0.1"')
    )
    assert new(*USUAL) == 0
    assert "rest at the limit next to it: lift 0.05" in capsys.readouterr().out
    assert load_case("out/case.yaml").robots[0].fixed_positions == {"lift": 0.05}


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (USUAL[2:], "nothing moves: no trajectory is given; --trajectory FILE (a CSV of two rows will do"),
        ((*USUAL[:2], "--robot", "cell/one.urdf"), "nothing stands around the robot; --scene FILE"),
        ((*USUAL, "--rest", "home"), "state 'home' is in no file"),
        (("--skip", "grip"), "--skip needs --program FILE"),
        ((*USUAL, "--program", "cell/move.script"), "both --program and another motion"),
        (("--srdf", "cell/arm.srdf", "--states", "home"), "1 state is given; two or more"),
        (("--srdf", "cell/arm.srdf", "--states", "home,"), "'home,' has an empty name"),
        ((*USUAL, "--states", "home,out"), "both --trajectory and --states home,out; one of them"),
        ((*USUAL[2:], "--topic", "/a"), "--topic says how a trajectory is read; --trajectory FILE is missing"),
        ((*USUAL, "--package-dir", "no"), "robot.package_dirs: [0]: there is no folder 'no'"),
        ((*USUAL[:2], "--scene", "cell/no.sdf"), "scene: cell/no.sdf: there is no file 'cell/no.sdf'"),
        ((*USUAL, "--robot", "cell/case.yaml"), "cell/case.yaml: this is a case file, not a URDF file; `"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_and_leaves_nothing(refusal, words, says):
    assert says in refusal("new", "out", "--robot", "cell/arm.urdf", *words)


@pytest.mark.parametrize(
    ("valid", "told"),
    [
        ("give its folder in robot.package_dirs", "give its folder in --package-dir"),
        ("robot: {xacro_args: {name: VALUE}}", "--xacro-arg name:=VALUE"),
        ('includes: {"model://sun": skip} in the case leaves it out', "--include model://sun=skip leaves it out"),
    ],
)  # fmt: skip
def test_errors_name_options_in_place_of_keys_of_a_case(valid, told):
    with pytest.raises(BadSyntax) as caught, naming_options():
        raise BadSyntax("looked for it in robot.package_dirs", where="robot.urdf", valid=valid)
    assert str(caught.value) == f"--robot: looked for it in --package-dir; {told}"


def test_nothing_is_overwritten_unasked(refusal):
    Path("out").mkdir()
    Path("out/scene.yaml").write_text("mine")
    Path("out/notes.txt").write_text("mine too")
    told = refusal("new", "out", "--robot", "cell/arm.urdf", *USUAL)
    assert "out/scene.yaml: already exists; --force overwrites it" in told
    assert new(*USUAL, "--force") == 0
    assert Path("out/notes.txt").read_text() == "mine too"
    assert Path("out/scene.yaml").read_text() != "mine"


def test_paths_are_relative_where_that_is_short_and_means_one_place(tmp_path):
    assert path_from(tmp_path / "out", "cell/arm.urdf") == "../cell/arm.urdf"
    assert path_from(tmp_path / "a/b/c/d/e/f", "cell/arm.urdf") == str(tmp_path / "cell/arm.urdf")
    assert path_from(tmp_path / "out", "pybullet_data:a.urdf") == "pybullet_data:a.urdf"
    assert path_from(tmp_path / "out", "/nowhere.urdf") == "/nowhere.urdf"
    (tmp_path / "far" / "away").mkdir(parents=True)
    os.symlink(tmp_path / "far" / "away", tmp_path / "link")
    assert path_from(tmp_path / "link", "cell/arm.urdf") == str(tmp_path / "cell/arm.urdf")


@pytest.mark.slow
def test_what_no_table_says_of_a_motion_stays_in_a_file_that_does(tmp_path):
    """A recording with a hole, and points with accelerations."""
    pytest.importorskip("rosbags", reason="bags are made by rosbags")
    from tests.formats.making_bags import state, write_bag

    times = [i / 50 for i in range(201) if i <= 50 or i >= 150]
    bag = write_bag(
        tmp_path / "cell" / "bags", "mcap", {"/s": [state(t, [0.0, 0.0]) for t in times]}
    )
    args = ["new", "made", "--robot", "cell/one.urdf", "--scene", "cell/scene.yaml", "--trajectory"]
    assert run([*args, os.path.relpath(bag, tmp_path)]) == 0
    text = Path("made/case.yaml").read_text()
    assert "trajectory: ../cell/bags/run/run.mcap  # from" in text
    assert (
        "# trajectory: {file: ../cell/bags/run/run.mcap, gaps: hold}  # or linear, or not" in text
    )
    assert run(["check", "made/case.yaml"]) == 2
    bent = ROS2.replace("accelerations: []", "accelerations: [0.5, 0.0]")
    Path("cell/bent.yaml").write_text(bent)
    assert run([*args, "cell/bent.yaml", "--force"]) == 0
    points = load_case(Path("made/case.yaml")).robots[0].trajectory.points
    assert points.accelerations.tolist() == [[0.5, 0.0]] * 2


def test_a_doubt_about_the_unit_of_a_table_stays_with_its_file(capsys):
    """Two columns in degrees, with the numbers of radians: written anew, they would look right."""
    Path("cell/two.urdf").write_text(ARM.replace('"prismatic"', '"revolute"'))
    Path("cell/odd.csv").write_text("time,shoulder [deg],lift [deg]\n0,0,0\n1,0.5,1.5\n")
    assert new("--trajectory", "cell/odd.csv", *USUAL[2:], robot="cell/two.urdf") == 0
    assert "trajectory: ../cell/odd.csv" in Path("out/case.yaml").read_text()
    capsys.readouterr()
    assert run(["check", "out/case.yaml"]) == 2
    assert "is the table in radians" in capsys.readouterr().out


def test_limits_are_those_that_are_given():
    assert new(*USUAL, "--fail-mm", "7.5", "--warn-mm", "20") == 0
    limits = load_case("out/case.yaml").limits
    assert (limits.fail, limits.warn) == (0.0075, 0.02)


def test_an_empty_scene_is_in_the_headline(capsys):
    assert new("--srdf", "cell/arm.srdf", "--states", "home,out", "--check") in (0, 1)
    told = capsys.readouterr().out
    assert "surroundings (the scene is empty) not checked" in told
