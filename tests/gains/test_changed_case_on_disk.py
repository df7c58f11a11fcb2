"""A changed case as files: what is read back is what was claimed, and nothing else is touched."""

import json
from dataclasses import replace

import pytest

import clearance as cl
from clearance.errors import BadInput, Unwritable
from clearance.gains.folder import save_gain
from clearance.gains.sentences import lines_of
from clearance.gains.turn import Turn
from clearance.world.notice import NOT_MEASURED
from clearance.world.trajectory import Hole
from tests.gains.making_gain import CARRYING, CROSSING, MOVING, SLOT, write_cell
from tests.report.schemas import objections
from tests.simulate.measure.test_quintic_motion import there_and_back


def with_scene_file(folder):
    """The slot with its walls in a file of their own."""
    before, _, rest = SLOT.partition("scene:\n")
    rows, _, after = rest.partition("trajectory:")
    path = write_cell(folder, f"{before}scene: scene/walls.yaml\ntrajectory:{after}")
    (folder / "scene").mkdir()
    (folder / "scene" / "walls.yaml").write_text(
        "\n".join(line.removeprefix("  ") for line in rows.splitlines()) + "\n"
    )
    return path


SDF = """<?xml version="1.0"?><sdf version="1.9"><world name="cell">
{models}</world></sdf>"""
MODEL = """<model name="{name}"><static>true</static><pose>0 {y} 0 0 0 0</pose><link name="board">
<collision name="c"><geometry><box><size>0.5 0.4 2.0</size></box></geometry></collision></link></model>
"""


def with_sdf(folder):
    """The slot with its walls in SDF."""
    before, _, rest = SLOT.partition("scene:\n")
    path = write_cell(
        folder, f"{before}scene: walls.sdf\ntrajectory:{rest.partition('trajectory:')[2]}"
    )
    models = "".join(MODEL.format(name=name, y=y) for name, y in (("left", 0.3), ("right", -0.3)))
    (folder / "walls.sdf").write_text(SDF.format(models=models))
    return path


PLANNING = """\
world:
  collision_objects:
  - {{header: {{frame_id: base}}, id: left, {box}, {left}}}
  - {{header: {{frame_id: base}}, id: right, {box}, {right}}}
allowed_collision_matrix:
  entry_names: [tool, right]
  entry_values: [{{enabled: [false, true]}}, {{enabled: [true, false]}}]
link_padding: [{{link_name: tool, padding: 0.002}}]
"""


def with_planning_scene(folder):
    """The same as MoveIt's planning scene, which lets the bar touch one wall and pads it."""
    before, _, rest = SLOT.partition("scene:\n")
    path = write_cell(
        folder, f"{before}scene: walls.yaml\ntrajectory:{rest.partition('trajectory:')[2]}"
    )
    box = "primitives: [{type: 1, dimensions: [0.5, 0.4, 2.0]}]"
    left, right = (
        f"primitive_poses: [{{position: {{x: 0.0, y: {y}, z: 0.0}}, "
        "orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}]"
        for y in (0.3, -0.3)
    )
    (folder / "walls.yaml").write_text(PLANNING.format(box=box, left=left, right=right))
    return path


def with_turn(folder):
    """The slot with a hub on the bar that turns by 4 rad in a step, the way that its table says."""
    path = write_cell(folder, SLOT.replace("start: 0.5", "start: 0.5, wrap: as_written"))
    urdf, table = folder / "robots" / "bar.urdf", folder / "path.csv"
    hub = '<link name="hub"/><joint name="turn" type="continuous"><parent link="tool"/><child link="hub"/></joint>'
    urdf.write_text(urdf.read_text().replace("</robot>", f"{hub}</robot>"))
    header, *rows = table.read_text().splitlines()
    rows = [f"{row},{4.0 * (i > 20)}" for i, row in enumerate(rows)]
    table.write_text("\n".join([f"{header},turn", *rows, ""]))
    return path


CASES = {
    "a turn as written": (with_turn, "waypoints", {}),
    "waypoints": (lambda folder: write_cell(folder, SLOT), "waypoints", {}),
    "scene file": (with_scene_file, "obstacle", {"obstacle": "left"}),
    "SDF": (with_sdf, "obstacle", {"obstacle": "left/board/c"}),
    "planning scene": (with_planning_scene, "obstacle", {"obstacle": "left"}),
    "turned": (
        lambda folder: write_cell(folder, SLOT),
        "obstacle",
        {"obstacle": "left", "within": (0.0, 0.03, 0.0), "turn": Turn("z", (0.3, 0.1, 0.0))},
    ),
    "turned base": (lambda folder: write_cell(folder, SLOT), "base", {"turn": "z"}),
    "moving": (lambda folder: write_cell(folder, MOVING), "obstacle", {}),
    "moving, turned": (lambda folder: write_cell(folder, MOVING), "obstacle", {"turn": "z"}),
    "slowed": (
        lambda folder: write_cell(folder, CROSSING),
        "timing",
        {"robot": "other", "slow_down": True},
    ),
    "timing of a part": (
        lambda folder: write_cell(folder, CARRYING),
        "timing",
        {"robot": "other"},
    ),
}


@pytest.fixture(scope="module", params=CASES)
def saved(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cell")
    make, kind, how = CASES[request.param]
    path = make(folder)
    before = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    found = cl.gain(path, kind, **how)
    out = save_gain(found, folder / "deep" / "out")
    assert {file: file.read_bytes() for file in before} == before
    return found, out


@pytest.mark.slow
def test_what_is_written_is_read_as_what_was_claimed(saved):
    found, out = saved
    assert found.kept and not found.before.passed
    told = " ".join(line for _, line in lines_of(found))
    is_turned = found.request.turn is not None and found.request.obstacle is None
    assert ("its origin at its first sample" in told) == (
        is_turned and found.request.kind == "obstacle"
    )
    run = cl.check(out / "case.yaml")
    assert run.passed
    for column in ("clearance", "lower_bound"):
        back, told = (one.steps[column].to_numpy() for one in (run, found.after))
        assert back.tobytes() == told.tobytes()


@pytest.mark.slow
def test_the_figures_are_those_of_the_gain_and_the_page_stands_beside_both_reports(saved):
    found, out = saved
    told = json.loads((out / "gain.json").read_text())
    assert told["kept"] and told["before"]["verdict"] != "clear" and told["after"]["passed"]
    slides = found.request.kind == "waypoints" and "turn" not in found.joint_names
    counted = 2.0 if slides else 1.0  # 0.5 m as 1 rad
    assert (told["size"] * counted, told["lower_bound"] * counted) == (
        found.size,
        found.lower_bound,
    )
    assert told["unit"] == ("m" if slides else found.unit)
    if slides:
        amounts = [abs(part["amount"]) for part in told["parts"]]
        assert max(amounts) <= told["size"] * (1.0 + 1e-9) < 1.1 * max(amounts)
    assert objections("gain", told) == [] and told["$schema"] == "urn:clearance:gain:2"
    page = (out / "gain.html").read_text()
    for name in ("before", "after"):
        assert f'href="{name}/report.html"' in page and (out / name / "report.html").is_file()


@pytest.mark.slow
def test_the_same_again_is_the_same_bytes_and_needs_force(tmp_path):
    path = write_cell(tmp_path, SLOT)
    found = cl.gain(path, "base")
    one, two = (save_gain(found, tmp_path / name) for name in ("one", "two"))
    files = [file.relative_to(one) for file in sorted(one.rglob("*")) if file.is_file()]
    assert [(one / file).read_bytes() == (two / file).read_bytes() for file in files].count(
        False
    ) == 0
    with pytest.raises(Unwritable, match="force"):
        save_gain(found, one)
    save_gain(found, one, force=True)
    (one / "before" / "mine.txt").write_text("mine")
    with pytest.raises(Unwritable, match=r"mine\.txt"):
        save_gain(found, one, force=True)
    assert (one / "before" / "mine.txt").read_text() == "mine"


@pytest.mark.slow
def test_comments_stay_and_paths_lead_to_the_same_files(tmp_path):
    path = write_cell(tmp_path / "cell", SLOT)
    out = save_gain(cl.gain(path, "obstacle", obstacle="left"), tmp_path / "out")
    text = (out / "case.yaml").read_text()
    assert "# A bar through a slot." in text and "# fixed by two screws" in text
    assert "urdf: ../cell/robots/bar.urdf # of the shop" in text
    assert "limits: {fail: 0.04, warn: 0.04}  # agreed" in text


@pytest.mark.slow
def test_a_case_of_no_file_and_an_input_are_refused(tmp_path):
    path = write_cell(tmp_path, SLOT)
    with pytest.raises(BadInput, match="no file"):
        save_gain(cl.gain(cl.load_case(path), "base"), tmp_path / "out")
    with pytest.raises(Unwritable, match="which this run reads"):
        save_gain(cl.gain(path, "base"), tmp_path, force=True)
    assert path.read_text() == SLOT


@pytest.mark.parametrize(("kind", "how"), [("waypoints", {}), ("base", {"tool_path": "kept"})])
def test_a_recording_with_holes_is_not_changed(tmp_path, kind, how):
    case = there_and_back(tmp_path)
    (placed,) = case.robots
    holes = (Hole(("rail",), 0.2, 0.3, 0.01, NOT_MEASURED),)
    moved = replace(placed, trajectory=replace(placed.given_trajectory, holes=holes))
    with pytest.raises(BadInput, match="the recording of robot 'cart' has holes"):
        cl.gain(replace(case, robots=(moved,)), kind, **how)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"has_way_in": True}, "how the robot comes to its first point"),
        ({"unread": ("attached_collision_objects",)}, "does not name what is not read"),
    ],
)
def test_a_path_of_which_a_table_does_not_say_all_is_not_changed(tmp_path, more, says):
    case = there_and_back(tmp_path)
    (placed,) = case.robots
    moved = replace(placed, trajectory=replace(placed.given_trajectory, **more))
    with pytest.raises(BadInput, match=says):
        cl.gain(replace(case, robots=(moved,)), "waypoints")
