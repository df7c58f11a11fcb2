"""A query that remembers against single questions, bit for bit, whatever the poses do."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadPose, BadShape, NotFinite
from tests.examples import examples
from tests.strategies import boxes, poses, rotations


def turned(axis, angle):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, :3] += np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
    return pose


def placed(random, reach):
    pose = np.eye(4)
    pose[:3, :3] = rotations(random, 1)[0]
    pose[:3, 3] = random.uniform(-reach, reach, 3)
    return pose


def walk(random, n, size, reach):
    """(n, 4, 4) poses that drift, with a jump to anywhere now and then."""
    pose, walked = placed(random, reach), []
    for _ in range(n):
        if random.random() < 0.05:
            pose = placed(random, reach)
        pose = pose @ turned(random.normal(size=3), size * random.normal())
        pose[:3, 3] = np.clip(pose[:3, 3] + size * random.normal(size=3), -reach, reach)
        pose[:3, :3] = np.linalg.qr(pose[:3, :3])[0] * np.sign(
            np.diag(np.linalg.qr(pose[:3, :3])[1])
        )
        walked.append(pose)
    return np.array(walked)


def bent_pipe():
    path = np.array([[0.0, 0, 0], [0.6, 0, 0], [0.6, 0.6, 0], [0, 0.6, 0.1]])
    return cl.pipe(inner_radius=0.05, outer_radius=0.07, path=path, bend_radius=0.15, sections=10)


def cup():
    """A concave body of five plates that touch."""
    plates = [
        ((0.6, 0.6, 0.05), (0, 0, -0.3)),
        ((0.05, 0.6, 0.6), (0.3, 0, 0)),
        ((0.05, 0.6, 0.6), (-0.3, 0, 0)),
    ]
    plates += [((0.6, 0.05, 0.6), (0, 0.3, 0)), ((0.6, 0.05, 0.6), (0, -0.3, 0))]
    made = []
    for size, centre in plates:
        pose = np.eye(4)
        pose[:3, 3] = centre
        made.append(cl.box(size).transformed(pose))
    return cl.Polyhedron.merged(made)


PAIRS = {
    "ball and pipe": (lambda: cl.sphere(radius=0.3, tolerance=0.003), bent_pipe),
    "pipe and cup": (bent_pipe, cup),
    "cup and cup": (cup, cup),
    "box in a box": (lambda: cl.box((1.0, 1.0, 1.0)), lambda: cl.box((0.2, 0.2, 0.2))),
}


@pytest.fixture(scope="module", params=PAIRS.values(), ids=PAIRS)
def pair(request):
    return tuple(make() for make in request.param)


def assert_same(near, single):
    for field in fields(near):
        if field.name != "tally":
            got, wanted = getattr(near, field.name), getattr(single, field.name)
            assert type(got) is type(wanted), field.name
            assert np.array_equal(got, wanted), field.name
    assert near.tally.keys() == single.tally.keys()


@pytest.mark.parametrize(("size", "reach"), [(0.002, 0.7), (0.05, 0.7), (0.5, 0.4), (0.01, 3.0)])
def test_answers_are_those_of_single_questions(pair, size, reach):
    random = np.random.default_rng(5)
    query = cl.Query(*pair)
    contacts = []
    for pose_a, pose_b in zip(
        walk(random, 60, size, reach), walk(random, 60, size, reach), strict=True
    ):
        near = query.distance(pose_a, pose_b)
        assert_same(near, cl.distance(*pair, pose_a=pose_a, pose_b=pose_b))
        contacts.append(near.contact)
    if reach == 0.7:
        assert True in contacts
    if reach == 3.0:
        assert False in contacts


def test_one_call_for_many_poses_gives_the_same_rows(pair):
    random = np.random.default_rng(6)
    poses_a, poses_b = walk(random, 40, 0.02, 0.8), walk(random, 40, 0.02, 0.8)
    rows = cl.Query(*pair).distances(poses_a, poses_b)
    query = cl.Query(*pair)
    for i in range(40):
        near = query.distance(poses_a[i], poses_b[i])
        assert rows.distances[i] == near.distance
        assert rows.error_bounds[i] == near.error_bound
        assert np.array_equal(rows.points[i], [near.point_a, near.point_b])
        assert rows.faces[i].tolist() == [near.face_a, near.face_b]


@given(
    boxes(), boxes(), st.lists(st.tuples(poses(), poses(), st.booleans()), min_size=2, max_size=6)
)
@examples(40)
def test_boxes_anywhere_and_back_again(a, b, asked):
    one, other = cl.Polyhedron(*a), cl.Polyhedron(*b)
    query = cl.Query(one, other)
    for pose_a, pose_b, nudged in [*asked, *asked[::-1]]:
        if nudged:
            pose_a = pose_a.copy()
            pose_a[0, 3] += 2.0**-20
        assert_same(
            query.distance(pose_a, pose_b), cl.distance(one, other, pose_a=pose_a, pose_b=pose_b)
        )


def test_a_body_that_stands_is_given_once_or_not_at_all():
    a, b = cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5))
    walked = np.tile(np.eye(4), (3, 1, 1))
    walked[:, 0, 3] = [1.75, 1.0, 0.1]
    query = cl.Query(a, b)
    expected = [1.0, 0.25, 0.0]
    for rows in (
        query.distances(None, walked),
        query.distances(np.eye(4), walked),
        query.distances(walked),
    ):
        assert rows.distances.tolist() == expected
        assert rows.points.shape == (3, 2, 3)
        assert rows.faces.shape == (3, 2)
    assert rows.faces[2].tolist() == [-1, -1]
    assert query.distances(walked[:0], walked[:0]).distances.shape == (0,)
    assert query.distances().distances.tolist() == [0.0]


def test_poses_of_any_layout_are_taken():
    query = cl.Query(cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5)))
    pose = np.eye(4)
    pose[0, 3] = 1.75
    frozen = pose.copy()
    frozen.flags.writeable = False
    for given_pose in (
        frozen,
        np.asfortranarray(pose),
        pose.tolist(),
        pose.astype(np.float32),
        pose[::1, :],
    ):
        assert query.distance(given_pose).distance == 1.0
        assert query.distances(np.tile(given_pose, (2, 1, 1)), pose).distances.tolist() == [
            0.0,
            0.0,
        ]
    standing = np.broadcast_to(pose, (2, 4, 4))
    assert query.distances(standing).distances.tolist() == [1.0, 1.0]


def bad_poses():
    good = np.eye(4)
    for fault, row, column, value in [
        (NotFinite, 0, 3, np.nan), (NotFinite, 1, 1, np.inf), (BadPose, 0, 0, 1.001), (BadPose, 0, 0, -1.0),
        (BadPose, 3, 3, 2.0), (BadPose, 3, 0, 1e-9), (BadPose, 2, 3, 1e200), (BadPose, 0, 1, 1e-5),
    ]:  # fmt: skip
        bad = good.copy()
        bad[row, column] = value
        yield fault, bad
    yield BadShape, np.eye(3)
    yield BadShape, np.ones(4)
    yield BadShape, "pose"


@pytest.mark.parametrize(("fault", "bad"), list(bad_poses()))
def test_what_is_no_pose_is_refused_and_forgotten(fault, bad):
    a, b = cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5))
    query, pose = cl.Query(a, b), np.eye(4)
    pose[0, 3] = 1.75
    query.distance(pose)
    for asked in ((bad, pose), (pose, bad)):
        with pytest.raises(fault):
            query.distance(*asked)
    with pytest.raises(fault, match="worlds_from_b"):
        query.distances(pose, [pose, bad] if np.shape(bad) == (4, 4) else bad)
    assert query.distance(pose).distance == 1.0


def test_threads_that_share_a_query_get_their_own_answers():
    a, b = bent_pipe(), cl.sphere(radius=0.3, tolerance=0.01)
    query, wrong = cl.Query(a, b), []

    def ask(seed):
        for pose in walk(np.random.default_rng(seed), 60, 0.05, 1.5):
            near, single = query.distance(pose), cl.distance(a, b, pose_a=pose)
            if near.distance != single.distance or not np.array_equal(near.point_b, single.point_b):
                wrong.append((near, single))

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(ask, range(4)))
    assert not wrong
