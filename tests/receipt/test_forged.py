"""Receipts that somebody has rewritten, checksum, hashes and all: what is not so is not proven."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadSyntax
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.items import BALLS, CUT_A, CUT_TIME
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import FILE_NAME, read_receipt
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.robot import Joint, JointKind, Mimic
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests.receipt.receipts import rewritten, saved, turning_arm


def loose(size: float = 1.0, far: float = 0.9) -> cl.Case:
    """The turning arm with tolerances of some millimetres."""
    frame = PlacementTolerance(0.0002 * size, 0.0001 * size)
    robot = RobotTolerance(
        {"turn": JointTolerance(0.001 * size, 0.0, frame)},
        PlacementTolerance(0.002 * size, 0.001 * size),
        {"bar": 0.0005 * size},
    )
    block = ObstacleTolerance(PlacementTolerance(0.001 * size, 0.002 * size))
    return replace(turning_arm(far=far), tolerance=Budget({"arm": robot}, {"block": block}))


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    saved(loose(), folder)
    return folder


def proven(folder, case=None) -> bool:
    return cl.verify(folder, case or loose()).proven


@pytest.mark.slow
def test_what_tolerances_leave_is_proven(folder):
    found = cl.verify(folder, loose())
    told = json.loads((folder / "summary.json").read_text())["tolerances"]["rules"][0]["proven"]
    least = found.bounds["default, with tolerances"]
    assert found.proven and not found.nominal
    assert found.bounds["default"] - told > 0.003 and told - 3 * UNIT < least < told
    assert "(default), at least" in found.headline and "NOMINAL" not in found.headline


@pytest.mark.slow
def test_intervals_in_which_tolerances_leave_nothing_are_told(tmp_path):
    case = loose(far=0.853)
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven and found.n_contact == 0 and 0 < found.n_not_ruled_out < found.n_intervals
    told = f"PROVEN EXCEPT with tolerances in {found.n_not_ruled_out} intervals, in which contact"
    assert found.headline.startswith(f"VIOLATED, as the report says. {told}")


@pytest.mark.slow
def test_no_raised_bound_with_tolerances_is_proven(folder):
    claims = read_receipt(folder / FILE_NAME).claims
    raised = np.minimum(claims[0], claims[1] + round(3e-4 / UNIT))
    for interval in np.flatnonzero(raised < claims[0]):
        rows = claims.copy()
        rows[1, interval] = raised[interval]
        rewritten(folder, claims=rows)
        found = cl.verify(folder, loose())
        assert not found.proven and f"interval {interval} " in found.failure


@pytest.mark.slow
def test_less_than_the_report_tells_of_is_not_proven(folder):
    claims = read_receipt(folder / FILE_NAME).claims.copy()
    claims[1] -= round(0.01 / UNIT)
    rewritten(folder, claims=claims)
    found = cl.verify(folder, loose())
    assert found.beyond["default, with tolerances"] == pytest.approx(0.01, abs=3e-6)
    assert (
        "with tolerances; NOT VERIFIED: the report certifies up to 10.00"
        in found.headline.partition("\n")[0]
    )
    claims[1] = NOT_CLAIMED
    rewritten(folder, claims=claims)
    assert (
        "nothing is claimed of rule default, with tolerances" in cl.verify(folder, loose()).failure
    )


@pytest.mark.slow
def test_a_limit_that_is_kept_with_tolerances_must_be_proven(folder):
    """The report has 44 mm left, of 10 mm that are needed; a receipt of 9.999 mm does not bear that out."""
    receipt = read_receipt(folder / FILE_NAME)
    for least, failure in (
        (0.010, ""),
        (0.009999, "a fresh run is clear with tolerances, but the receipt proves only 9.999000 mm"),
    ):
        claims = receipt.claims.copy()
        claims[1] = np.minimum(claims[1], round(least / UNIT))
        rewritten(folder, claims=claims)
        assert cl.verify(folder, loose()).failure.startswith(failure or "none") == bool(failure)


@pytest.mark.slow
def test_tolerances_cannot_be_made_smaller_or_left_out(folder):
    small = loose(0.5)
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(folder, small)
    receipt = read_receipt(folder / FILE_NAME)
    rewritten(folder, head=receipt.head | {"nominal": True})
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(folder, loose())
    nominal = case_data(replace(loose(), tolerance=None))
    head = receipt.head | {"nominal": True, "data": nominal.digest, "rules": list(nominal.rules)}
    rewritten(folder, head=head, claims=receipt.claims[:1])
    assert not proven(folder)  # evidence is left over
    larger = loose(1.5)
    data = case_data(larger)
    rewritten(folder, head=receipt.head | {"data": data.digest}, claims=receipt.claims)
    assert not proven(folder, larger)


def test_another_case_with_the_hashes_of_this_one_is_not_proven(folder):
    """Whoever puts in another robot, and its hashes, has evidence of other geometry."""
    receipt = read_receipt(folder / FILE_NAME)
    for other in (turning_arm(far=0.89), turning_arm(turn=1.3)):
        other = replace(other, tolerance=loose().tolerance)
        rewritten(folder, head=receipt.head | {"data": case_data(other).digest})
        assert not proven(folder, other)


def windowed(start: float, until: float = 2.0) -> cl.Case:
    """The turning arm, of which the block is judged by a rule of its own from one time to another."""
    rule = Rule(("bar", "block"), Window(start, until), name="late", fail=0.001)
    return replace(turning_arm(), limits=cl.Limits(0.01, 0.02, rules=(rule,)))


@pytest.mark.slow
def test_a_window_of_a_rule_cannot_be_made_another(tmp_path):
    data = saved(windowed(1.5), tmp_path)
    receipt = read_receipt(tmp_path / FILE_NAME)
    assert cl.verify(tmp_path, windowed(1.5)).proven
    for start, until in ((1.0, 2.0), (0.0, 2.0), (1.0, 1.5), (0.5, 1.0)):
        other = windowed(start, until)
        with pytest.raises(BadSyntax, match="its numbers are not those"):
            cl.verify(tmp_path, other)
        rewritten(tmp_path, head=receipt.head | {"data": case_data(other).digest})
        assert not proven(tmp_path, other)
        rewritten(tmp_path, head=receipt.head)
    late = data.rules.index("late")
    for own in (NOT_CLAIMED, receipt.claims[late].max() + round(1e-4 / UNIT)):
        for interval in np.flatnonzero(receipt.claims[late] != NOT_CLAIMED):
            claims = receipt.claims.copy()
            claims[late, interval] = own
            rewritten(tmp_path, claims=claims)
            assert not proven(tmp_path, windowed(1.5))
    rewritten(tmp_path, claims=receipt.claims[::-1].copy())
    assert not proven(tmp_path, windowed(1.5))


def following(multiplier: float, offset: float = 0.0) -> cl.Case:
    """The turning arm with a second bar beside it, which follows it."""
    case = turning_arm()
    placed = case.robots[0]
    at, axis = np.eye(4), np.array([0.0, 0.0, 1.0])
    at[2, 3] = 0.2
    mimic = Mimic("turn", multiplier, offset)
    joint = Joint("follow", JointKind.REVOLUTE, "base", "second", at, axis, mimic=mimic)
    bar = replace(placed.robot.bodies[0], name="second")
    robot = replace(
        placed.robot,
        link_names=(*placed.robot.link_names, "second"),
        joints=(*placed.robot.joints, joint),
        bodies=(*placed.robot.bodies, bar),
    )
    return replace(case, robots=(replace(placed, robot=robot),))


@pytest.mark.slow
def test_a_joint_cannot_be_made_to_follow_otherwise(tmp_path):
    saved(following(0.5), tmp_path)
    receipt = read_receipt(tmp_path / FILE_NAME)
    assert cl.verify(tmp_path, following(0.5)).proven
    for multiplier, offset in ((1.5, 0.0), (-0.5, 0.0), (0.5, 0.5)):
        other = following(multiplier, offset)
        with pytest.raises(BadSyntax, match="its numbers are not those"):
            cl.verify(tmp_path, other)
        rewritten(tmp_path, head=receipt.head | {"data": case_data(other).digest})
        found = cl.verify(tmp_path, other)
        assert not found.proven or least(other) >= min(found.bounds.values())
        rewritten(tmp_path, head=receipt.head)


def least(case: cl.Case) -> float:
    """[m] of the run."""
    return float(cl.check(case, certify=False).worst_sample["clearance"])


def test_pairs_that_are_left_out_change_what_it_is_of(folder):
    receipt = read_receipt(folder / FILE_NAME)
    fewer = replace(loose(), allow=(("bar", "plate"),))
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(folder, fewer)
    rewritten(folder, head=receipt.head | {"data": case_data(fewer).digest})
    assert not proven(folder, fewer)  # what is there is of more pairs
    more = replace(
        loose(),
        obstacles=(*loose().obstacles, cl.Obstacle(cl.Body("late", cl.box((0.1, 0.1, 0.1))))),
    )
    rewritten(folder, head=receipt.head | {"data": case_data(more).digest})
    assert not proven(folder, more)


@pytest.mark.slow
@pytest.mark.parametrize("deed", [CUT_A, CUT_TIME])
def test_a_cut_that_leaves_out_faces_or_time_is_none(folder, deed):
    """What an item is cut into covers it: halves that are called proven are looked at all the same."""
    receipt = read_receipt(folder / FILE_NAME)
    for first in (0, len(receipt.deeds) // 2):
        deeds = receipt.deeds.copy()
        deeds[first] = deed
        rewritten(folder, deeds=deeds)
        same = receipt.deeds[first] == deed
        assert proven(folder) == same
    rewritten(folder, deeds=np.array([deed] * 2 + [BALLS] * 6), codes=receipt.codes)
    assert not proven(folder)


def test_all_called_balls_proves_nothing_near(folder):
    receipt = read_receipt(folder / FILE_NAME)
    none = {most: np.empty((0, 2), dtype=np.int64) for most in receipt.codes}
    rewritten(folder, deeds=np.full(len(receipt.deeds), BALLS), codes=none)
    assert not proven(folder)


@pytest.mark.parametrize("deed", [7, 8, 255])
def test_deeds_that_are_none_are_refused(folder, deed):
    deeds = read_receipt(folder / FILE_NAME).deeds.copy()
    deeds[-1] = deed
    rewritten(folder, deeds=deeds)
    assert not proven(folder)


@pytest.mark.slow
def test_numbers_at_the_ends_of_their_range_prove_nothing(folder):
    receipt = read_receipt(folder / FILE_NAME)
    for huge in (2**62, 2**63 - 1, 2**40):
        claims = receipt.claims.copy()
        claims[:, 1] = huge
        rewritten(folder, claims=claims)
        assert not proven(folder)
    claims = receipt.claims.copy()
    claims[:, 1] = -(2**62) + 1  # as good as not claimed, and yet it is
    rewritten(folder, claims=claims)
    assert not proven(folder)
    for most, codes in receipt.codes.items():
        wild = receipt.codes | {most: np.full_like(codes, -most - 1)}
        rewritten(folder, claims=receipt.claims, codes=wild)
        assert len(codes) == 0 or not proven(folder)


def test_directions_of_nothing_prove_nothing(folder):
    """An octahedron has no such point; a direction that is 0 has no length to divide by."""
    receipt = read_receipt(folder / FILE_NAME)
    for codes in ({m: np.zeros_like(c) for m, c in receipt.codes.items()},):
        rewritten(folder, codes=codes)
        assert not proven(folder)


@pytest.mark.slow
@pytest.mark.parametrize("bound", ["certified", "tolerances"])
@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", '"1"', "null", "[]", "1e999"])
def test_a_report_whose_bound_is_no_number_proves_nothing(folder, bound, value):
    """A summary with another value of a bound, of which the receipt has the digest."""
    path = folder / "summary.json"
    summary = json.loads(path.read_text())
    if bound == "certified":
        summary["certified"]["lower_bound"] = "HERE"
    else:
        summary["tolerances"]["rules"][0]["proven"] = "HERE"
    path.write_text(json.dumps(summary).replace('"HERE"', value))
    receipt = read_receipt(folder / FILE_NAME)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    rewritten(folder, head=receipt.head | {"report": receipt.head["report"] | {path.name: digest}})
    try:
        assert not proven(folder)
    except BadInput as error:
        assert "summary.json" in str(error)


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "whole"},
        {"nominal": 1},
        {"tolerance": None},
        {"rules": ["default"]},
        {"rules": ["default", "default"]},
        {"report": {}},
        {"inputs": [{"path": "x"}]},
        {"data": 5},
    ],
)
def test_heads_that_are_none_are_refused(folder, change):
    rewritten(folder, head=read_receipt(folder / FILE_NAME).head | change)
    with pytest.raises(BadSyntax):
        cl.verify(folder, loose())
