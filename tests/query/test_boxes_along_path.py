"""Steps at which boxes may overlap: none is left out at which they are not beside each other by far."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from clearance.kernels.motion.boxes_along_path import ROUNDING, CarriedBoxes, steps_together

N_STEPS = 40


def way(rng: np.random.Generator, pace: float, turn: float) -> np.ndarray:
    """(n, 4, 4) a body that wanders and turns."""
    poses = np.tile(np.eye(4), (N_STEPS, 1, 1))
    turns = np.cumsum(turn * rng.standard_normal((N_STEPS, 3)), axis=0)
    poses[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    poses[:, :3, 3] = 3.0 * rng.standard_normal(3) + np.cumsum(
        pace * rng.standard_normal((N_STEPS, 3)), axis=0
    )
    return poses


def gaps_along_axes(bounds: np.ndarray, other: np.ndarray, m: np.ndarray) -> np.ndarray:
    """(n,) [m] how far a box that is seen by `m` (n, 4, 4) is from the first along that one's axes."""
    half, half_of_other = (bounds[1] - bounds[0]) / 2, (other[1] - other[0]) / 2
    away = m[:, :3, :3] @ other.mean(axis=0) + m[:, :3, 3] - bounds.mean(axis=0)
    return (np.abs(away) - half - np.abs(m[:, :3, :3]) @ half_of_other).max(axis=1)


def gaps_of_balls(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n,) [m] how far the balls round two boxes (2, 2, 3) are from each other, at poses (n, 2, 4, 4)."""
    middles = [poses[:, i, :3, :3] @ bounds[i].mean(axis=0) + poses[:, i, :3, 3] for i in (0, 1)]
    radii = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1) / 2
    return np.linalg.norm(middles[0] - middles[1], axis=1) - radii.sum()


def gaps_along_centres(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n,) [m] how far two boxes are from each other along the line of their middles."""
    middles = [poses[:, i, :3, :3] @ bounds[i].mean(axis=0) + poses[:, i, :3, 3] for i in (0, 1)]
    away = middles[1] - middles[0]
    length = np.linalg.norm(away, axis=1)
    along = away / length[:, None]
    seen = [np.einsum("nij,ni->nj", poses[:, i, :3, :3], along) for i in (0, 1)]
    reach = [np.abs(seen[i]) @ (bounds[i, 1] - bounds[i, 0]) / 2 for i in (0, 1)]
    return length - reach[0] - reach[1]


PACES = st.sampled_from([0.0, 1e-4, 0.01, 0.1, 0.5, 2.0])


@settings(max_examples=200)
@given(st.integers(0, 10**6), PACES, PACES, st.sampled_from([0.1, 1.0, 10.0]), st.booleans())
def test_where_boxes_are_omitted_they_are_beside_each_other_and_else_never(
    seed: int, pace: float, turn: float, slow: float, stands: bool
) -> None:
    rng = np.random.default_rng(seed)
    bounds = np.sort(rng.normal(0.0, 1.0, (2, 2, 3)), axis=1) * rng.lognormal(0.0, 1.0, (2, 1, 3))
    poses = np.stack([way(rng, pace, turn), way(rng, pace * slow, turn * slow)], axis=1)
    links = np.array([0, -1 if stands else 1])
    standing = np.stack([np.eye(4), poses[0, 1]])
    if stands:
        poses[:, 1] = poses[0, 1]
    spans = np.empty((1, 2), dtype=np.int64)
    boxes = CarriedBoxes(bounds, links, standing)
    steps_together(boxes, np.array([[0, 1]]), np.ascontiguousarray(poses[:, : 2 - stands]), spans)
    seen = np.linalg.inv(poses[:, 0]) @ poses[:, 1]
    apart = np.max(
        [
            gaps_along_axes(bounds[0], bounds[1], seen),
            gaps_along_axes(bounds[1], bounds[0], np.linalg.inv(seen)),
            gaps_along_centres(bounds, poses),
            gaps_of_balls(bounds, poses),
        ],
        axis=0,
    )
    first, end = spans[0]
    omitted = np.ones(N_STEPS, dtype=bool)
    omitted[first:end] = False
    assert (apart[omitted] > 0.0).all()
    largest = np.abs(poses[:, :, :3, 3]).sum() + np.abs(bounds).sum()
    if first < end:
        assert apart[[first, end - 1]].max() <= 2.0 * ROUNDING * largest


@pytest.mark.parametrize("far", [1.0, -1.0])
def test_a_box_that_flies_by_is_met_only_where_it_is_near(far: float) -> None:
    poses = np.tile(np.eye(4), (21, 1, 1, 1))
    poses[:, 0, 0, 3] = np.linspace(-5.0, 5.0, 21)
    cube = np.array([[-0.5] * 3, [0.5] * 3])
    beside = np.eye(4)
    beside[1, 3] = 1.1 * far
    standing = np.stack([np.eye(4), np.eye(4), beside])
    boxes = CarriedBoxes(np.stack([cube] * 3), np.array([0, -1, -1]), standing)
    spans = np.empty((3, 2), dtype=np.int64)
    steps_together(boxes, np.array([[0, 1], [1, 0], [0, 2]]), poses, spans)
    assert spans.tolist() == [[8, 13], [8, 13], [0, 0]]
