"""A change is sought by clearances alone: what else fails the changed case is named."""

from __future__ import annotations

from functools import cache

import pytest

import clearance as cl
from clearance.gains.every_kind import Trial, table_lines
from clearance.gains.figures import figures_of
from clearance.gains.page import page_of
from clearance.gains.result import Gain
from clearance.gains.sentences import Line, lines_of
from tests.gains.making_gain import SLOT, write_cell

ZONE = """
points: {{a: [-2, {low}], b: [2, {low}], c: [2, {high}], d: [-2, {high}]}}
segments: {{ab: [a, b], bc: [b, c], cd: [c, d], da: [d, a]}}
"""
PROFILES = "profiles: [{name: lane, plane: xy, sketch: lane.yaml, mode: outside}]\n"


STILL_CLEAR = SLOT.replace("0.04, warn: 0.04", "0.01, warn: 0.01")


@pytest.fixture(scope="module")
def found_for(tmp_path_factory):
    """The gain of the bar in the slot, which has to move by 20 mm towards y = 0; each is worked out once."""

    @cache
    def found(low: float, high: float, text: str = SLOT) -> Gain:
        folder = tmp_path_factory.mktemp("cell")
        (folder / "lane.yaml").write_text(ZONE.format(low=low, high=high))
        return cl.gain(write_cell(folder, text + PROFILES), "base")

    return found


def told(gain: Gain, *labels: str) -> list[Line]:
    return [(label, line) for label, line in lines_of(gain) if label in labels]


@pytest.mark.slow
def test_a_profile_that_the_change_breaks_is_named(found_for):
    """The bar sweeps y from -20 to 80 mm before, and from -40 to 60 mm after."""
    found = found_for(-0.03, 0.09)
    not_kept, because, proven = told(found, "kept", "not kept", "because", "proven")
    assert not_kept == ("not kept", "the changed case is not passed: violated")
    assert because[0] == "because"
    assert because[1].startswith("lane (outside, xy): NOT KEPT, gap -1") and "tool" in because[1]
    assert proven == ("proven", "every clearance holds at every moment")
    ((_, line),) = told(found, "after")
    assert line.endswith(" mm: clear, but the case is violated")
    assert found.clearances_kept and not found.kept and "not kept" in repr(found)
    figures = figures_of(found)
    assert figures["kept"] is False and figures["clearances_kept"] is True
    assert [one for one in figures["after"]["reasons"] if one.startswith("lane (outside, xy)")]
    page = page_of(found, with_reports=False)
    assert "not kept" in page and "every rule holds" not in page
    assert "case.yaml is the changed case, which is not passed" in page
    row = table_lines([Trial("base", found)])[1]
    assert row.split()[:4] == ["base", "no", "20.001", "mm"]
    assert row.endswith("; the changed case is not passed: violated")


@pytest.mark.slow
def test_nothing_is_said_of_a_profile_that_is_kept(found_for):
    found = found_for(-0.09, 0.09)
    assert found.kept and figures_of(found)["kept"] is True
    assert told(found, "not kept", "because", "proven") == [
        ("proven", "every rule holds at every moment")
    ]
    ((_, line),) = told(found, "before")
    assert line.endswith("fail below 40 mm: violated")


def test_a_profile_that_is_not_kept_is_named_where_nothing_had_to_be_changed(found_for):
    found = found_for(-0.01, 0.09, STILL_CLEAR)
    assert found.size == 0.0 and not found.kept
    not_kept, because, proven = told(found, "kept", "not kept", "because", "proven")
    assert not_kept == ("not kept", "the case is not passed: violated")
    assert because[1].startswith("lane (outside, xy): NOT KEPT, gap -1")
    assert proven == ("proven", "every clearance holds without a change")
    ((_, line),) = told(found, "before")
    assert line.endswith(" mm: clear, but the case is violated")
    assert "every rule holds" not in page_of(found, with_reports=False)
    row = table_lines([Trial("base", found)])[1]
    assert row.split()[:3] == ["base", "no", "none"]
    assert row.endswith("; the case is not passed: violated")


def test_suspect_input_that_fails_the_changed_case_is_named(tmp_path):
    far = "  - {name: far, box: {size: [1, 1, 1]}, pose: {xyz: [900, 0, 0]}}\n"
    found = cl.gain(write_cell(tmp_path, SLOT.replace("trajectory:", f"{far}trajectory:")), "base")
    assert found.clearances_kept and not found.kept
    (_, not_kept), (_, because) = told(found, "not kept", "because")
    assert not_kept == "the changed case is not passed: suspect (would be clear)"
    assert because.startswith("suspect units: CHECK UNITS: obstacle 'far'")


def test_a_waiver_that_the_change_makes_useless_is_named(tmp_path):
    waiver = "{between: [tool, left], at_least: 0.015, reason: r, by: b, until: 9999-12-31}"
    (tmp_path / "waivers.yaml").write_text(f"- {waiver}\n")
    found = cl.gain(write_cell(tmp_path, SLOT + "waivers: [waivers.yaml]\n"), "base")
    assert found.clearances_kept and not found.kept
    ((_, because),) = told(found, "because")
    assert because.startswith("waiver tool - left") and "is not needed" in because
    ((_, before),) = told(found, "before")
    assert before.endswith(" mm: violated, but the case is clear with 1 waiver")
