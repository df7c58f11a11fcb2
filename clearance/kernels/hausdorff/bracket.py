"""A root in a bracket, narrowed by regula falsi.

Regula falsi alone keeps one end for ever where the function bends; each time the same end moves, the other
one's value counts half. Source: Dowell, Jarratt (1971), the Illinois algorithm.
Not for: the functions whose roots are sought.
"""

from typing import NamedTuple

from clearance.compile.decorators import by_type, inline

MOST_STEPS = 60
NARROWEST = 2e-16  # a bracket of local parameters that floats hardly divide


class Bracket(NamedTuple):
    """Two parameters with the values there, and which end moved last: 1 the high one, -1 the low one, 0 none."""

    low: float
    high: float
    f_low: float
    f_high: float
    moved: int


@by_type
def value_at(function, arrays, t):
    """The function after it was asked at `t`, its value there, and how near to 0 is a root.

    Args:
        arrays: what the function is made of and does not change.
    """
    raise TypeError


@inline
def root_in(bracket, function, arrays):
    """The root of a function in a bracket, and the function as last asked, there."""
    t = 0.5 * (bracket.low + bracket.high)
    for _ in range(MOST_STEPS):
        rises = bracket.f_high > bracket.f_low
        if rises:
            t = _secant(bracket)
        function, f, fine = value_at(function, arrays, t)
        if abs(f) <= fine or abs(bracket.high - bracket.low) <= NARROWEST or not rises:
            break
        bracket = _narrowed(bracket, t, f)
    return t, function


@inline
def _secant(bracket):
    """Where the line through both values vanishes."""
    rise = bracket.f_high - bracket.f_low
    return (bracket.low * bracket.f_high - bracket.high * bracket.f_low) / rise


@inline
def _narrowed(bracket, t, f):
    """The bracket with `t`, where the value is `f`, for its high end if that is above 0, else for its low one."""
    if f > 0.0:
        f_low = bracket.f_low * (0.5 if bracket.moved == 1 else 1.0)
        return Bracket(bracket.low, t, f_low, f, 1)
    f_high = bracket.f_high * (0.5 if bracket.moved == -1 else 1.0)
    return Bracket(t, bracket.high, f, f_high, -1)
