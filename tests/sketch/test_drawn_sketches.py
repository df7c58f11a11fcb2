"""Sketches as users draw them, roughly and with what they forget or say twice; the truth is counted by hand.

The table says of each drawing its verdict and its freedoms beyond placing the whole.
"""

import numpy as np
import pytest

from clearance.sketch import Sketch
from clearance.sketch.faults import DegenerateSketch
from tests.sketch import drawn_mechanisms as mechanisms
from tests.sketch import drawn_outlines as outlines

TRUTH = {
    outlines.rectangle_free: ("under", 2),
    outlines.rectangle_given: ("well", 0),
    outlines.rectangle_four_right_angles: ("over", 0),
    outlines.rectangle_and_its_diagonal: ("over", 0),
    outlines.rectangle_and_a_wrong_diagonal: ("inconsistent", None),
    outlines.centred_rectangle: ("under", 1),
    outlines.square_by_equal_sides: ("well", 0),
    outlines.triangle_of_three_angles: ("over", 0),
    outlines.triangle_that_cannot_close: ("inconsistent", None),
    outlines.triangle_with_its_medians_through_a_point: ("over", 0),
    outlines.slot_free: ("under", 2),
    outlines.slot_given: ("well", 0),
    outlines.rounded_rectangle: ("under", 2),
    outlines.fixed_rounded_rectangle: ("well", 0),
    outlines.fillet_of_given_radius_in_a_given_corner: ("well", 0),
    outlines.bracket: ("well", 0),
    outlines.bracket_with_a_wrong_inner_length: ("inconsistent", None),
    outlines.mirrored_half: ("under", 1),
    mechanisms.four_bar: ("under", 1),
    mechanisms.peaucellier: ("under", 1),
    mechanisms.peaucellier_on_its_line: ("over", 1),
    mechanisms.belt: ("well", 0),
    mechanisms.chain_of_arcs: ("under", 2),
    mechanisms.planets: ("under", 2),
    mechanisms.incircle: ("well", 0),
    mechanisms.incircle_too_large: ("inconsistent", None),
    mechanisms.coincident_twice: ("over", 0),
    mechanisms.lone_point: ("under", 2),
    mechanisms.two_pieces: ("under", 3),
    mechanisms.truss: ("well", 0),
    mechanisms.desargues_points: ("well", 0),
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
        assert without(s, name).solve().freedom == freedom
    if status == "over":
        assert result.redundant


def without(s, *names):
    """The sketch without some constraints."""
    t = Sketch()
    for name, e in s.entities.items():
        if e.what == "point":
            t.point(*e.position, name=name)
    for name, e in s.entities.items():
        if e.what in ("line", "segment"):
            foot = e.offset * np.array([-e.direction[1], e.direction[0]])
            t.line(foot, foot + e.direction, name=name)
            t.entity(name).ends = tuple(t.entity(p.name) for p in e.ends) if e.ends else None
        elif e.what in ("circle", "arc"):
            t.circle(t.entity(e.center.name), e.radius, name=name)
    for name, c in s.constraints.items():
        if name not in names and not c.driven:
            value = c.number if c.given is not None else None
            t.add(c.kind, *(e.name for e in c.entities), value=value, name=name, **c.options)
    return t


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
        t, random = without(s, *names), np.random.default_rng(k)
        t._lists.numbers[:] = [v + random.uniform(-0.1, 0.1) * k for v in t._lists.numbers]
        try:
            if t.solve().solved:
                return True
        except DegenerateSketch:
            continue
    return False
