"""Parts that are inside out are turned by how they nest: outermost ones outward, cavities inward."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import Polyhedron, box
from tests.examples import examples


def block(size, x=0.0, y=0.0):
    pose = np.eye(4)
    pose[:2, 3] = x, y
    return box((size,) * 3).transformed(pose)


def body(*parts):
    return Polyhedron.merged(list(parts))


def inside_out(solid):
    """All of a body the other way round."""
    return solid.flipped()


HOLLOW = body(block(1.0), block(0.6).flipped())


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_below_an_outermost_part_that_is_inside_out_parts_are_solid_and_hollow_by_turns(signs):
    parts = [block(5.0).flipped(), block(3.0), block(1.0)]
    parts[1:] = [p if s > 0 else p.flipped() for p, s in zip(parts[1:], signs, strict=True)]
    assert body(*parts).outward().volume == pytest.approx(125.0 - 27.0 + 1.0)


@pytest.mark.parametrize(
    ("signs", "volume"),
    [((1, 1), 125 + 27 + 1), ((-1, 1), 125 - 27 + 1), ((-1, -1), 125 - 27 + 1), ((1, -1), 125 + 27 - 1)],
)  # fmt: skip
def test_below_one_that_is_right_solids_stay_and_what_is_in_a_cavity_is_solid(signs, volume):
    inner = [block(3.0), block(1.0)]
    inner = [p if s > 0 else p.flipped() for p, s in zip(inner, signs, strict=True)]
    assert body(block(5.0), *inner).outward().volume == pytest.approx(volume)


def test_a_part_that_reaches_through_the_wall_is_not_within():
    """A bolt in the wall of a housing that is inside out stays as it is, wherever its first corner lies."""
    for shift in (0.5, -0.5):
        bolt = box((0.5, 0.1, 0.1)).transformed(np.eye(4) + np.eye(4, k=3) * shift)
        both = body(block(1.0).flipped(), bolt)
        assert both.component_inside_out.tolist() == [True, False]
        assert body(block(1.0).flipped(), bolt.flipped()).component_inside_out.all()


def test_parts_that_touch_from_within_and_from_without():
    """A cavity against a face of its wall is one; a block against it from outside is a body of its own."""
    within = body(block(1.0), block(0.5, x=0.25).flipped())
    assert inside_out(within).outward().volume == pytest.approx(1.0 - 0.125)
    without = body(block(1.0).flipped(), block(0.5, x=0.75))
    assert without.outward().volume == pytest.approx(1.125)


def test_open_parts_are_left_and_hold_nothing():
    lidless = Polyhedron(
        block(3.0).vertices, [block(3.0).face_vertices[4 * k : 4 * k + 4] for k in range(5)]
    )
    for part in (lidless, lidless.flipped()):
        mixed = body(part, block(1.0).flipped())
        assert mixed.component_inside_out.tolist() == [False, True]
    inner = Polyhedron(
        block(0.2).vertices, [block(0.2).face_vertices[4 * k : 4 * k + 4] for k in range(5)]
    )
    assert body(inside_out(HOLLOW), inner).component_inside_out.tolist() == [True, True, False]


@st.composite
def nests(draw, level=0):
    """(parts as (centre x, size), sign) of a tree of blocks side by side, each hollow by turns."""
    n = draw(st.integers(1, 2 if level else 3))
    return [
        draw(nests(level=level + 1)) if level < 2 and draw(st.booleans()) else [] for _ in range(n)
    ]


def planted(nest, x, size, depth=0):
    """The parts of a tree within a block about x, solid at even depth."""
    step = size / len(nest)
    for k, below in enumerate(nest):
        middle = x - size / 2 + (k + 0.5) * step
        part = block(0.8 * step, x=middle)
        yield part if depth % 2 == 0 else part.flipped()
        yield from planted(below, middle, 0.7 * step, depth + 1) if below else ()


@given(nests(), st.integers(0, 2**32 - 1))
@examples(40)
def test_a_body_inside_out_is_the_body_again(nest, seed):
    parts = list(planted(nest, 0.0, 4.0))
    order = np.random.default_rng(seed).permutation(len(parts))
    right = body(*(parts[i] for i in order))
    assert right.outward() is right
    again = inside_out(right).outward()
    assert again.volume == pytest.approx(right.volume)
    assert not again.component_inside_out.any()
    assert inside_out(right).component_inside_out.all()
