"""Prints whether programs of robots keep their promises, and what they cost.

    python scripts/bench/programs.py [--arms NAME ...] [--motions N] [--finer N] [--paths N] [--moves N]
        [--only PART ...] [--csv FILE]

Parts: `enclosure` (no joint is farther from its cubic than proven, by inverse kinematics of their own in long
doubles), `turning` (the same on a plate that turns meanwhile), `conveyor` (the same on a belt by a table of its
own), `peers` (poses at every step), `zones` (random admissible paths), `table` (the same motion as samples of 1
ms), `speed` (certified to 0.1 mm among obstacles; CPU time, the least of three, case loaded from its files).
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
import yaml
from harness import Row, least_time
from program_arms import LONG, ArmFile, OwnArm, arm_files
from program_corners import zones
from program_paths import TOOL, Belt, Motion, Plate, random_motions

import clearance as cl
from clearance.world.cubic import positions_along
from clearance.world.trajectory import Trajectory

SMALLEST = [
    "--arms", "heron6", "--motions", "1", "--finer", "11", "--paths", "6", "--moves", "10",
    "--only", "enclosure", "peers", "zones", "table",
]  # fmt: skip

AT_ONCE = 20
"""Intervals whose samples are solved together."""


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__, words, motions=40, finer=1001, paths=10_000, moves=100, arms=[], only=[*PARTS]
    )
    rows: list[Row] = []
    for name in asked.only:
        found = [{"part": name} | row for row in PARTS[name](asked)]
        harness.show(name, found)
        rows += found
    harness.write_csv(rows, asked.csv)
    return rows


def enclosure(asked, carriers=None) -> Iterator[Row]:
    """Of each arm: samples between samples at which a joint is farther off than proven, and how tight that is;
    with `carriers` for lines and arcs on what moves meanwhile.
    """
    for name, file in arm_files(asked.arms).items():
        yield enclosed(name, random_motions(file, asked.motions, carriers), asked)


def enclosed(name: str, motions: Iterator[Motion], asked) -> Row:
    """The figures of one arm."""
    ratios, n_samples, outside = [], 0, 0
    for motion in motions:
        proven = motion.trajectory.path_error
        off = deviations(motion, asked.finer)
        ratios.append(proven / off.max())
        n_samples, outside = n_samples + off.size, outside + int((off > proven).sum())
    return {
        "arm": name, "axes": len(motion.own.joints), "motions": len(ratios), "samples": n_samples,
        "outside": outside, "ratio_median": float(np.median(ratios)), "ratio_max": max(ratios),
    }  # fmt: skip


def deviations(motion: Motion, finer: int) -> np.ndarray:
    """(n,) [rad or m] of the joint that is farthest from its cubic, at `finer` times in each interval."""
    times, made = motion.trajectory.times.astype(LONG), motion.trajectory
    inside = (np.arange(finer, dtype=LONG) + LONG(0.5)) / finer
    found = []
    for first in range(0, len(times) - 1, AT_ONCE):
        rows = slice(first, min(first + AT_ONCE, len(times) - 1))
        length = np.diff(times)[rows]
        near = hermite(made, rows, length[:, None, None], inside[None, :, None])
        wanted = motion.poses(times[rows][:, None] + length[:, None] * inside)
        off = np.abs(motion.own.solved(wanted, near) - near).max(axis=2)
        found.append(off.astype(float).ravel())
    return np.concatenate(found)


def hermite(made: Trajectory, rows: slice, length: np.ndarray, s: np.ndarray) -> np.ndarray:
    """(m, n, k) joints on the cubics of some intervals, by Hermite's polynomials."""
    after = slice(rows.start + 1, rows.stop + 1)
    a, b = (made.positions[one][:, None].astype(LONG) for one in (rows, after))
    va, vb = (made.velocities[one][:, None] * length for one in (rows, after))
    r = 1 - s
    return a + s * s * (3 - 2 * s) * (b - a) + s * r * r * va - s * s * r * vb


def peers(asked) -> Iterator[Row]:
    """Of each arm: how far poses of other libraries at every step are from the path."""
    for name, file in arm_files(asked.arms).items():
        for library, pose_of in (("yourdfpy", yourdfpy_poses), ("pinocchio", pinocchio_poses)):
            ways, turns, steps = [0.0], [0.0], 0
            for motion in random_motions(file, min(asked.motions, 6)):
                found = pose_of(file, motion.trajectory)
                if found is None:
                    break
                times = motion.trajectory.times.astype(LONG)[:, None]
                wanted, found = motion.poses(times), found @ TOOL
                ways.append(float(np.abs(wanted.origin[:, 0] - found[:, :3, 3]).max()))
                turns.append(float(np.abs(wanted.turn[:, 0] - found[:, :3, :3]).max()))
                steps += len(times)
            if steps:
                yield {
                    "arm": name, "library": library, "steps": steps, "way_m": max(ways),
                    "turn_rad": max(turns),
                }  # fmt: skip


def yourdfpy_poses(file: ArmFile, made: Trajectory) -> np.ndarray | None:
    """(n, 4, 4) the link's pose at each sample, by yourdfpy; None where it is not installed."""
    try:
        import yourdfpy
    except ImportError:
        return None
    model = yourdfpy.URDF.load(str(file.path), load_meshes=False, build_collision_scene_graph=False)
    found = []
    for row in made.positions:
        model.update_cfg(dict(zip(made.joint_names, row, strict=True)))
        found.append(model.get_transform(file.link))
    return np.array(found)


def pinocchio_poses(file: ArmFile, made: Trajectory) -> np.ndarray | None:
    """(n, 4, 4) the same by pinocchio."""
    try:
        import pinocchio
    except ImportError:
        return None
    model = pinocchio.buildModelFromUrdf(str(file.path))
    data, frame, found = model.createData(), model.getFrameId(file.link), []
    places = [model.joints[model.getJointId(name)] for name in made.joint_names]
    for row in made.positions:
        q = pinocchio.neutral(model)
        for joint, value in zip(places, row, strict=True):
            q[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else (np.cos(value), np.sin(value))
            )
        pinocchio.framesForwardKinematics(model, data, q)
        found.append(data.oMf[frame].homogeneous.copy())
    return np.array(found)


def speed(asked) -> Iterator[Row]:
    """A program of lines of six axes among 50 boxes, stopping at each target and with zones at every other."""
    for zoned in (False, True):
        with tempfile.TemporaryDirectory() as folder:
            path = written(Path(folder), asked.moves, zoned)
            cl.check(path)  # warm
            seconds, run = least_time(lambda path=path: cl.check(path), 3)
            load, _ = least_time(lambda path=path: cl.load_case(path), 3)
        yield {
            "moves": asked.moves, "zones": len(run.record.case.robots[0].trajectory.corners),
            "steps": len(run.steps), "seconds": seconds, "of_these_program": load,
            "worst_mm": 1e3 * run.record.worst.clearance,
            "proven_mm": 1e3 * run.record.certificate.lower_bound.min(),
        }  # fmt: skip


def table(asked) -> Iterator[Row]:
    """The program without zones, and its joints as a table of 1 ms: what is proven of both, and what occurs."""
    with tempfile.TemporaryDirectory() as folder:
        case = cl.load_case(written(Path(folder), asked.moves, False))
    made = case.robots[0].trajectory
    times = np.append(np.arange(0.0, made.times[-1], 1e-3), made.times[-1])
    sampled = case.with_trajectory(
        times, positions_along(made, times), joint_names=made.joint_names
    )
    for name, one in (("program", case), ("table of 1 ms", sampled)):
        record = cl.check(one).record
        yield {
            "motion": name, "steps": record.motions[0].n_steps, "worst_mm": 1e3 * record.worst.clearance,
            "proven_mm": 1e3 * record.certificate.lower_bound.min(),
        }  # fmt: skip


def written(folder: Path, n_moves: int, zoned: bool) -> Path:
    """A case of our arm: lines between random targets, 50 boxes about them."""
    draw = np.random.default_rng(0)
    file = arm_files()["heron6"]
    own = OwnArm.read(file.path, file.link, np.eye(4))
    _, origin = own.poses(np.array([file.posture], dtype=LONG))
    start, moves = origin[0].astype(float), []
    for i in range(n_moves):
        to = {"frame": "base", "xyz": (start + draw.uniform(-1, 1, 3) * [0.1, 0.12, 0.1]).tolist()}
        zone = 0.01 if zoned and i % 2 == 0 and i + 1 < n_moves else 0.0
        moves.append({"lin": {"to": to, "zone": zone}})
    joints = dict(zip((joint.name for joint in own.joints), file.posture, strict=True))
    program = {"tool": {"link": file.link}, "start": joints, "moves": moves}
    scene = {"obstacles": [*boxes_about(start, draw)]}
    trajectory = {"program": program}
    content = {"robot": {"urdf": str(file.path)}, "trajectory": trajectory, "scene": scene}
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def boxes_about(start: np.ndarray, draw: np.random.Generator) -> Iterator[dict]:
    """50 boxes in reach, none within 0.35 m of where the tool begins nor over the base."""
    n = 0
    while n < 50:
        at = draw.uniform([-0.9, -0.9, 0.0], [0.9, 0.9, 1.2])
        if np.linalg.norm(at - start) > 0.35 and np.hypot(*at[:2]) > 0.45:
            size = draw.uniform(0.03, 0.15, 3).tolist()
            yield {"name": f"box_{n}", "box": {"size": size}, "pose": {"xyz": at.tolist()}}
            n += 1


PARTS = {
    "enclosure": enclosure,
    "turning": partial(enclosure, carriers=Plate),
    "conveyor": partial(enclosure, carriers=Belt),
    "peers": peers,
    "zones": zones,
    "table": table,
    "speed": speed,
}


if __name__ == "__main__":
    main()
