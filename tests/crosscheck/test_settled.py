"""Where the peer is wrong, exact arithmetic says so; where we are, nothing does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clearance import Polyhedron, check
from clearance.crosscheck import compare, peer_run
from clearance.crosscheck.exact import placed, triangles_sq
from clearance.crosscheck.fcl_adapter import PeerBody
from clearance.crosscheck.triangles import triangle_soup
from tests import oracle
from tests.crosscheck.sliding import cross_check, pairs_of
from tests.made_cases import at, ball, dented, flying
from tests.strategies import FAMILIES, rotations

pytestmark = pytest.mark.peer


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_triangles_are_as_far_apart_as_the_oracle_says(name: str) -> None:
    for p, q in zip(*FAMILIES[name](np.random.default_rng(5), 6), strict=True):
        given = [placed(np.asarray(x, dtype=float)[:3], np.eye(4)) for x in (p, q)]
        assert triangles_sq(*given) == oracle.polygon_distance_sq(p[:3], q[:3])


def test_the_triangles_that_fcl_names_are_as_near_as_it_says() -> None:
    random = np.random.default_rng(6)
    a, b = triangle_soup(dented(random, 2)), triangle_soup(ball(0.4, 2))
    one, two = PeerBody(a), PeerBody(b)
    for turn in rotations(random, 20):
        pose = at(*random.normal(scale=2.0, size=3), turned=turn)
        one.place(np.eye(4)), two.place(pose)
        i, j = one.nearest_triangles(two)
        exact = triangles_sq(placed(a.corners[i], np.eye(4)), placed(b.corners[j], pose))
        assert float(oracle.root(exact)) == pytest.approx(one.distance(two), abs=1e-12)


NEEDLE = Polyhedron(np.array([(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0)], dtype=float), [(0, 1, 2)])


def passing(shape: Polyhedron = NEEDLE):
    positions = np.zeros((4, 6))
    positions[:, 2] = [0.5, 0.3, 0.2, 0.4]
    return check(flying("passing", shape, [(ball(0.1, 1), at(0.5))], positions))


@pytest.mark.parametrize("error", [1e-3, -1e-3])
def test_a_wrong_answer_of_the_peer_is_settled_and_counted(error: float, monkeypatch) -> None:
    """FCL with an error put into its answers: too far, our faces refute it; too near, those it names."""
    measured = peer_run.PeerRun.measure

    def wrong(self, progress=None):
        answers = measured(self, progress)
        return replace(answers, clearances=answers.clearances + [0.0, error, 0.0, 2.0 * error])

    monkeypatch.setattr(peer_run.PeerRun, "measure", wrong)
    found = cross_check(passing().record)
    assert found.agrees and found.n_settled == 2
    assert found.greatest_settled == pytest.approx(2e-3, rel=1e-6) == found.greatest_difference


@pytest.mark.parametrize("error", [1e-3, -1e-3])
def test_a_wrong_answer_of_ours_is_never_settled(error: float) -> None:
    run = passing(ball(0.2, 1))
    wrong = run.record.clearances + [0.0, error, 0.0, 0.0]
    record = replace(run.record, table=run.record.rows.with_columns({"clearance": wrong}))
    found = cross_check(record)
    assert [row.step for row in found.disagreements] == [1] and found.n_settled == 0


def test_a_nearer_pair_that_we_passed_over_is_never_settled() -> None:
    """Our answer is that of two faces that are there, our points are on them, and another pair is nearer."""
    positions = np.zeros((2, 6))
    case = flying(
        "two", ball(0.2, 1), [(ball(0.1, 1), at(1.0)), (ball(0.1, 1), at(0.0, 0.0, 0.8))], positions
    )
    far = check(replace(case, obstacles=case.obstacles[:1]))
    found = cross_check(replace(far.record, case=case))
    assert len(found.disagreements) == 2 and found.n_settled == 0


def needle(random: np.random.Generator, width: float) -> Polyhedron:
    corners = np.array(
        [(0, 0, 0), (1, 0, 0), (random.uniform(0.2, 0.8), width, 0), (0.5, 0, width)]
    )
    return Polyhedron(
        corners @ rotations(random, 1)[0].T, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    )


def test_points_on_needles_are_on_them() -> None:
    """In float64 their heights are off by 4e-9 m at some poses; no step disagrees for that."""
    random = np.random.default_rng(0)
    in_floats = []
    for _ in range(40):
        width = 10.0 ** random.uniform(-10, -8)
        link, obstacle = needle(random, width), needle(random, width)
        positions = np.concatenate(
            [random.normal(scale=0.7, size=(3, 3)), random.uniform(-3, 3, (3, 3))], axis=1
        )
        case = flying("needles", link, [(obstacle, np.eye(4))], positions)
        record = check(case, certify=False).record
        found = cross_check(record)
        assert found.agrees and found.worst_witness_error <= found.tolerance
        in_floats.append(
            compare._Witnesses(peer_run.PeerRun(record, pairs_of(record))).errors().max()
            > found.tolerance
        )
    assert sum(in_floats) >= 1


def test_it_gives_up_where_nothing_is_settled(monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(compare, "GIVE_UP", 2)
    monkeypatch.setattr(compare._Witnesses, "refute", lambda *args: asked.append(args) or False)
    run = passing(ball(0.2, 1))
    rows = run.record.rows
    off = {name: rows.numbers(name) + 1e-3 for name in ("clearance", "link_z")}
    found = cross_check(replace(run.record, table=rows.with_columns(off)))
    assert len(found.disagreements) == 4 and len(asked) <= 2
