"""A change is sought by clearances alone: what else fails the changed case is named."""

from __future__ import annotations

import clearance as cl
from clearance.gains.sentences import lines_of
from tests.gains.making_gain import SLOT, write_cell

ZONE = """
points: {{a: [-2, {low}], b: [2, {low}], c: [2, {high}], d: [-2, {high}]}}
segments: {{ab: [a, b], bc: [b, c], cd: [c, d], da: [d, a]}}
"""
PROFILES = "profiles: [{name: lane, plane: xy, sketch: lane.yaml, mode: outside}]\n"


def told(tmp_path, low: float, high: float, text: str = SLOT) -> list[str]:
    """What a gain says of the bar in the slot, which has to move by 20 mm towards y = 0."""
    (tmp_path / "lane.yaml").write_text(ZONE.format(low=low, high=high))
    found = cl.gain(write_cell(tmp_path, text + PROFILES), "base")
    assert found.kept
    return [line for label, line in lines_of(found) if label == "but"]


def test_a_profile_that_the_change_breaks_is_named(tmp_path):
    """The bar sweeps y from -20 to 80 mm before, and from -40 to 60 mm after."""
    verdict, lane = told(tmp_path, -0.03, 0.09)
    assert verdict == "the changed case is not passed: violated"
    assert lane.startswith("lane (outside, xy): NOT KEPT, gap -1") and "tool" in lane


def test_nothing_is_said_of_a_profile_that_is_kept(tmp_path):
    assert told(tmp_path, -0.09, 0.09) == []


def test_a_profile_that_is_not_kept_is_named_where_nothing_had_to_be_changed(tmp_path):
    verdict, lane = told(
        tmp_path, -0.01, 0.09, SLOT.replace("0.04, warn: 0.04", "0.01, warn: 0.01")
    )
    assert verdict == "the case is not passed: violated"
    assert lane.startswith("lane (outside, xy): NOT KEPT, gap -1")
