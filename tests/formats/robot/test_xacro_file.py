"""xacro: what it makes, only where it is asked for; what it reads is hashed, what it cannot do is one line."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from clearance import check, load_case
from clearance.errors import BadInput, BadSyntax, MissingFile, UnknownKey
from clearance.formats.files.input_files import InputFiles
from clearance.formats.robot import request as robot_request
from clearance.formats.robot.request import RobotRequest, load_robot
from clearance.formats.robot.urdf import xacro_file
from clearance.formats.robot.urdf.xacro_file import expanded, variables_asked
from clearance.world.case import Source
from tests.formats.refusal import refusal

pytestmark = pytest.mark.cold  # xacro runs in a process of its own

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

MAIN = f"""<robot name="arm" {NAMESPACE}>
<xacro:arg name="size" default="0.2"/>
<xacro:include filename="$(find arm_description)/urdf/parts.xacro"/>
<xacro:property name="sizes" value="${{xacro.load_yaml('$(find arm_description)/urdf/sizes.yaml')}}"/>
<xacro:block name="base" size="$(arg size)"/>
<xacro:block name="upper" size="${{sizes.upper / 2}}"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 ${{2 * sizes.upper}}"/><limit lower="-1" upper="1"/></joint>
</robot>
"""

PARTS = f"""<robot {NAMESPACE}><xacro:macro name="block" params="name size">
<link name="${{name}}"><collision><geometry>
<box size="${{size}} ${{size}} ${{size}}"/></geometry></collision></link>
</xacro:macro></robot>
"""

SIZES = "upper: 0.4\n"


def write_package(folder: Path, main: str = MAIN, parts: str = PARTS) -> Path:
    """The main file of a package `arm_description`, which lies in a folder of another name: an arm of blocks, the
    sizes of which come from an argument and a YAML file.
    """
    package = folder / "arm"
    (package / "urdf").mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    (package / "urdf" / "parts.xacro").write_text(parts)
    (package / "urdf" / "sizes.yaml").write_text(SIZES)
    path = package / "urdf" / "arm.urdf.xacro"
    path.write_text(main)
    return path


CASE = """robot: {{urdf: arm/urdf/arm.urdf.xacro, {0}}}
scene: {{obstacles: [{{name: post, box: {{size: [0.1, 0.1, 1]}}, pose: {{xyz: [1.2, 0, 0]}}}}]}}
trajectory: path.csv
"""


def write_case(folder, keys="xacro: true"):
    write_package(folder)
    (folder / "path.csv").write_text("time,shoulder\n0,0\n1,0.5\n")
    path = folder / "case.yaml"
    path.write_text(CASE.format(keys))
    return path


def made(path, args=(), package_dirs=()):
    request = RobotRequest(path, package_dirs, xacro=True, xacro_args=args)
    return expanded(request, InputFiles(path.parent))


def body(inner, name="r"):
    return f'<robot name="{name}" {NAMESPACE}>{inner}</robot>'


def test_it_is_what_the_written_out_urdf_is(tmp_path):
    case = load_case(write_case(tmp_path, "xacro: true, xacro_args: {size: 0.3}"))
    base, upper = case.robots[0].robot.bodies
    assert base.shape.vertices.max() == 0.15 and upper.shape.vertices.max() == 0.1
    (tmp_path / "arm" / "urdf" / "arm.urdf").write_bytes(
        made(tmp_path / "arm" / "urdf" / "arm.urdf.xacro", (("size", "0.3"),)).urdf
    )
    (tmp_path / "plain.yaml").write_text(CASE.format("name: arm").replace(".xacro", ""))
    ours, plain = (check(path).record for path in (case, load_case(tmp_path / "plain.yaml")))
    assert ours.clearances.tobytes() == plain.clearances.tobytes()


def test_what_it_reads_is_hashed_and_what_it_did_is_told(tmp_path):
    case = load_case(write_case(tmp_path))
    searched = [source.path for source in case.sources if not source.is_file]
    assert searched == ["(lookup) package arm_description"]
    paths = [source.path for source in case.sources if source.is_file]
    assert paths == [
        "arm/urdf/arm.urdf.xacro", "arm/urdf/parts.xacro", "arm/urdf/sizes.yaml", "case.yaml", "path.csv",
    ]  # fmt: skip
    (note,) = [note for note in case.robots[0].robot.notes if "xacro evaluated it" in note]
    assert "the Python in it and in arm/urdf/parts.xacro, arm/urdf/sizes.yaml;" in note
    assert note.endswith("defaults size:=0.2")


def test_it_is_never_evaluated_unasked(tmp_path):
    path = write_case(tmp_path, "name: arm")
    with pytest.raises(BadSyntax, match=r"xacro evaluates Python in it: `xacro: true` beside urdf"):
        load_case(path)
    (tmp_path / "plain.xacro").write_text("<robot name='a'><link name='b'/></robot>")
    assert "this is a xacro file" in refusal(load_robot, tmp_path / "plain.xacro", of=BadSyntax)
    (tmp_path / "arm.urdf").write_text(body("<xacro:property name='a' value='1'/><link name='b'/>"))
    with pytest.raises(BadSyntax, match="this is a xacro file, not a URDF file; xacro evaluates"):
        load_robot(tmp_path / "arm.urdf")


def test_arguments(tmp_path):
    path = write_case(tmp_path, "xacro: true, xacro_args: {sise: 1}")
    with pytest.raises(UnknownKey, match=r"asks for the argument 'sise'; did you mean 'size'\?"):
        load_case(path)
    path.write_text(CASE.format("xacro_args: {size: 1}"))
    with pytest.raises(BadInput, match=r"robot.xacro_args: arguments of xacro, which is not used"):
        load_case(path)
    path.write_text(CASE.format("xacro: true, xacro_args: {size: [1]}"))
    assert "robot.xacro_args.size" in refusal(load_case, path, of=BadInput)
    assert robot_request.checked_args({"a": True, "b": 0.1, "c": "x y"}) == (
        ("a", "true"), ("b", "0.1"), ("c", "x y"),
    )  # fmt: skip


def test_packages_are_found_by_our_rules(tmp_path, monkeypatch):
    main = write_package(tmp_path / "src")
    lone = tmp_path / "lone.xacro"
    lone.write_text(main.read_text())
    with pytest.raises(BadSyntax, match=r"there is no package 'arm_description'; looked for it in"):
        made(lone)
    found = [made(lone, package_dirs=(tmp_path / "src" / "arm",)).urdf, made(main).urdf]
    assert len({urdf.partition(b"<robot")[2] for urdf in found}) == 1
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src" / "arm"))
    (note,) = [note for note in made(lone).notes if "ROS_PACKAGE_PATH" in note]
    assert "leads to $(find arm_description) as src/arm" in note


def test_defaults_that_are_paths_are_the_same_on_every_machine(tmp_path):
    main = MAIN.replace('default="0.2"', 'default="$(find arm_description)/urdf/sizes.yaml"')
    path = write_package(tmp_path, main.replace("$(arg size)", "${1 if '$(arg size)' else 2}"))
    assert made(path).notes[0].endswith("defaults size:=sizes.yaml")


def test_an_srdf_of_xacro_is_evaluated_where_the_robot_is(tmp_path):
    path = write_case(tmp_path, "xacro: true, srdf: arm.srdf.xacro, joints: {state: up}")
    state = (
        '<group_state name="up" group="${g}"><joint name="shoulder" value="${pi/4}"/></group_state>'
    )
    (tmp_path / "arm.srdf.xacro").write_text(body(f'<xacro:property name="g" value="a"/>{state}'))
    path.write_text(path.read_text().replace("trajectory: path.csv", "").replace(
        "pose: {xyz: [1.2, 0, 0]}", "moves: door.csv"))  # fmt: skip
    (tmp_path / "door.csv").write_text("time,x,y,z,qx,qy,qz,qw\n0,2,0,0,0,0,0,1\n1,3,0,0,0,0,0,1\n")
    case = load_case(path)
    assert case.robots[0].fixed_positions == {"shoulder": math.pi / 4}
    assert "arm.srdf.xacro" in [source.path for source in case.sources]
    path.write_text(path.read_text().replace("arm/urdf/arm.urdf.xacro, xacro: true", "plain.urdf"))
    (tmp_path / "plain.urdf").write_bytes(made(tmp_path / "arm/urdf/arm.urdf.xacro").urdf)
    assert "not an SRDF file; `xacro: true` beside urdf" in refusal(load_case, path, of=BadSyntax)


@pytest.mark.parametrize(
    ("inner", "fault", "says"),
    [
        ('<link name="${nothing}"/>', BadSyntax, "name 'nothing' is not defined when evaluating"),
        (
            '<link name="$(arg nothing)"/>',
            BadSyntax,
            "argument 'nothing' has no value; robot: {xacro_args: {nothing: VALUE}}",
        ),
        (
            "<link name=\"${xacro.load_yaml('')['a']}\"/>",
            BadSyntax,
            "xacro: a file cannot be read (is a directory) when evaluating",
        ),
        ('<xacro:include filename="no.xacro"/>', MissingFile, "there is no file 'no.xacro'"),
        ("<xacro:nothing/>", BadSyntax, "unknown macro name: xacro:nothing"),
        ("<link>", BadSyntax, "arm.urdf.xacro: line 1: xacro: mismatched tag"),
        ('<xacro:include filename="arm.urdf.xacro"/>', BadSyntax, "without end"),
        (
            '<link name="${(lambda: [c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '
            "'Popen'][0](['true']))()}\"/>",
            BadSyntax,
            "arm.urdf.xacro: xacro: ",
        ),
    ],
)
def test_what_stops_it_is_told_in_one_line(tmp_path, inner, fault, says):
    assert says in refusal(made, write_package(tmp_path, body(inner)), of=fault)


def test_an_entity_is_refused(tmp_path):
    document = '<!DOCTYPE robot [<!ENTITY e "x">]>' + body('<link name="&e;"/>')
    assert "an entity is declared" in refusal(made, write_package(tmp_path, document), of=BadSyntax)


@pytest.mark.slow  # the least limit that there is, one second
def test_work_without_end_is_ended(tmp_path, monkeypatch):
    monkeypatch.setattr(xacro_file, "MOST_WORK", 1)
    path = write_package(
        tmp_path, body('<link name="${len([i for i in range(10**12) if 0 > i])}"/>')
    )
    assert "xacro came to no end" in refusal(made, path, of=BadSyntax)


def test_it_has_so_much_memory_and_no_more(tmp_path):
    with pytest.raises(BadSyntax, match="it needs too much memory"):
        made(write_package(tmp_path, body('<link name="${len([0] * 10**9)}"/>')))


@pytest.mark.skipif(os.name != "posix", reason="the system bounds no process")
def test_it_writes_no_file(tmp_path):
    program = (
        "from pathlib import Path\n"
        "from clearance.formats.robot.urdf.xacro_process import _limit_work\n"
        f"_limit_work(9, 1 << 30)\nPath({str(tmp_path / 'a')!r}).write_text('a')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "File too large" in done.stderr and not (tmp_path / "a").read_bytes()


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("<a x='$(env LENGTH)' y='$(optenv WIDTH 0.2)'/>", ("LENGTH", "WIDTH")),
        ("<a x='$( env _A1 )$(env _A1)'/>", ("_A1",)),
        ("<a x='$(arg env) $(find env) ${env}'/>", ()),
    ],
)
def test_which_are_asked_for(text, names, tmp_path):
    path = tmp_path / "robot.urdf.XACRO"
    path.write_text(text)
    gone = Source("gone.xacro", "2", 0, str(tmp_path / "gone.xacro"))
    table = Source("t.csv", "1", len(text), str(path.with_suffix(".csv")))
    assert variables_asked([gone, Source("r", text, len(text), str(path)), table]) == names
