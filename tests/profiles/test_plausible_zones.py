"""Reserved outlines in another unit: they would be kept by anything, so they are suspect input."""

from __future__ import annotations

from dataclasses import replace

import pytest

import clearance as cl
from clearance.sketch import Sketch
from clearance.world.body import Body, Obstacle
from clearance.world.case import ReservedSpace
from clearance.world.notice import Severity
from tests.profiles.moving import slab, turning


def square(low: float, high: float) -> Sketch:
    sketch = Sketch()
    corners = [
        sketch.point(*place) for place in [(low, low), (high, low), (high, high), (low, high)]
    ]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        sketch.segment(a, b)
    return sketch


def checked(mode: str, low: float, high: float, limit: float = 0.0, **changes):
    """An arm of 0.5 m that turns by 1 rad, and a square that it keeps to, or out of."""
    case = turning(slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1]), [0.0, 0.5, 1.0])
    post = Obstacle(Body("post", slab([0.3, -0.5, 0.0], [0.4, -0.4, 0.1])))
    space = ReservedSpace("zone", square(low, high), mode=mode, limit=limit)
    return cl.check(replace(case, obstacles=(post,), profiles=(space,), **changes))


@pytest.mark.parametrize(
    ("mode", "low", "high", "said"),
    [
        ("outside", -600, 600, "the sketch of profile 'zone' is 1200 m long where the robot reaches"),
        ("outside", -60, 60, "the sketch of profile 'zone' is 120 m long where the robot reaches"),
        ("inside", 300, 800, "the sketch of profile 'zone' stays 424 m away from a robot that reaches"),
        ("inside", 30, 80, "the sketch of profile 'zone' stays 41.9 m away from a robot that reaches"),
    ],
)  # fmt: skip
def test_a_sketch_in_another_unit_is_suspect(mode, low, high, said):
    found = checked(mode, low, high)
    assert found.record.profiles[0].passed, "this is why it has to be suspect"
    assert not found.passed and found.verdict.exit_code == 2
    (odd,) = found.verdict.suspects
    assert odd.kind == "units" and odd.text.startswith(f"CHECK UNITS: {said} 0.5")
    assert odd.text.endswith(" m; lengths are in metres, is this millimetres?")
    accepted = checked(mode, low, high, accept=("units",))
    assert accepted.passed and said in accepted.verdict.text()


def test_a_zone_many_times_the_reach_away_has_a_warning():
    found = checked("inside", 3.0, 5.0)
    assert found.passed and not found.verdict.suspects
    (odd,) = [one for one in found.record.notices if one.severity is Severity.WARNING]
    assert (
        odd.kind == "units"
        and "zone' stays 3.74 m" in odd.text
        and "not in millimetres" in odd.text
    )


@pytest.mark.parametrize(("mode", "low", "high"), [("outside", -5, 5), ("inside", 0.6, 0.9)])
def test_a_zone_of_the_cell_is_not_odd(mode, low, high):
    found = checked(mode, low, high)
    assert found.passed and not found.record.notices


@pytest.mark.parametrize("mode", ["outside", "inside", "nearest"])
def test_the_limit_of_a_profile_in_millimetres_is_suspect(mode):
    found = checked(mode, -1.0, 1.0, limit=20.0)
    (odd,) = found.verdict.suspects
    assert odd.text.startswith("CHECK UNITS: profiles[0].limit is 20 m; limits are in metres")
