"""Octomaps: which cells are occupied, what their outside is, and what is refused."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadInput
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from clearance.formats.mesh.octree_file import octree_of
from tests.examples import examples
from tests.formats.making_octree import octree
from tests.formats.refusal import refusal

BLOCK = {cell: True for cell in itertools.product(range(4), range(2), range(2))}
CELLS = st.dictionaries(
    st.tuples(*[st.integers(-3, 3)] * 3), st.booleans(), min_size=1, max_size=30
)


def solid(data: bytes, name: str = "map.bt") -> cl.Polyhedron:
    return mesh_from_bytes(data, name).shape


@given(CELLS, st.booleans(), st.booleans())
@examples(60)
def test_the_cells_are_those_of_the_file(cells, full, pruned):
    tree = octree_of(octree(cells, full=full, pruned=pruned))
    found = {
        (x + i, y + j, z + k)
        for (x, y, z), size in zip(tree.corners.tolist(), tree.sizes.tolist(), strict=True)
        for i, j, k in itertools.product(range(size), repeat=3)
    }
    assert found == {cell for cell, told in cells.items() if told}


@given(CELLS.filter(lambda cells: any(cells.values())))
@examples(40)
def test_the_outside_is_closed_and_as_far_as_the_cubes(cells):
    occupied = np.array([cell for cell, told in cells.items() if told])
    shape = solid(octree(cells, 0.5))
    assert shape.volume == pytest.approx(0.125 * len(occupied), rel=1e-12)
    assert shape.component_closed.all()
    random = np.random.default_rng(len(cells))
    for point in random.uniform(-3.0, 3.0, (5, 3)):
        away = np.maximum(np.abs(point - 0.5 * (occupied + 0.5)) - 0.25, 0.0)
        least = max(0.0, np.linalg.norm(away, axis=1).min() - 0.01)
        assert cl.distance(shape, cl.PointCloud([point], 0.01)).distance == pytest.approx(
            least, abs=1e-12
        )


def test_cells_of_two_sizes_side_by_side_stay_closed():
    """Squares of different sizes do not cancel; both are there, and nothing is farther for it."""
    shape = solid(octree(BLOCK | {(4, 0, 0): True}, 0.25, pruned=True))
    assert shape.volume == pytest.approx(0.25 + 0.25**3)
    assert shape.component_closed.all()
    inside = cl.PointCloud([[1.0, 0.1, 0.1]], 1e-6)  # on the square between both
    assert cl.distance(shape, inside).contact
    near = cl.distance(shape, cl.PointCloud([[1.5, 0.1, 0.1]], 0.01))
    assert near.distance == pytest.approx(0.24)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", "not an octomap"),
        (octree(BLOCK).replace(b"id OcTree", b"id ColorOcTree"), "kind 'ColorOcTree' is not read"),
        (octree(BLOCK).replace(b"res 0.1", b"res -1"), "the resolution is -1.0"),
        (octree(BLOCK).replace(b"res 0.1\n", b""), "no one res"),
        (octree(BLOCK).replace(b"size ", b"size 1"), "as its size says"),
        (octree(BLOCK) + b"\1", "1 bytes follow the tree"),
        (octree({(0, 0, 0): False}), "no cell of the octomap is occupied"),
        (octree({(0, 0, 0): True}) .partition(b"data\n")[0] + b"data\n" + b"\xff" * 400, "levels deep"),
        (octree(BLOCK, full=True).partition(b"data\n")[0] + b"data\n" + b"\0\0\xc0\x7f\0", "has the value nan"),
    ],
)  # fmt: skip
def test_what_is_no_octomap_is_refused(data, told):
    assert told in refusal(mesh_from_bytes, data, "map.bt", of=BadInput)
