"""Cases made to defeat every bound: the answers are still those of brute force and of FCL."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.crosscheck.triangles import triangle_soup
from clearance.simulate.measure import parts
from clearance.world.kinematics import link_poses
from tests.made_cases import WORST

SOME_STEPS = (0, 7, 23)


@pytest.fixture(scope="module", params=WORST)
def run(request):
    return cl.check(WORST[request.param](), need="pairs", certify=False)


def placed_bodies(run, step):
    """Shape and `world_from_body` of every link, and of every obstacle."""
    case = run.record.case
    (placed,) = case.robots
    poses = link_poses(placed, placed.trajectory.positions[step : step + 1])[0]
    names = placed.robot.link_names
    links = [(body.name, body.shape, poses[names.index(body.name)]) for body in placed.robot.bodies]
    return links, [(o.body.name, o.body.shape, o.world_from_body) for o in case.obstacles]


def pair_rows(run, step):
    rows = run.pairs.to_pydict()
    keys = zip(rows["step"], rows["link"], rows["obstacle"], rows["clearance"], strict=True)
    return {(link, obstacle): clearance for i, link, obstacle, clearance in keys if i == step}


def corners_in_world(bodies, wanted):
    """(n, 3, 3) the triangles of the body of that name."""
    ((shape, pose),) = [placed for name, *placed in bodies if name == wanted]
    return triangle_soup(shape).corners @ pose[:3, :3].T + pose[:3, 3]


@pytest.mark.peer
@pytest.mark.parametrize("step", SOME_STEPS)
def test_fcl_in_millimetres_says_the_same_of_every_pair(run, step):
    fcl = pytest.importorskip("fcl")

    def in_millimetres(shape, pose):
        soup = triangle_soup(shape)
        model = fcl.BVHModel()
        model.beginModel(len(soup.vertices), len(soup.triangles))
        model.addSubModel(soup.vertices * 1e3, soup.triangles)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform(pose[:3, :3], pose[:3, 3] * 1e3))

    links, obstacles = placed_bodies(run, step)
    theirs = [in_millimetres(shape, pose) for _, shape, pose in obstacles]
    found = pair_rows(run, step)
    for name, shape, pose in links:
        ours = in_millimetres(shape, pose)
        for (obstacle, *_), other in zip(obstacles, theirs, strict=True):
            said = fcl.distance(ours, other, fcl.DistanceRequest(), fcl.DistanceResult()) * 1e-3
            assert found[name, obstacle] == pytest.approx(max(0.0, said), abs=1e-9)


def test_brute_force_over_all_polygons_says_the_same(run):
    """Every polygon of the nearest pair against every other, without trees and bounds."""
    step = SOME_STEPS[1]
    links, obstacles = placed_bodies(run, step)
    (nearest, least) = min(pair_rows(run, step).items(), key=lambda entry: entry[1])
    a, b = (
        corners_in_world(side, name) for name, side in zip(nearest, (links, obstacles), strict=True)
    )
    rows, columns = np.divmod(np.arange(len(a) * len(b)), len(b))
    brute = cl.polygon_distances(a[rows], b[columns]).min()
    assert least == pytest.approx(brute, abs=1e-14)


@pytest.mark.parametrize("need", ["steps", "limit", "minimum"])
def test_needs_and_threads_agree(run, need, monkeypatch):
    monkeypatch.setattr(parts, "LONGEST_PART", 3)
    monkeypatch.setattr(parts, "SPARSE", 1)
    truth = run.steps["clearance"].to_numpy()
    limit = float(np.median(truth))
    case = replace(run.record.case, limits=cl.Limits(0.0, limit))
    found = cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=2)).steps
    clearances = found["clearance"].to_numpy()
    known = ~np.isnan(clearances)
    must_know = {
        "steps": truth >= 0.0,
        "limit": truth < limit,
        "minimum": np.arange(len(truth)) == truth.argmin(),
    }
    assert known[must_know[need]].all()
    assert (clearances[known] == truth[known]).all()
    if need != "steps":
        assert (found["lower_bound"].to_numpy() <= truth).all()
