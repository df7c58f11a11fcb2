"""Bounds on the distance of parts in motion, against rational arithmetic, and what is inside what."""

import math

import numpy as np
import pytest

import clearance as cl
from clearance.receipt.case_data import case_data
from clearance.receipt.fronts import codes_of
from clearance.receipt.nearest import nearest_directions
from clearance.receipt.proof.halving import farthest_points, halves_of, over_boxes, over_corners
from clearance.receipt.proof.inside import closed_faces, one_point_each, winds_about_none
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.joint_paths import IntervalPieces
from clearance.receipt.proof.motion_data import NONE, Shape
from clearance.receipt.proof.proving import SIZES
from clearance.receipt.proof.separation import BYTE, directions
from clearance.receipt.proof.stage import by_balls, by_directions
from clearance.receipt.proof.views import chain_above
from tests import cells
from tests.examples import first_fast
from tests.oracle.polyhedra import polyhedron_distance_sq
from tests.receipt.receipts import everything_moves, stage_of

CLAIM = 2.0**-20


def some_items(stage, rng, n=24):
    """Random parts of bodies over random pieces of time."""
    bodies = stage.stretch.pairs
    pair = rng.integers(0, len(bodies), n)
    depth = rng.integers(0, 4, n)
    nodes = [
        np.where(
            stage.halves.sizes(bodies[pair, k], np.zeros(n, int)) >= 8, rng.integers(0, 7, n), 0
        )
        for k in (0, 1)
    ]
    start = rng.integers(0, stage.stretch.n_intervals, n)
    one = np.ones(n, dtype=np.int64)
    return Items(pair, *nodes, start, one, rng.integers(0, 2**depth), depth)


def true_distance(case, stage, items, i, t):
    """[m] of the parts of an item at a share of its time, by other kinematics and exact arithmetic."""
    share = (items.part[i] + t) * 0.5 ** items.depth[i]
    times = stage.stretch.times[items.start[i] : items.start[i] + 2]
    time = (1.0 - share) * times[0] + share * times[1]
    sides = []
    for k, node in ((0, items.node_a[i]), (1, items.node_b[i])):
        body = stage.stretch.pairs[items.pair[i], k]
        at = stage.halves.first_node[body] + node
        corners = stage.halves.corners[:, :, stage.halves.start[at] : stage.halves.stop[at]]
        pose = cells.pose_at(case, stage.shapes[body].name, float(time), left=share == 1.0)
        points = corners.transpose(2, 1, 0).reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
        sides += [points, np.arange(len(points)).reshape(-1, 3)]
    return math.sqrt(polyhedron_distance_sq(*sides))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_no_bound_is_above_the_distance_at_any_moment_of_its_piece(seed):
    case, rng = everything_moves(seed), np.random.default_rng(seed)
    data = case_data(case)
    n_tight = 0
    for i_stretch in range(len(data.stretches)):
        stage = stage_of(data, i_stretch, CLAIM)
        items = some_items(stage, rng)
        u, _ = nearest_directions(stage, items)
        away = rng.normal(size=u.shape)
        bounds = [by_balls(stage, items), by_directions(stage, items, away)]
        bounds += [by_directions(stage, items, directions(codes_of(u, m), m)) for _, m in SIZES]
        wanted = stage.wanted[items.pair, items.start]
        best = np.max(bounds, axis=0) + wanted
        for i in rng.permutation(len(items.pair))[:8]:
            true = min(true_distance(case, stage, items, i, t) for t in (0.0, rng.random(), 1.0))
            assert best[i] <= true + 1e-9
            n_tight += best[i] > 0.8 * true > 0.0
    assert n_tight > 0


def test_codes_stand_for_all_directions():
    rng = np.random.default_rng(0)
    u = rng.normal(size=(3, 500))
    u /= np.linalg.norm(u, axis=0)
    for most, loss in ((BYTE, 2e-4), (2**15 - 1, 3e-9), (2**31 - 1, 1e-15)):
        found = directions(codes_of(u, most), most)
        assert (np.abs(found).sum(axis=0) == most).all()
        assert ((u * found).sum(axis=0) / np.linalg.norm(found, axis=0) >= 1.0 - loss).all()
    axes = np.concatenate([np.eye(3), -np.eye(3)], axis=1)
    assert (directions(codes_of(axes, BYTE), BYTE) == BYTE * axes).all()


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


@pytest.mark.parametrize("seed", first_fast([0, 2], 1))
def test_no_point_is_farther_off_than_its_bounds_say(seed):
    case, rng = everything_moves(seed), np.random.default_rng(seed)
    data = case_data(case)
    for i_stretch, stretch in enumerate(data.stretches):
        stage = stage_of(data, i_stretch)
        views = stage.views
        for interval in range(stretch.n_intervals):
            low = rng.integers(0, 4) / 4
            piece = IntervalPieces(np.array([interval]), np.array([low]), np.array([low + 0.25]))
            wanted = np.ones(len(views.frames), dtype=bool)
            at = stage._placed(piece, wanted)
            for view, body in enumerate(views.bodies):
                if in_world(stretch, views, view):
                    inside(case, data, stretch, at, view, int(body), piece, rng)


def in_world(stretch, views, view):
    """True if a view is from the world: its topmost frame hangs on a root."""
    frame = int(views.frames[view])
    if frame == NONE:
        return int(stretch.carriers[views.bodies[view]]) == NONE
    while views.above[frame] != NONE:
        frame = int(views.above[frame])
    return stretch.joints.parents[views.links[frame]] == NONE


def inside(case, data, stretch, at, view, body, piece, rng):
    """Asserts that random points at random moments of a piece are where the bounds say."""
    shape, i = data.shapes[body], int(piece.interval[0])
    points = shape.points[rng.integers(0, len(shape.points), 4)]
    middle = points @ at.turn[:, :, view].T + at.at[:, view]
    swing = at.v0[:, view] + np.cross(at.omega[:, view], middle)
    for t in (-1.0, *rng.uniform(-1.0, 1.0, 2), 1.0):
        share = 0.5 * (piece.low[0] + piece.high[0]) + 0.5 * t * (piece.high[0] - piece.low[0])
        time = (1.0 - share) * stretch.times[i] + share * stretch.times[i + 1]
        pose = cells.pose_at(case, shape.name, float(time), left=share == 1.0)
        moved = points @ pose[:3, :3].T + pose[:3, 3]
        slack = 1e-9
        off = np.linalg.norm(moved - middle - t * swing, axis=1)
        assert (off <= at.rest[view] + at.rounding[view] + slack).all()
        assert (np.linalg.norm(moved - middle, axis=1) <= at.way[view] + slack).all()


def test_rounding_is_far_below_a_nanometre_of_what_is_claimed():
    data = case_data(everything_moves(0))
    assert all(stage_of(data, i).whole.rounding.max() < 1e-11 for i in range(len(data.stretches)))


def test_what_both_bodies_stand_on_does_not_count():
    data = case_data(everything_moves(0))
    stretch = data.stretches[0]
    stage = stage_of(data, 0)
    for pair, views in zip(stretch.pairs, stage.views.pairs, strict=True):
        links = [int(stretch.carriers[body]) for body in pair]
        shared = set(chain_above(stretch.joints.parents, links[0])) & set(
            chain_above(stretch.joints.parents, links[1])
        )
        for view in views:
            frame = int(stage.views.frames[view])
            while frame != NONE:
                assert int(stage.views.links[frame]) not in shared
                frame = int(stage.views.above[frame])


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
