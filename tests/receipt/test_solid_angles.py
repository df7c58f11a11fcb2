"""What is inside what, where surfaces keep apart."""

import numpy as np

import clearance as cl
from clearance.receipt.proof.inside import closed_faces, one_point_each, winds_about_none
from clearance.receipt.proof.motion_data import Shape


def shape_of(solid):
    return Shape("body", solid.vertices, solid.triangles(), 0.0)


def winds(solid, *points):
    shape = shape_of(solid)
    return not winds_about_none(np.array(points, dtype=float), shape.points[closed_faces(shape)])


def test_a_point_in_a_box_and_one_beside_it():
    box = cl.box((1.0, 1.0, 1.0))
    assert winds(box, (0.1, 0.2, 0.3)) and winds(box.flipped(), (0.1, 0.2, 0.3))
    assert not winds(box, (0.6, 0.0, 0.0)) and winds(box, (0.6, 0.0, 0.0), (0.4999, 0.0, 0.0))


def test_nothing_is_in_a_bore_a_cavity_or_an_open_surface():
    pipe = cl.pipe(inner_radius=0.16, outer_radius=0.18, length=0.8)
    assert not winds(pipe, (0.0, 0.0, 0.0)) and winds(pipe, (0.17, 0.0, 0.0))
    shell = cl.Polyhedron.merged([cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5)).flipped()])
    assert not winds(shell, (0.0, 0.0, 0.0)) and winds(shell, (0.4, 0.0, 0.0))
    box = cl.box((1.0, 1.0, 1.0))
    lidless = cl.Polyhedron(box.vertices, box.triangles()[2:])
    assert not winds(lidless, (0.0, 0.0, 0.0))


def test_every_part_of_a_body_has_a_point():
    far = np.eye(4)
    far[0, 3] = 3.0
    both = cl.Polyhedron.merged([cl.box((1.0, 1.0, 1.0)), cl.box((1.0, 1.0, 1.0)).transformed(far)])
    points = one_point_each(shape_of(both))
    assert sorted(np.sign(points[:, 0] - 1.5)) == [-1.0, 1.0]
