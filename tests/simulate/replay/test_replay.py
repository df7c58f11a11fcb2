"""The replay keeps what must not be lost, and comes back from its file as it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.replay.replay import frame_steps
from clearance.world.rules import Rule, Waiver
from tests.findings.gates import load_gates
from tests.report.made import replay_of, run_of
from tests.report.records import record


def test_a_short_run_is_kept_whole():
    replay = replay_of(record())
    assert replay.steps.tolist() == list(range(240))
    assert replay.clearances.tolist() == record().clearances.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("max_frames", [30, 50, 333])
def test_a_long_run_keeps_the_least_of_every_stretch(max_frames):
    run = record(n_steps=1200)
    kept = frame_steps(run_of(run).session, max_frames, run.worst)
    assert len(kept) <= max_frames
    assert (np.diff(kept) > 0).all()
    assert {0, 1199, run.worst_step, *(minimum.step for minimum in run_of(run).pair_minima)} <= set(
        kept
    )
    stretch = 2 * 1200 // (max_frames - 12) + 2
    for start in range(0, 1200, 7):
        window = slice(max(0, start - stretch), start + 2 * stretch)
        near = kept[(kept >= window.start) & (kept < window.stop)]
        assert run.clearances[near].min() <= run.clearances[start : start + stretch].min()


def test_poses_put_the_shapes_where_kinematics_puts_them():
    from scipy.spatial.transform import Rotation

    run = record()
    replay = replay_of(run)
    expected = run.motions[0].poses()
    for i, body in enumerate(run.case.robots[0].robot.bodies):
        poses = np.broadcast_to(replay.poses[i], (240, 7)).astype(float)
        vertices = replay.shapes[replay.bodies[i].i_shape][0].astype(float)
        drawn = Rotation.from_quat(poses[:, 3:]).as_matrix() @ vertices.T + poses[:, :3, None]
        true = expected[:, i, :3, :3] @ body.shape.vertices.T + expected[:, i, :3, 3, None]
        assert np.abs(drawn - true).max() < 1e-6
    assert replay.poses[0].shape == (1, 7), "the base stands still"


@pytest.mark.parametrize("by", ["waiver", "rule"])
def test_the_curve_has_the_most_critical_pair_at_each_time_also_where_another_decides(by, tmp_path):
    """A pair that is waived, or has another limit, is 1 mm nearer when the one that decides is at its nearest."""
    case = load_gates(tmp_path, {"gate_a": (0.12, 0.003), "gate_b": (0.3, 0.004)})
    leaving = {
        "joint_names": ["slide_x", "slide_y"]
    }  # so that each gate is nearest where it begins
    case = case.with_trajectory([0.0, 2.0], [[-1.0, 0.001], [1.0, 0.0]], **leaving)
    waiver = Waiver(("box", "gate_a"), at_least=0.002, reason="known", by="J. Doe")
    rule = Rule(("box", "gate_b"), name="far", fail=0.0065)
    changes = (
        {"waivers": (waiver,)} if by == "waiver" else {"limits": cl.Limits(0.005, rules=(rule,))}
    )
    run = cl.check(replace(case, **changes))
    drawn = run.replay()
    x, y = drawn.times - 1.0, 0.001 - drawn.times / 2000
    gaps = [
        np.hypot(np.maximum(0.0, abs(x - at) - 0.15), gap - y)
        for at, gap in ((0.12, 0.003), (0.3, 0.004))
    ]
    limits = (0.005, 0.005 if by == "waiver" else 0.0065)
    margins = [gap - limit for gap, limit in zip(gaps, limits, strict=True)]
    critical = np.where(margins[0] <= margins[1], *gaps)
    assert np.any(drawn.between) and drawn.clearances == pytest.approx(critical, abs=1e-9)
    assert run.worst["obstacle"] == "gate_b"
    assert abs(drawn.times - run.worst["time"]).min() < 1e-12
