"""Reserved outlines: of which it is open what they enclose, and in another unit, which anything would keep to."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.case.reserved import reserved_spaces
from clearance.errors import BadShape
from clearance.findings.limit_lines import profile_text
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.case import Profile
from clearance.geometry.polyhedron import Polyhedron
from clearance.planar.curve import Curve
from clearance.profiles.profile_file import svg_text
from clearance.sketch import Sketch
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.budget import Budget, PlacementTolerance, RobotTolerance
from clearance.world.case import ReservedSpace
from clearance.world.notice import Severity
from clearance.world.pose_table import PoseTable
from tests.profiles.moving import drawn, free_circle, slab, turning
from tests.report.made import page_of, summary_of

POST = Obstacle(Body("post", slab([0.3, -0.5, 0.0], [0.4, -0.4, 0.1])))


def squares(*spans: tuple[float, float]) -> Sketch:
    """Squares from (low, low) to (high, high)."""
    return drawn(*([(low, low), (high, low), (high, high), (low, high)] for low, high in spans))


ARM = slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1])


def checked(
    mode: str,
    *spans: tuple[float, float],
    arm=ARM,
    padding=0.0,
    tolerance=None,
    obstacles=(POST,),
    accept=(),
    **given,
):
    """An arm of 0.5 m that turns by 1 rad, and squares that it keeps to, or out of."""
    case = turning(arm, [0.0, 0.5, 1.0])
    space = ReservedSpace("zone", squares(*spans), mode=mode, **given)
    robots = tuple(replace(one, padding={"l1": padding}) for one in case.robots)
    changes = {"robots": robots, "obstacles": obstacles, "tolerance": tolerance, "accept": accept}
    return cl.check(replace(case, profiles=(space,), **changes))


def warnings(found) -> list[str]:
    return [one.text for one in found.record.notices if one.kind == "profiles"]


MOVED = Budget(robots={"robot": RobotTolerance(base=PlacementTolerance(xyz=0.05))})
OVERLAPPING = (-0.7, 0.8), (-0.8, 0.7)


def test_a_robot_in_the_overlap_of_two_zones_that_it_keeps_out_of_is_not_clear():
    with pytest.raises(BadShape, match=r"profiles\[0\] zone: sketch: contours 1 and 2 overlap"):
        checked("inside", *OVERLAPPING)


def test_a_zone_with_a_hole_is_what_the_guide_says():
    assert checked("inside", (-2.0, 2.0), (-0.8, 0.8)).passed
    assert not checked("inside", (-2.0, 2.0)).passed


@pytest.mark.slow
def test_a_zone_that_is_not_kept_violates_the_case_and_the_page_shows_it(tmp_path):
    found = checked("inside", (-2.0, 2.0))
    assert found.status == "violated" and found.record.profiles[0].gap < -0.03
    found.save(tmp_path)
    told = json.loads((tmp_path / "summary.json").read_text())
    assert told["verdict"] == "violated" and told["profiles"][0]["passed"] is False
    assert "picture" not in told["profiles"][0]
    page = (tmp_path / "report.html").read_text()
    assert "<h2>Profiles</h2>" in page and "data:image/svg+xml" in page


def test_outlines_that_only_have_to_be_near_may_cross():
    assert checked("nearest", *OVERLAPPING, limit=0.5).record.profiles[0].gap > 0.0


def test_a_fit_beside_outlines_that_overlap_is_refused():
    two = Curve.contours(
        [Curve.polyline([[a, a], [b, a], [b, b], [a, b]], closed=True) for a, b in OVERLAPPING]
    )
    for mode in ("inside", "outside"):
        with pytest.raises(BadShape, match="outline: contours 1 and 2 overlap"):
            cl.fit(free_circle(0.1), two, mode)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("padding", "tolerance", "without"),
    [
        (0.0, MOVED, "tolerances"),
        (0.01, None, "paddings"),
        (0.01, MOVED, "tolerances and paddings"),
    ],
)
def test_what_profiles_do_not_count_stands_in_the_headline(padding, tolerance, without):
    """The base may be 50 mm off, and the arm stays 10 mm within the zone."""
    found = checked("outside", (-0.55, 0.55), padding=padding, tolerance=tolerance)
    assert found.record.profiles[0].passed
    said = f"profiles are judged without the {without} of the case: 'zone'; give them a limit"
    assert len(warnings(found)) == 1 and warnings(found)[0].startswith(said)
    assert said in found.verdict.text()


@pytest.mark.parametrize(
    ("mode", "spans"), [("inside", [(0.02, 0.03)]), ("outside", [(-0.6, 0.6), (0.02, 0.03)])]
)
def test_a_sketch_that_lies_within_the_sweep_is_told_with_how_far(mode, spans):
    """A pillar that the arm passes over, and a hole of a zone; the arm's axis is nearest to their far corner."""
    (answer,) = checked(mode, *spans).record.profiles
    assert not answer.passed and not answer.contained
    assert answer.gap == pytest.approx(-np.hypot(0.03, 0.03), abs=5e-4)


def test_nothing_is_said_where_nothing_is_left_out():
    assert warnings(checked("outside", (-0.55, 0.55))) == []


@pytest.mark.slow
def test_the_cut_of_an_open_arm_stands_in_the_headline():
    """A pin in the middle of the arm is clear of the arm's surface, and would not be of the arm."""
    faces = [face for face in ARM.triangles() if ARM.vertices[face, 0].min() < 0.5]
    hollow = Polyhedron(ARM.vertices, faces)
    found = checked("inside", (0.005, 0.012), arm=hollow, section=0.05)
    assert found.record.profiles[0].passed
    said = (
        "profile 'zone': l1 is not closed: its cut is that of its surface, without what it encloses"
    )
    assert warnings(found) == [said] and said in found.verdict.text()
    swept = cl.swept_profile(turning(hollow, [0.0, 0.1]), section=0.05)
    assert "<desc>contains the surfaces that are swept; exceeds" in svg_text(swept)


def test_what_moves_by_itself_through_a_zone_stands_in_the_headline():
    """A truck drives through the zone with a crate on it; the zone is held against the arm alone."""
    ways = np.array([[-2.0, 0.4, 0.5], [2.0, 0.4, 0.5]]), np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    table = PoseTable(np.array([0.0, 2.0]), *ways)
    truck = Obstacle(Body("truck", slab([-0.1] * 3, [0.1] * 3)), moves=table)
    crate = Obstacle(Body("crate", slab([-0.1, -0.1, 0.1], [0.1, 0.1, 0.2])), mount=Mount("truck"))
    found = checked("outside", (-0.55, 0.55), obstacles=(POST, truck, crate))
    assert found.record.profiles[0].passed
    said = "profile 'zone': not swept, though moving by themselves: truck, crate"
    assert warnings(found) == [said] and said in found.verdict.text()


@pytest.mark.parametrize(
    ("links", "said"),
    [((), "zone (outside, xy): kept"), (("l*",), "zone (outside, xy, only l*): kept")],
)
def test_the_links_that_alone_are_judged_are_said_wherever_the_answer_is(links, said):
    found = checked("outside", (-0.55, 0.55), links=links)
    (answer,) = found.record.profiles
    assert profile_text(answer).startswith(said)
    assert tuple(summary_of(found)["profiles"][0]["links"]) == links
    (finding,) = [one for one in found.findings if one.kind == "profile"]
    told = ("only l*" in finding.text, "xy, only l*" in page_of(found))
    assert told == (bool(links), bool(links))


ZONE = """\
points: {a: [-0.6, -0.6], b: [0.6, -0.6], c: [0.6, 0.6], d: [-0.6, 0.6]}
segments: {s: [a, b], e: [b, c], n: [c, d], w: [d, a]}
constraints:
- {kind: horizontal, of: [s]}
- {kind: horizontal, of: [n]}
- {kind: vertical, of: [e]}
- {kind: vertical, of: [w]}
- {kind: distance, of: [a, b], value: WIDTH, name: width}
"""
FIXED = "- {kind: fix, of: [a]}\n"
SLID = "the sketch of profile 'zone' is up to 20 mm from where it is drawn, and nothing fixes it"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "fixed", "said"),
    [("1.16", "", [SLID]), ("1.16", FIXED, []), ("1.2", "", []), ("1.2001", "", [])],
)
def test_a_zone_that_slides_when_its_width_is_edited_stands_in_the_headline(
    width, fixed, said, tmp_path
):
    """Both ends give way by half of the change, where one may be a wall."""
    (tmp_path / "zone.yaml").write_text(ZONE.replace("WIDTH", width) + fixed)
    entry = Profile(name="zone", sketch="zone.yaml")
    profiles = reserved_spaces([entry], InputFiles(tmp_path), ["l1"])
    case = replace(turning(ARM, [0.0, 0.5, 1.0]), obstacles=(POST,), profiles=profiles)
    found = cl.check(case)
    told = [one.text for one in found.record.notices if one.kind == "sketch"]
    assert [one.split(";")[0] for one in told] == said
    assert all(one in found.verdict.text() for one in said)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mode", "low", "high", "said"),
    [
        ("outside", -60, 60, "the sketch of profile 'zone' is 120 m long where the robot reaches"),
        ("inside", 30, 80, "the sketch of profile 'zone' stays 41.9 m away from a robot that reaches"),
    ],
)  # fmt: skip
def test_a_sketch_in_another_unit_is_suspect(mode, low, high, said):
    found = checked(mode, (low, high))
    assert found.record.profiles[0].passed, "this is why it has to be suspect"
    assert not found.passed and found.verdict.exit_code == 2
    (odd,) = found.verdict.suspects
    assert odd.kind == "units" and odd.text.startswith(f"CHECK UNITS: {said} 0.5")
    assert odd.text.endswith(" m; lengths are in metres, is this millimetres?")
    accepted = checked(mode, (low, high), accept=("units",))
    assert accepted.passed and said in accepted.verdict.text()


def test_a_zone_many_times_the_reach_away_has_a_warning():
    found = checked("inside", (3.0, 5.0))
    assert found.passed and not found.verdict.suspects
    (odd,) = [one for one in found.record.notices if one.severity is Severity.WARNING]
    assert (
        odd.kind == "units"
        and "zone' stays 3.74 m" in odd.text
        and "not in millimetres" in odd.text
    )


@pytest.mark.parametrize(("mode", "low", "high"), [("outside", -5, 5), ("inside", 0.6, 0.9)])
def test_a_zone_of_the_cell_is_not_odd(mode, low, high):
    found = checked(mode, (low, high))
    assert found.passed and not found.record.notices


@pytest.mark.parametrize("mode", ["outside", "inside", "nearest"])
def test_the_limit_of_a_profile_in_millimetres_is_suspect(mode):
    found = checked(mode, (-1.0, 1.0), limit=20.0)
    (odd,) = found.verdict.suspects
    assert odd.text.startswith("CHECK UNITS: profiles[0].limit is 20 m; limits are in metres")
