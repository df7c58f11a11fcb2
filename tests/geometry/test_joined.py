"""Several bodies laid behind one another: kept for the next run, never mixed up."""

from __future__ import annotations

import gc

import numpy as np

from clearance.geometry.shapes import box
from clearance.geometry.tree import join, surface_of
from clearance.kernels.arithmetic.lanes import WIDTH


def test_the_same_bodies_are_laid_out_once() -> None:
    one, two = box((1, 1, 1)), box((1, 2, 3))
    assert join([one, two]) is join([one, two])


def test_other_bodies_behind_the_same_first_one_are_other_surfaces() -> None:
    one, two, three = box((1, 1, 1)), box((1, 2, 3)), box((3, 2, 1))
    first = join([one, two])
    second = join([one, three])
    assert not np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(join([one, two]).vertices, first.vertices)
    assert len(join([one, two, three]).roots) == 3


def test_a_dead_body_is_not_taken_for_a_new_one() -> None:
    """What earlier tests left alive is frozen: looking through all of it each time took most of a minute."""
    one = box((1, 1, 1))
    gc.freeze()
    try:
        for size in range(2, 40):
            joined = join([one, box((1, 1, size))])
            assert joined.vertices[:, 2].max() == size / 2
            gc.collect()
    finally:
        gc.unfreeze()


def test_every_index_points_into_its_own_body() -> None:
    shapes = [box((1, 1, 1)), box((1, 2, 3)), box((2, 2, 2))]
    joined = join(shapes)
    for shape, root in zip(shapes, joined.roots, strict=True):
        group = root // WIDTH
        assert np.array_equal(
            joined.centres[3 * group : 3 * group + 3], surface_of(shape).centres[:3]
        )
        assert np.array_equal(
            joined.boxes[12 * group : 12 * group + 12], surface_of(shape).boxes[:12]
        )
