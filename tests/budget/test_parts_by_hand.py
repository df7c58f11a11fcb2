"""A part that was gripped by what is off has the errors of that moment and of now; each worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.world.body import Mount
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from tests.budget.budget_cases import proven_sections
from tests.budget.part_cases import (
    END,
    OUT,
    QUARTER,
    arm,
    carried,
    cube,
    gantry,
    off_by,
    passing,
    quarter_turn,
    slid,
    turned_face,
    turned_past,
    wall,
)
from tests.made_cases import at

EXACT = 1e-9

MORE = 1.06
"""So many times the worst of turns may be taken: a bound of the second order, of faces that are not cut."""

GAP = 1e-4


def left_at_end(case: Case, *names: str) -> float:
    """[m] proven of the last step, of the pair of these names."""
    *_, (section, _, _, steps, _) = proven_sections(case)
    nearest = section.pairs[int(steps.pair[-1])]
    assert {body.name_in(case) for body in nearest} == set(names or ("part", "wall"))
    return float(steps.proven[-1])


def test_a_part_has_the_carriers_error_of_the_grasp_and_that_of_now():
    """Gripped at -0.03 rad, and led 0.03 rad beyond its course, the part is turned by 0.06 rad."""
    taken = 0.1 - left_at_end(quarter_turn(0.1, 0.03))
    assert turned_face(0.06) <= taken <= MORE * turned_face(0.06)


def test_the_motion_between_the_steps_has_both_errors():
    ((_, _, _, steps, between),) = proven_sections(quarter_turn(0.1, 0.03), GAP)
    assert steps.proven[-1] - GAP <= between.proven.min() <= steps.proven[-1]


def test_what_both_errors_bring_into_contact_is_not_proven():
    case = replace(quarter_turn(0.04838, 0.03), limits=cl.Limits(0.001, 0.001))
    run = cl.check(case)
    assert run.worst["clearance"] == pytest.approx(0.04838, abs=EXACT)
    assert not run.record.budget[0].keeps
    driven_so = replace(case, robots=(arm("arm", -0.03, QUARTER + 0.03),), tolerance=None)
    assert cl.check(driven_so).worst["clearance"] == 0.0


def test_an_exact_grasp_leaves_the_errors_of_now():
    taken = 0.1 - left_at_end(quarter_turn(0.1, 0.03, exact_grasp=True))
    assert turned_face(0.03) <= taken <= MORE * turned_face(0.03)


def test_what_was_laid_down_keeps_the_errors_of_grasp_and_release():
    worst = 0.1 - turned_past(0.1, 0.06)
    taken = 0.1 - left_at_end(passing(0.1), "part", "right/bar")
    assert worst <= taken <= MORE * worst


def test_a_slide_takes_its_size_at_both_moments():
    assert left_at_end(slid(off_by(0.004))) == pytest.approx(0.092, abs=EXACT)


def test_frames_and_the_base_count_at_the_grasp_too():
    frame = {"j": JointTolerance(frame=PlacementTolerance(0.001))}
    budget = Budget({"arm": RobotTolerance(frame, PlacementTolerance(0.002))})
    assert left_at_end(slid(budget)) == pytest.approx(0.094, abs=EXACT)


def test_from_hand_to_hand_the_errors_of_all_moments_add_up():
    """Left grips and lets go with 4 mm, right takes it over and leads it on with 3 mm."""
    robots = (gantry("left", 0.0, -0.3, -0.3), gantry("right", 0.0, 0.0, -0.2, lift=5.0))
    carries = (carried("left/bar", 0.0, 1.0), carried("right/bar", 1.0))
    budget = Budget(off_by(0.004, "left").robots | off_by(0.003, "right").robots)
    left = left_at_end(slid(budget, *carries, robots=robots))
    assert left == pytest.approx(0.1 - 0.014, abs=EXACT)


def test_what_it_lay_on_counts_as_that_was_at_the_grasp():
    """The table is off by 2 mm, the part on it by 1 mm, the gantry by 4 mm at each moment."""
    table = cube("table", at(OUT, 0.0, -1.0))
    on_it = cube(mount=Mount("table", at(0.0, 0.0, 1.0)))
    places = {
        name: ObstacleTolerance(PlacementTolerance(size))
        for name, size in (("table", 0.002), ("part", 0.001))
    }
    budget = Budget(off_by(0.004).robots, places)
    left = left_at_end(slid(budget, obstacles=(table, on_it)))
    assert left == pytest.approx(0.1 - 0.011, abs=EXACT)


def test_what_rides_on_a_part_has_its_errors():
    """A label on the side of the wall, which is off by 1 mm on the part."""
    label = cube("label", mount=Mount("part", at(-0.1)))
    budget = Budget(off_by(0.004).robots, {"part": ObstacleTolerance(PlacementTolerance(0.001))})
    case = replace(slid(budget), obstacles=(cube(), label, wall(END - 0.2)))
    assert left_at_end(case, "label", "wall") == pytest.approx(0.1 - 0.009, abs=EXACT)


def test_a_robot_is_not_off_against_itself_when_it_grips_what_rides_on_it():
    """Its base is off by 5 mm, at the grasp and now; the part that rides on it was off with it."""
    on_it = cube(mount=Mount("base", at(OUT)))
    budget = Budget({"arm": RobotTolerance(base=PlacementTolerance(0.005))})
    assert left_at_end(slid(budget, obstacles=(on_it,))) == pytest.approx(0.095, abs=EXACT)


def test_what_is_held_from_the_start_was_not_gripped():
    """It rides on the bar as the case says; that the bar carries it is no moment at which it is gripped."""
    on_it = cube(mount=Mount("bar", at(OUT)))
    left = left_at_end(slid(off_by(0.004), obstacles=(on_it,)))
    assert left == pytest.approx(0.096, abs=EXACT)


def test_the_clock_of_a_carrier_is_refused_where_it_grips_at_the_start():
    late = Budget({"arm": RobotTolerance(timing=0.01)})
    with pytest.raises(BadInput, match="clock of 'arm' may be off"):
        cl.check(slid(late))


def test_sources_are_told_for_each_moment():
    run = cl.check(replace(slid(off_by(0.004)), limits=cl.Limits(0.08, 0.08)))
    sources = run.session.error_sources(run.record.budget[0]).sources
    assert sorted(one.moment for one in sources) == ["", "grasp (0 s)"]
    for one in sources:
        assert (one.owner, one.kind, one.part) == ("arm", "tracking", "j")
        assert one.proven == pytest.approx(0.004, abs=EXACT)
        assert one.expected == pytest.approx(0.004 / np.sqrt(3.0), abs=EXACT)
        assert one.largest == pytest.approx((0.01,), rel=0.003)  # twice as much is left as is asked


def test_an_error_takes_its_own_loss_though_another_pair_is_next():
    """Two walls, 0.1 mm apart, may each stand 10 mm nearer: without the error of one, the other is the nearest."""
    near, far = wall(END - 0.1), wall(END - 0.1001)
    far = replace(far, body=replace(far.body, name="far"))
    placed = ObstacleTolerance(PlacementTolerance(0.01))
    case = replace(slid(Budget({}, {"wall": placed, "far": placed})), obstacles=(cube(), near, far))
    run = cl.check(case)
    (source,) = run.session.error_sources(run.record.budget[0]).sources
    assert (source.owner, source.proven) == ("wall", pytest.approx(0.01, abs=EXACT))
