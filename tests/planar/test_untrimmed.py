"""The Hausdorff distance without trimming: slow, another way to the same answer, and it comes to an end."""

import pytest

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, greater_of, hausdorff
from clearance.planar.steady import steady
from clearance.planar.systems import directed, directions, empty_state, solved, whole
from tests.examples import some_slow

HARD = {
    "the same curve": (Curve.bspline([[0, 0], [1, 2], [3, 1], [4, 4]]),) * 2,
    "one straight and doubled back": (
        Curve.bezier([[0, 0], [2, 0], [-1, 0], [1, 0]]),
        Curve.bezier([[0, 1], [0.3, 0.2], [0.6, 0.3], [1, 1]]),
    ),
    "concentric circles": (Curve.circle([0, 0], 1), Curve.circle([0, 0], 1.25)),
}


def untrimmed(a: Curve, b: Curve) -> Hausdorff:
    """The Hausdorff distance from the systems solved on whole curves: it shares no bound with trimming."""
    both = [
        directed(way, solved(way, whole(way.one), whole(way.two), empty_state()))
        for way in directions(steady(a), steady(b))
    ]
    return greater_of(*both)


@pytest.mark.parametrize("name", some_slow(HARD, {"the same curve", "concentric circles"}))
def test_systems_without_end_stop_with_a_true_bound(name):
    """Infinitely many roots, or too many to tell apart: the budget ends it, and the bound says what is left."""
    a, b = HARD[name]
    one, two = hausdorff(a, b), untrimmed(a, b)
    assert two.lower <= one.upper and one.lower <= two.upper
    assert two.error_bound <= 0.05 * a.size and two.tally.given_up > 0
    assert two.tally.systems <= 40_000 and two.tally.intervals <= 900_000
