"""Halves of bodies: all faces, each once, in boxes that hold them."""

import numpy as np

import clearance as cl
from clearance.receipt.proof.halving import farthest_points, halves_of, over_boxes, over_corners
from clearance.receipt.proof.motion_data import Shape


def shape_of(solid, radius=0.0):
    return Shape("body", solid.vertices, solid.triangles(), radius)


def test_the_halves_of_a_node_are_its_faces_and_its_box_holds_them():
    shapes = [shape_of(cl.sphere(0.3, 1e-2)), shape_of(cl.box((1.0, 2.0, 3.0)))]
    halves = halves_of(shapes)
    for body, shape in enumerate(shapes):
        first = halves.first_node[body]
        every = halves.corners[:, :, halves.start[first] : halves.stop[first]]
        assert sorted(map(tuple, every.T.reshape(-1, 9))) == sorted(
            map(tuple, shape.corners.reshape(-1, 9))
        )
        for node in range(len(shape.faces)):
            at, low, high = first + node, first + 2 * node + 1, first + 2 * node + 2
            own = halves.corners[:, :, halves.start[at] : halves.stop[at]]
            if own.shape[2] == 0:
                continue
            assert (halves.low[:, at] == own.min(axis=(1, 2))).all()
            assert (halves.high[:, at] == own.max(axis=(1, 2))).all()
            if own.shape[2] > 1:
                assert (halves.start[low], halves.stop[high]) == (halves.start[at], halves.stop[at])
                assert halves.stop[low] == halves.start[high]


def test_no_point_of_a_node_is_farther_than_what_is_said_of_it():
    solid = cl.sphere(0.3)
    halves, rng = halves_of([shape_of(solid)]), np.random.default_rng(3)
    nodes = np.repeat(np.arange(63), 5)
    along = rng.normal(size=(3, 2, len(nodes)))
    found = over_corners(halves, np.zeros_like(nodes), nodes, along)
    for i, node in enumerate(nodes):
        own = halves.corners[:, :, halves.start[node] : halves.stop[node]].reshape(3, -1)
        for t in (0, 1):
            true = (along[:, t, i] @ own).max()
            assert true <= found[t, i]
            if own.shape[1] <= 24:
                assert true == found[t, i] or abs(true - found[t, i]) < 1e-15
    assert (over_boxes(halves, np.zeros_like(nodes), nodes, along) >= found).all()
    points = farthest_points(halves, np.zeros_like(nodes), nodes, along[:, 0])
    assert np.allclose((points * along[:, 0]).sum(axis=0), found[0], atol=1e-12)
