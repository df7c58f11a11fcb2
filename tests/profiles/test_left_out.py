"""Motion and links that a sweep leaves out, and input that it rests on, stand with every outline of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.cli import run
from clearance.errors import UnknownLink
from clearance.findings.limit_lines import profile_text
from clearance.profiles.outline_file import read_outline
from clearance.profiles.profile_file import (
    dxf_text,
    geojson_text,
    svg_text,
    write_profile,
    yaml_text,
)
from clearance.report.junit_cases import results_of
from clearance.world.case import ReservedSpace
from clearance.world.notice import NOT_MEASURED, Notice, Severity
from clearance.world.robot import JointKind
from clearance.world.trajectory import Hole
from tests.formats.making import ARM, CASE, write_case
from tests.profiles.moving import Z, free_circle, joint, moved, turning
from tests.profiles.test_zones import ARM as SLAB
from tests.profiles.test_zones import POST, squares
from tests.report.made import page_of, summary_of

SHOWN = '<link name="tip"><visual><geometry><box size="0.3 0.3 0.3"/></geometry></visual></link>'
HOLE = "not swept: motion not measured from 0 to 1 s"
BARE = "not swept: 1 link has a visual but no collision shape and is not measured: 'tip'"


def case_with(*, hole=False, notices=()):
    """An arm that turns by 1 rad in 2 s; its first half may not be measured."""
    case = turning(SLAB, [0.0, 0.5, 1.0])
    (placed,) = case.robots
    holes = (Hole(("j0",), 0.0, 1.0, 0.01, NOT_MEASURED),) if hole else ()
    asked = replace(placed.trajectory, holes=holes)
    placed = replace(placed, robot=replace(placed.robot, notices=notices), trajectory=asked)
    return replace(case, robots=(placed,), obstacles=(POST,))


def texts(swept) -> list[str]:
    """The outline in each format."""
    return [write(swept) for write in (yaml_text, svg_text, dxf_text, geojson_text)]


def test_a_stretch_that_is_not_measured_stands_in_every_file_of_the_outline():
    swept = cl.swept_profile(case_with(hole=True))
    assert swept.notes == (HOLE,)
    assert swept.content == "all that is swept but for what its notes leave out"
    assert all(HOLE in text for text in texts(swept))
    assert not any("contains all that is swept;" in text for text in texts(swept))
    whole = cl.swept_profile(case_with())
    assert whole.area > swept.area and whole.notes == ()
    assert whole.content == "all that is swept"


@pytest.mark.parametrize("accepted", [False, True])
def test_suspect_input_stands_in_every_file_of_the_outline_unless_it_is_accepted(accepted):
    notice = Notice(Severity.SUSPECT, "units", "CHECK UNITS: is this degrees?")
    case = replace(case_with(notices=(notice,)), accept=("units",) if accepted else ())
    swept = cl.swept_profile(case)
    assert swept.notes == (() if accepted else ("in doubt: CHECK UNITS: is this degrees? [CL120]",))
    assert ("if what its notes doubt is right" in swept.content) is not accepted
    assert all(("CHECK UNITS" in text) is not accepted for text in texts(swept))


def test_a_body_that_may_stand_elsewhere_is_swept_in_doubt():
    """It is in the outline, where its file has it."""
    notice = Notice(Severity.WARNING, "equality", "mocap bodies stand where the file has them: 'a'")
    swept = cl.swept_profile(case_with(notices=(notice,)))
    assert swept.notes == (f"in doubt: {notice.line}",) and swept.left_out == ()
    assert "if what its notes doubt is right" in swept.content


@pytest.mark.parametrize("accept", [(), ("columns", "rest")])
def test_motion_of_a_file_that_is_not_read_and_joints_that_nobody_gives_stand_in_the_outline(
    accept,
):
    joints = [joint(i, JointKind.REVOLUTE, Z) for i in range(2)]
    case = replace(moved(joints, {2: SLAB}, [[0.0, 0.0], [0.5, 0.0]]), accept=accept)
    (placed,) = case.robots
    asked = replace(placed.trajectory, joint_names=("j0",), positions=np.array([[0.0], [0.5]]))
    asked = replace(asked, unread=("trajectory[1]",), elsewhere=(("j1", 0.4),))
    swept = cl.swept_profile(replace(case, robots=(replace(placed, trajectory=asked),)))
    starts = ("not swept: columns or fields that look like motion", "in doubt: robot 'robot' rests")
    assert len(swept.notes) == (0 if accept else 2)
    assert all(any(note.startswith(one) for one in starts) for note in swept.notes)
    whole = "all that is swept"
    part = f"{whole} but for what its notes leave out, if what its notes doubt is right"
    assert swept.content == (whole if accept else part)


@pytest.mark.parametrize("option", [[], ["--quiet"]])
def test_a_link_that_is_only_shown_stands_in_the_file_and_quiet_or_not_in_the_output(
    option, tmp_path, capsys
):
    path, out = (
        write_case(tmp_path, urdf=ARM.replace('<link name="tip"/>', SHOWN)),
        tmp_path / "o.svg",
    )
    assert run(["profile", "sweep", str(path), "--out", str(out), *option]) == 0
    told = capsys.readouterr()
    assert BARE in (told.err if option else told.out)
    assert "contains all that is swept;" not in told.out
    assert BARE.replace("'", "&#39;") in out.read_text()


@pytest.mark.slow
def test_a_comparison_and_a_fit_tell_what_their_outline_leaves_out(tmp_path, capsys):
    path = write_case(tmp_path, urdf=ARM.replace('<link name="tip"/>', SHOWN))
    swept = str(tmp_path / "swept.yaml")
    free_circle(2.0).save(tmp_path / "zone.yaml")
    assert run(["profile", "sweep", str(path), "--out", swept]) == 0
    capsys.readouterr()
    assert run(["profile", "compare", swept, swept]) == 0
    assert f"note      A: {BARE}" in capsys.readouterr().out
    fitted = ["--nearest", "--out", str(tmp_path / "fitted.yaml")]
    assert run(["profile", "fit", str(tmp_path / "zone.yaml"), swept, *fitted]) == 0
    assert f"note: swept.yaml: {BARE}" in capsys.readouterr().out


def test_a_drawing_of_each_link_is_read_back_as_the_whole_with_its_notes(tmp_path):
    swept = cl.swept_profile(case_with(hole=True), per_link=True)
    for suffix in ("dxf", "yaml"):
        write_profile(swept, tmp_path / f"swept.{suffix}")
    drawn, whole = (read_outline(tmp_path / f"swept.{suffix}") for suffix in ("dxf", "yaml"))
    assert cl.hausdorff(drawn.curve, whole.curve).distance < 1e-9
    assert drawn.notes == (HOLE, "of the layers 'SWEPT', 'l1' only 'SWEPT' is taken")
    assert whole.notes == (HOLE,)


def test_a_link_without_a_shape_is_no_unknown_one(tmp_path):
    case = cl.load_case(write_case(tmp_path, CASE))
    with pytest.raises(UnknownLink, match="link 'tip' has no shape to sweep"):
        cl.swept_profile(case, links=["tip"])
    with pytest.raises(UnknownLink, match="unknown link 'top'"):
        cl.swept_profile(case, links=["top"])


@pytest.mark.parametrize("hole", [False, True])
def test_a_zone_is_kept_as_far_as_is_swept_wherever_the_answer_is(hole):
    space = ReservedSpace("zone", squares((-0.55, 0.55)), mode="outside")
    found = cl.check(replace(case_with(hole=hole), profiles=(space,)))
    (answer,) = found.record.profiles
    assert answer.passed
    assert ("kept, as far as swept" in profile_text(answer)) is hole
    assert profile_text(answer).endswith(f"; {HOLE}") is hole
    (row,) = summary_of(found)["profiles"]
    assert tuple(row["left_out"]) == ((HOLE,) if hole else ())
    page = page_of(found)
    told = ("yes, as far as swept" in page, "Not swept: motion not measured" in page)
    assert told == (hole, hole)
    assert any(HOLE in one.text for one in results_of(found.report) if one.name == "zone") is hole
