"""Sketches as users draw them, roughly and with what they forget or say twice; the truth is counted by hand.

The table says of each drawing its verdict and its freedoms beyond placing the whole.
"""

import numpy as np
import pytest

from clearance.sketch.faults import DegenerateSketch
from tests.sketch import drawn_mechanisms as mechanisms
from tests.sketch import drawn_outlines as outlines
from tests.sketch.patterns import again

TRUTH = {
    outlines.rectangle_and_its_diagonal: ("over", 0),
    outlines.rectangle_and_a_wrong_diagonal: ("inconsistent", None),
    outlines.rectangle_of_equal_sides: ("over", 0),
    outlines.rectangle_of_equal_sides_and_a_wrong_one: ("inconsistent", None),
    outlines.square_of_equal_sides: ("over", 0),
    outlines.parallelogram_of_equal_sides: ("over", 0),
    outlines.triangle_of_three_angles: ("over", 0),
    outlines.triangle_that_cannot_close: ("inconsistent", None),
    outlines.triangle_with_its_medians_through_a_point: ("over", 0),
    outlines.slot_given: ("well", 0),
    outlines.fixed_rounded_rectangle: ("well", 0),
    outlines.bracket: ("well", 0),
    outlines.bracket_with_a_wrong_inner_length: ("inconsistent", None),
    mechanisms.peaucellier: ("under", 1),
    mechanisms.peaucellier_on_its_line: ("over", 1),
    mechanisms.belt: ("well", 0),
    mechanisms.planets: ("under", 2),
    mechanisms.incircle: ("well", 0),
    mechanisms.incircle_too_large: ("inconsistent", None),
    mechanisms.coincident_twice: ("over", 0),
    mechanisms.two_pieces: ("under", 3),
    mechanisms.desargues_line: ("over", 0),
}


@pytest.mark.parametrize("drawn", TRUTH, ids=lambda f: f.__name__)
def test_verdict_and_freedom(drawn):
    status, freedom = TRUTH[drawn]
    s = drawn()
    result = s.solve()
    assert result.status == status, (result.redundant, result.reason)
    if freedom is None:
        check_conflict(s, result.conflicts)
        return
    assert result.residual <= 1e-12 * 10.0 or result.redundant
    assert result.freedom == freedom
    before = list(s._lists.numbers)
    assert s.solve().solved and s._lists.numbers == before
    for name in result.redundant:
        assert again(s, [name]).solve().freedom == freedom
    if status == "over":
        assert result.redundant


def test_equal_sides_of_a_rectangle_are_implied_and_not_its_height():
    s = outlines.rectangle_of_equal_sides()
    assert s.solve().redundant == ["alike"]
    s.set("h", 3.0)
    result = s.solve()
    assert (result.status, result.redundant) == ("over", ["alike"])
    corners = [p.position for p in outlines.of_kind(s, "point")]
    np.testing.assert_allclose(corners, [(0, 0), (1.5, 0), (1.5, 3), (0, 3)], atol=1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_a_rectangle_said_twice_is_solved_in_any_order(seed):
    """Without the constraint that the count takes for implied, the others may leave a freedom, and collapse."""
    result = outlines.rectangle_said_twice(seed).solve()
    assert result.status == "over" and result.freedom == 0, result.reason


def check_conflict(s, names):
    """No place is found for the conflict, from the drawing or near it, and one for it without any one member."""
    assert names
    rest = [n for n in s.constraints if n not in names]
    assert not found(s, rest, 3)
    for name in names:
        assert found(s, [*rest, name], 60), name


def found(s, names, attempts):
    """Whether the sketch without some constraints is solved, drawn as it is or shaken."""
    for k in range(attempts):
        t, random = again(s, names), np.random.default_rng(k)
        t._lists.numbers[:] = [v + random.uniform(-0.1, 0.1) * k for v in t._lists.numbers]
        try:
            if t.solve().solved:
                return True
        except DegenerateSketch:
            continue
    return False
