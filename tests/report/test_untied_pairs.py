"""Figures of pairs whose clocks are not tied say whether they are of the motion or of the samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.report.junit_cases import results_of
from tests.made_cases import at
from tests.profiles.moving import slab, turning
from tests.report.cells import box, sliding
from tests.report.made import page_of
from tests.report.test_cell import printed

BOUND = "is proven of all pairs"


@pytest.fixture(scope="module")
def passing():
    """Sliders b and c pass a between their samples, at other distances; `clock` says how they are tied."""

    def run(clock):
        ways = {
            "a": ([(0, 0), (2, 1)], 0),
            "b": ([(0, 3), (2, -2)], 1),
            "c": ([(0, 3), (2, -2)], 3),
        }
        robots = [sliding(name, way, at(y=y, z=0.5)) for name, (way, y) in ways.items()]
        return cl.check(cl.Case("passing", tuple(robots), (), clock=clock))

    return run


def test_pairs_of_two_clocks_are_told_as_of_samples_and_the_bound_of_all_pairs_beside_them(passing):
    run = passing(cl.Clock(np.inf))
    seen = {(one.group, one.name): one.text for one in results_of(run.report)}
    minima = run.report.session.motion_minima()
    assert any(one.between for one in minima) and not all(one.between for one in minima)
    for one in minima:
        text = seen[one.link, f"{one.link} - {one.obstacle}"]
        assert ("at the samples" in text) is not one.between
        assert "between the steps a pair may come nearer; at least" in text and BOUND in text
    page = page_of(run)
    assert "At the steps of both clocks, or between them where the proof saw a pair nearer" in page
    assert "Drawn is the least of each step of the first clock" in page and BOUND in page
    assert (
        '"sampled": true' in page and "every pair of times that this allows is measured" not in page
    )
    assert any("closest that was seen" in line for line in printed(run))


def test_pairs_of_one_clock_are_of_the_motion(passing):
    page = page_of(passing(cl.Clock()))
    assert "Over the motion" in page and "Drawn is the least" not in page and BOUND not in page
    assert '"sampled": false' in page


def test_a_far_pair_is_told_with_its_proven_bound():
    posts = [box(f"post {y}", (0.1, 0.1, 0.1), at(0.7, y)) for y in (-1.0, -1.5, 0.3)]
    case = turning(slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1]), [0.0, 0.5, 1.0])
    run = cl.check(replace(case, obstacles=tuple(posts)))
    texts = {one.name: one.text for one in results_of(run.report)}
    gap = run.record.certificate.gap
    minima = run.report.session.motion_minima()
    loose = {one.obstacle for one in minima if one.clearance - one.proven > gap}
    assert loose
    for one in minima:
        text = texts[f"{one.link} - {one.obstacle}"]
        assert text.endswith(" mm is proven") is (one.obstacle in loose)
    assert any("proven mm" in line for line in printed(run))
