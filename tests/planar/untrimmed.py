"""The Hausdorff distance without trimming: slow, and another way to the same answer."""

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, greater_of
from clearance.planar.steady import steady
from clearance.planar.systems import directed, directions, empty_state, solved, whole


def untrimmed(a: Curve, b: Curve) -> Hausdorff:
    """The Hausdorff distance from the systems solved on whole curves: it shares no bound with trimming."""
    both = [
        directed(way, solved(way, whole(way.one), whole(way.two), empty_state()))
        for way in directions(steady(a), steady(b))
    ]
    return greater_of(*both)
