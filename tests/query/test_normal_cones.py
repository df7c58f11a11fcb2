"""Normal cones: nodes that are turned away hold no nearest points, by exact rationals on hostile surfaces.

Bodies have few faces: which are nearest is asked of rational arithmetic for every pair of faces.
"""

import itertools

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.lanes import ALL, WIDTH, lane
from clearance.kernels.arithmetic.vec3 import Vec3, rigid
from clearance.kernels.features.bounds import direction_between, rounding_slack
from clearance.kernels.search.displacement import Still
from clearance.kernels.search.node_pairs import (
    NodeGroup,
    bounds_of_group,
    turned_away,
    views_along,
)
from tests import oracle
from tests.examples import examples
from tests.made_cases import (
    at,
    ball,
    corners_moved,
    dented,
    faces_below,
    faces_of,
    torus,
)
from tests.strategies import rotations


def is_turned_away(a, b, pose_a, pose_b, i, j):
    """If the node i of a is left out from j of b where both are apart, and j from i."""
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    still = Still(rounding_slack(a, a.roots[0], b, b.roots[0], frames))
    views = views_along(
        direction_between(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), frames.m), frames.m
    )
    for group, k in ((NodeGroup(False, i // WIDTH, j), i), (NodeGroup(True, j // WIDTH, i), j)):
        bounds = bounds_of_group(a, b, views, group, ALL, still, np.inf)
        away = turned_away(a, b, views, group, ALL, bounds, still)
        yield lane(bounds, k % WIDTH) > 0.0 and away >> k % WIDTH & 1


def crossing(random):
    """Two dented balls in one surface that cut each other; what is near may be inside the other one."""
    one, two = dented(random, 0), dented(random, 0)
    return Polyhedron.merged([one, two.transformed(at(*random.normal(scale=0.4, size=3)))])


def fan(random):
    """Faces round one corner, some two fans of them, pinched."""
    n = int(random.integers(3, 8))
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, n))
    rim = np.stack([np.cos(turn), np.sin(turn), random.uniform(-1.5, 1.5, n)], axis=1)
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim, -rim * random.uniform(0.5, 2.0, (n, 1))])
    faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    if random.random() < 0.5:
        faces += [(0, 1 + n + (k + 1) % n, 1 + n + k) for k in range(n)]
    return Polyhedron(vertices, faces)


def half(random):
    shape = dented(random, 0)
    return Polyhedron(shape.vertices, faces_of(shape)[: shape.n_faces // 2])


def twice(random):
    shape = dented(random, 0)
    return Polyhedron(shape.vertices, faces_of(shape) + [face[::-1] for face in faces_of(shape)])


def copied(random):
    """Some faces twice, some of these the other way round."""
    shape = dented(random, 0)
    again = [face for face in faces_of(shape) if random.random() < 0.4]
    return Polyhedron(
        shape.vertices, faces_of(shape) + [face[:: random.choice([-1, 1])] for face in again]
    )


def thin_shell(random):
    shape = dented(random, 0)
    return Polyhedron.merged([shape, corners_moved(shape, 0.97 * shape.vertices).flipped()])


def some_turned_round(random):
    shape = dented(random, 0)
    turned = random.random(shape.n_faces) < 0.1
    faces = [
        face[::-1] if round_ else face for face, round_ in zip(faces_of(shape), turned, strict=True)
    ]
    return Polyhedron(shape.vertices, faces)


def dented_ring(random):
    shape = torus(1.0, 0.3, 6, 4)
    return corners_moved(
        shape, shape.vertices + random.normal(scale=0.08, size=shape.vertices.shape)
    )


def squeezed(random, height):
    shape = dented(random, 0)
    return corners_moved(shape, shape.vertices * (1.0, height, 1.0))


KINDS = {
    "ball": lambda random: ball(1.0, 0),
    "dented": lambda random: dented(random, 0),
    "ring": lambda random: torus(1.0, 0.3, 6, 4),
    "dented ring": dented_ring,
    "inside out": lambda random: dented(random, 0).flipped(),
    "some turned round": some_turned_round,
    "half": half,
    "crossing": crossing,
    "fan": fan,
    "twice": twice,
    "copied": copied,
    "thin shell": thin_shell,
    "needles": lambda random: squeezed(random, 1e-5),
    "flat": lambda random: squeezed(random, 0.0),
    "box": lambda random: cl.box((1.0, 0.6, 0.3)),
    "pipe": lambda random: cl.pipe(inner_radius=0.4, outer_radius=0.5, length=1.0, sections=6),
}


def owners_of_the_nearest(a, b, pose_a, pose_b):
    """The faces of least index that hold the nearest points; None where the bodies touch."""
    sq, attained = oracle.nearest_faces(
        a.vertices, faces_of(a), b.vertices, faces_of(b), pose_a, pose_b
    )
    return None if sq == 0 else (min(f for f, _ in attained), min(g for _, g in attained))


def nodes_over(surface, face):
    """The nodes of the tree that a face lies below."""
    return [node for node, below in enumerate(faces_below(surface)) if face in below]


def anywhere(random, reach):
    turned = rotations(random, 1)[0]
    return at(*(reach * random.normal(size=3)), turned)


@pytest.mark.slow
@examples(20)
@example(0, "dented", "fan", 2.0, 0.0)
@example(1, "crossing", "twice", 1.0, 4e-7)
@example(2, "copied", "thin shell", 2.0, 0.0)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(sorted(KINDS)), st.sampled_from(sorted(KINDS)),
    st.sampled_from([0.5, 1.0, 2.0, 10.0]), st.sampled_from([0.0, 4e-7]),
)  # fmt: skip
def test_what_holds_the_nearest_points_is_not_turned_away(seed, kind_a, kind_b, reach, off):
    random = np.random.default_rng(seed)
    a, b = KINDS[kind_a](random), KINDS[kind_b](random)
    pose_a, pose_b = anywhere(random, 0.0), anywhere(random, reach)
    pose_b[:3, :3] += off / 3.0 * random.uniform(-1.0, 1.0, size=(3, 3))
    owners = owners_of_the_nearest(a, b, pose_a, pose_b)
    if owners is None:
        return
    one, two = surface_of(a), surface_of(b)
    for i, j in itertools.product(*(map(nodes_over, (one, two), owners))):
        assert not any(is_turned_away(one, two, pose_a, pose_b, i, j))
