"""A query that remembers against single questions, bit for bit, whatever the poses do."""

import gc
import os
import subprocess
import sys
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.errors import BadPose, BadShape, NotFinite
from clearance.query.one_pair import cached_pair
from tests.made_cases import at
from tests.strategies import rotations


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
        pose[:3, :3] = pose[:3, :3] @ Rotation.from_rotvec(size * random.normal(size=3)).as_matrix()
        pose[:3, 3] = np.clip(pose[:3, 3] + size * random.normal(size=3), -reach, reach)
        walked.append(pose.copy())
    return np.array(walked)


def bent_pipe():
    path = np.array([[0.0, 0, 0], [0.6, 0, 0], [0.6, 0.6, 0], [0, 0.6, 0.1]])
    return cl.pipe(inner_radius=0.05, outer_radius=0.07, path=path, bend_radius=0.15, sections=10)


def cup():
    """A concave body of five plates that touch."""
    floor, side, front = (
        cl.box(size) for size in ((0.6, 0.6, 0.05), (0.05, 0.6, 0.6), (0.6, 0.05, 0.6))
    )
    places = [(floor, at(z=-0.3))]
    places += [(side, at(x)) for x in (0.3, -0.3)] + [(front, at(0.0, y)) for y in (0.3, -0.3)]
    return cl.Polyhedron.merged([plate.transformed(place) for plate, place in places])


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


@pytest.mark.parametrize(
    "layout", [np.asfortranarray, np.ndarray.tolist, np.float32, np.broadcast_to]
)
def test_poses_of_any_layout_are_taken(layout):
    query = cl.Query(cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5)))
    pose = layout(at(1.75)) if layout is not np.broadcast_to else np.broadcast_to(at(1.75), (4, 4))
    assert query.distance(pose).distance == 1.0
    assert query.distances(np.tile(pose, (2, 1, 1)), pose).distances.tolist() == [0.0, 0.0]


def off(row, column, value):
    """No pose, for one number."""
    bad = np.eye(4)
    bad[row, column] = value
    return bad


@pytest.mark.parametrize(
    ("fault", "bad"),
    [
        (NotFinite, off(0, 3, np.nan)), (BadPose, off(0, 0, 1.001)), (BadPose, off(3, 0, 1e-9)),
        (BadPose, off(2, 3, 1e200)), (BadPose, off(0, 1, 1e-5)), (BadShape, np.eye(3)), (BadShape, "pose"),
    ],
)  # fmt: skip
def test_what_is_no_pose_is_refused_and_forgotten(fault, bad):
    query, pose = cl.Query(cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5))), at(1.75)
    query.distance(pose)
    for asked in ((bad, pose), (pose, bad)):
        with pytest.raises(fault):
            query.distance(*asked)
    with pytest.raises(fault, match="worlds_from_b"):
        query.distances(pose, [pose, bad] if np.shape(bad) == (4, 4) else bad)
    assert query.distance(pose).distance == 1.0


def test_threads_that_share_a_query_or_a_pair_get_their_own_answers():
    a, b = bent_pipe(), cl.sphere(radius=0.3, tolerance=0.01)
    query, start = cl.Query(a, b), threading.Barrier(4)
    walks = [walk(np.random.default_rng(seed), 60, 0.05, 1.5) for seed in range(4)]
    alone = [[cl.distance(a, b, pose_a=pose) for pose in poses] for poses in walks]

    def ask(i):
        start.wait()
        for pose, single in zip(walks[i], alone[i], strict=True):
            assert_same(query.distance(pose), single)
            again = cl.distance(a, b, pose_a=pose)
            assert_same(again, single)
            assert again.tally == single.tally

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(ask, range(4)))


def test_a_solid_that_is_let_go_takes_its_arrays_along():
    a, b = cl.box((1.0, 1.0, 1.0)), cl.box((2.0, 1.0, 1.0))
    pair = cached_pair(a, b)
    assert cached_pair(a, b) is pair and cached_pair(b, a) is not pair
    gone, solid = weakref.ref(pair), weakref.ref(b)
    del b, pair
    gc.collect()
    assert solid() is None and gone() is None


FORKING = """
import os, sys, threading
import numpy as np
import clearance as cl
from tests.made_cases import at, ball

query = cl.Query(ball(1.0, 2), ball(0.5, 2))
poses = np.array([at(1.6 + 0.001 * (i % 200)) for i in range(2000)])
before = query.distances(None, poses[:200]).distances
stop = threading.Event()

def ask():
    while not stop.is_set():
        query.distances(None, poses)

asking = threading.Thread(target=ask, daemon=True)
asking.start()
while not query._lock.locked():
    pass
failed = 0
for _ in range(3):
    child = os.fork()
    if child == 0:
        same = (query.distances(None, poses[:200]).distances == before).all()
        os._exit(0 if same and query.distance(None, poses[0]).distance == before[0] else 1)
    failed += os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
stop.set()
asking.join()
sys.exit(failed)
"""


@pytest.mark.cold
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_child_asks_the_query_that_another_thread_was_asking():
    """The time limit only ends a child that hangs."""
    asked = [sys.executable, "-c", FORKING]
    done = subprocess.run(asked, timeout=300, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
