"""The exact distances that the benchmark of run time against error is held against are those of the oracle."""

from __future__ import annotations

import csv
from itertools import islice

import numpy as np
import pytest

from scripts.makers.body_pairs import body_pairs
from scripts.makers.polygon_pairs import FAMILIES
from tests.golden import make_truths


def rows_of(name: str) -> list[list[str]]:
    with (make_truths.TRUTHS / f"{name}.csv").open(encoding="utf-8") as lines:
        return list(csv.reader(lines))


@pytest.mark.parametrize("name", FAMILIES)
def test_polygons_are_as_far_apart_as_the_file_says(name):
    told = {int(row[1]): row[2] for row in rows_of("polygons") if row[0] == name}
    pairs = FAMILIES[name](np.random.default_rng(make_truths.SEED), make_truths.N_POLYGONS)
    found = dict(
        enumerate(make_truths.polygon_truth(p, q) for p, q in islice(zip(*pairs, strict=True), 6))
    )
    assert len(told) == make_truths.N_POLYGONS and found == {i: told[i] for i in found}


@pytest.mark.slow  # the robots of two scenes
def test_bodies_are_as_far_apart_as_the_file_says():
    rows = rows_of("bodies")
    pairs = list(body_pairs(make_truths.N_POSES))
    assert [row[0] for row in rows] == [pair.family for pair in pairs]
    for i in (0, 1, 2, len(rows) - 2, len(rows) - 1):  # links of real arms take the oracle seconds
        pose = np.vstack([np.array(rows[i][3:], dtype=float).reshape(3, 4), [0, 0, 0, 1]])
        assert make_truths.body_truth(pairs[i], pose) == rows[i][2]
