"""A bracket of a root, narrowed by regula falsi.

Regula falsi alone keeps one end for ever where the function bends; each time the same end moves, the other
one's value counts half. Source: Dowell, Jarratt (1971), the Illinois algorithm.
Not for: the functions whose roots are sought.
"""

from typing import NamedTuple

from clearance.compile.decorators import inline

MOST_STEPS = 60
NARROWEST = 2e-16  # a bracket of local parameters that floats hardly divide


class Bracket(NamedTuple):
    """Two parameters with the values there, and which end moved last: 1 the high one, -1 the low one, 0 none."""

    low: float
    high: float
    f_low: float
    f_high: float
    moved: int


@inline
def secant(bracket):
    """Where the line through both values vanishes."""
    rise = bracket.f_high - bracket.f_low
    return (bracket.low * bracket.f_high - bracket.high * bracket.f_low) / rise


@inline
def narrowed(bracket, t, f, is_high):
    """The bracket with `t`, where the value is `f`, for its high end or for its low one."""
    if is_high:
        f_low = bracket.f_low * (0.5 if bracket.moved == 1 else 1.0)
        return Bracket(bracket.low, t, f_low, f, 1)
    f_high = bracket.f_high * (0.5 if bracket.moved == -1 else 1.0)
    return Bracket(t, bracket.high, f, f_high, -1)
