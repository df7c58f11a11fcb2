"""A robot inside a solid with a fault is in contact or suspect, never quietly clear; sheets make no noise."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.simulate.measure import inside
from clearance.simulate.measure.sections import section_plan
from clearance.world.notice import Severity
from tests.made_cases import at, ball, faces_of, flying

BALL = ball(2.0, 2)
LINK = cl.box((0.05, 0.05, 0.05))


def moved(shape: Polyhedron, positions: np.ndarray, outer: Polyhedron, **options) -> cl.Run:
    steps = np.zeros((len(positions), 6))
    steps[:, :3] = positions
    return cl.check(flying("inside", shape, [(outer, np.eye(4))], steps), **options)


WAY = np.linspace((-0.3, 0.1, 0.0), (0.3, 0.1, 0.2), 30)


@pytest.mark.parametrize("need", ["steps", "pairs", "limit", "minimum"])
@pytest.mark.parametrize("fault", ["twice", "missing", "turned"])
def test_a_robot_wholly_inside_is_in_contact_whatever_is_asked(fault: str, need: str) -> None:
    faces = faces_of(BALL)
    faces = {
        "twice": [*faces, faces[9]],
        "missing": faces[1:],
        "turned": [faces[0][::-1], *faces[1:]],
    }[fault]
    run = moved(LINK, WAY, Polyhedron(BALL.vertices, faces), need=need)
    assert run.status == "contact" and not run.passed and run.worst["clearance"] == 0.0
    assert run.record.notices == ()


@pytest.mark.parametrize("at_once", [inside.AT_ONCE, 8])
def test_where_the_hole_decides_the_pair_is_suspect_by_name_and_first_step(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inside, "AT_ONCE", at_once)
    there = np.array([5.0, 0.0, 0.0])
    outer = Polyhedron(BALL.vertices + there, faces_of(BALL)[1:])
    middle = BALL.face(0).mean(axis=0)
    run = moved(LINK, np.linspace(3.0, 1.0, 21)[:, None] * middle + there, outer)
    (notice,) = run.record.notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "inside")
    assert notice.text.startswith(
        "link l6 may be inside obstacle o0, or round it, at 0.200 s (step 20)"
    )
    quiet = moved(LINK, np.linspace(3.0, 1.5, 21)[:, None] * middle + there, outer)
    assert quiet.record.notices == ()


def test_larger_holes_make_it_suspect_and_sheets_do_not() -> None:
    faces = faces_of(BALL)
    (notice,) = moved(LINK, WAY, Polyhedron(BALL.vertices, faces[12:])).record.notices
    assert "step 0" in notice.text
    for shape in (Polyhedron(BALL.vertices, faces[100:]), Polyhedron(BALL.vertices, faces[:100])):
        assert moved(LINK, WAY, shape).record.notices == ()


def test_steps_in_contact_are_not_in_doubt() -> None:
    """A link that reaches through the surface itself is in contact there, which is known."""
    outer = Polyhedron(BALL.vertices, faces_of(BALL)[1:])
    rod = cl.box((0.05, 0.05, 5.0))
    case = flying("through", rod, [(outer, at())], np.zeros((3, 6)))
    run = cl.check(case)
    assert run.status == "contact"
    assert inside.notices(section_plan(run.record.timeline)) == ()


def apart(shape: Polyhedron, scatter: float) -> Polyhedron:
    """Each face with corners of its own, moved by up to `scatter` [m]."""
    faces = faces_of(shape)
    corners = shape.vertices[np.concatenate(faces)]
    corners = corners + np.random.default_rng(3).uniform(-scatter, scatter, corners.shape)
    ends = np.cumsum([len(face) for face in faces])
    return Polyhedron(
        corners, [list(range(e - len(f), e)) for e, f in zip(ends, faces, strict=True)]
    )


def halves(scale: float) -> Polyhedron:
    """A ball of two halves, one larger by a little, so that no two of their corners are the same."""
    faces = np.array(faces_of(BALL))
    up = BALL.vertices[faces].mean(axis=1)[:, 2] > 0.0
    lower = Polyhedron(np.nextafter(BALL.vertices, 9.0) * scale, faces[~up])
    return Polyhedron.merged([Polyhedron(BALL.vertices, faces[up]), lower])


def with_t_junctions() -> Polyhedron:
    """A cube whose walls are cut at other places than their neighbours."""
    corners, faces = [], []
    for axis in range(3):
        for side in (-2.0, 2.0):
            cuts = np.linspace(-2.0, 2.0, 2 + axis + (side > 0.0))
            for low, high in zip(cuts, cuts[1:], strict=False):
                wall = np.array(
                    [[side, low, -2], [side, high, -2], [side, high, 2], [side, low, 2]]
                )
                faces.append(
                    list(range(len(corners), len(corners) + 4))[:: 1 if side > 0.0 else -1]
                )
                corners += np.roll(wall, axis, axis=1).tolist()
    return Polyhedron(np.array(corners), faces)


def two_sided(shape: Polyhedron) -> Polyhedron:
    return Polyhedron(shape.vertices, [*faces_of(shape), *(face[::-1] for face in faces_of(shape))])


CRACKED = {
    "halves an ulp apart": halves(1.0),
    "halves a micrometre apart": halves(1.0 + 1e-6),
    "each face apart": apart(BALL, 1e-6),
    "each face apart by far": apart(BALL, 1e-4),
    "T-junctions": with_t_junctions(),
    "two-sided": two_sided(BALL),
    "two-sided, each face apart": two_sided(apart(BALL, 1e-6)),
    "two-sided box": two_sided(cl.box((4.0, 4.0, 4.0))),
}


@pytest.mark.parametrize("need", ["steps", "minimum"])
@pytest.mark.parametrize("kind", CRACKED)
def test_a_solid_with_cracks_or_two_sides_is_suspect_round_a_robot_and_inside_one(
    kind: str, need: str
) -> None:
    run = moved(LINK, WAY, CRACKED[kind], need=need)
    assert run.status == "suspect" and not run.passed
    assert [(notice.severity, notice.kind) for notice in run.record.notices] == [
        (Severity.SUSPECT, "inside")
    ]
    assert moved(CRACKED[kind], WAY, LINK).status == "suspect"
    assert moved(LINK, WAY + [9.0, 0.0, 0.0], CRACKED[kind]).record.notices == ()


def test_a_robot_that_is_inside_only_on_its_way_through_coarse_steps_is_suspect() -> None:
    """Steps so long that it is never in the wall: outside in the bounds' corners first and last."""
    way = np.linspace((-1.9, -1.9, -1.9), (1.9, 1.9, 1.9), 7)
    run = moved(LINK, way, CRACKED["halves an ulp apart"])
    assert run.record.notices and "step 2" in run.record.notices[0].text


def test_bowls_bins_and_tubes_round_a_robot_are_quiet() -> None:
    """In the middle of a tube three times as long as wide, its ends are seen under 5 % of all directions."""
    faces = faces_of(BALL)
    bowl = Polyhedron(BALL.vertices, [f for f in faces if BALL.vertices[f].mean(axis=0)[2] < 0.0])
    cube = cl.box((4.0, 4.0, 4.0))
    up = cube.vertices[:, 2].max()
    bin_ = Polyhedron(
        cube.vertices, [f for f in faces_of(cube) if (cube.vertices[f][:, 2] < up).any()]
    )
    turns = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    ends = np.concatenate([np.insert(0.8 * ring, 2, z, axis=1) for z in (-2.4, 2.4)])
    tube = Polyhedron(ends, [[i, (i + 1) % 32, 32 + (i + 1) % 32, 32 + i] for i in range(32)])
    deep = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, -1.6), 9)
    for shape in (bowl, bin_, two_sided(bowl), two_sided(bin_)):
        assert moved(LINK, deep, shape).record.notices == ()
    far = moved(LINK, 0.0 * deep, tube).record.notices  # the tube's wall is 15 times the reach away
    assert [one.kind for one in far] == ["units"]
