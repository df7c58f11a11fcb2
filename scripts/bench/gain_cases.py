"""Violated cases that are known to be feasible: each has a change that is proven to keep its limits.

Bent, pushed: a case that keeps its limits, its path bent by smooth offsets, or a base or an obstacle pushed 1 to
50 mm too far towards what is near; the change that takes it back is known. Raised: the fail limit of a case is set
between its least clearance and that of a change of it. Not for: solving them (`gain`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from harness import SCENES, SHARED

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.joint_ranges import require_within_limits
from clearance.gains.offsets import JointOffsets, joint_offsets
from clearance.gains.path_change import PathChange
from clearance.gains.shift import Shift, base_shift, obstacle_shift
from clearance.record.record import PairMinimum
from clearance.world.case import Case, Limits, index_of_robot

OURS = (
    "iiwa_pipe_rack",
    "hot_cell",
    "box_box",
    "box_pipe",
    "dual_arm_handover",
    "turntable_cell",
    "door_and_arm",
)

KINDS = ("waypoints", "obstacle", "base")

HOW = ("taken back", "taken back", "raised")
"""How often a case is bent or pushed, and how often its limit is raised."""

LEFT = 0.6
"""[-] Of what is proven of a case, what its fail limit is set to: the case as it is keeps it."""

LEAST = 1e-5
"""[m] A case of which less is proven is none."""

SHORT = (0.001, 0.05)
"""[m] How far the worst is pushed below the fail limit."""

NEAR = 0.3
"""[m] What is pushed towards is no farther, and nothing is pushed farther."""

BENDS = 8
"""Intervals of the splines that a path is bent by; not those that it is mended with."""

MOST_BEND, ARM = 0.5, 0.5
"""[rad] how far a path is bent at most; [m] about what a radian of it moves."""

TRIED = 6
"""Changes of which the one that clears most is taken, where a limit is raised."""

OPENED = (0.2, 0.8)
"""[-] Of the way from the least clearance to that of the change, where a raised limit lies."""


Perturbation = JointOffsets | Shift


@dataclass(frozen=True, eq=False)
class Source:
    """A case that keeps its fail limit."""

    name: str
    case: Case


@dataclass(frozen=True, eq=False)
class ViolatedCase:
    """A violated case.

    Attributes:
        how: one of `HOW`. kind, who: what may be changed to mend it. known: the size of a change that does.
    """

    source: str
    how: str
    case: Case
    kind: str
    who: str
    known: float


def sources(names: Sequence[str] = ()) -> Iterator[Source]:
    """Our scenes and the real cases of some names, or all; limits are a little below what is proven of them."""
    folders = [SCENES / name for name in OURS] + sorted(SHARED.glob("*/"))
    for folder in folders:
        if not (folder / "case.yaml").exists() or (names and folder.name not in names):
            continue
        case = replace(cl.load_case(folder / "case.yaml"), limits=Limits())
        least = _proven(case)
        if least > LEAST:
            limited = replace(case, limits=Limits(fail=LEFT * least))
            yield Source(folder.name, limited)


def violated_cases(
    n_cases: int, seed: int = 0, names: Sequence[str] = ()
) -> Iterator[ViolatedCase]:
    """So many cases, of each source of some names, or of all, each kind and way as many as can be."""
    rng, kept = np.random.default_rng(seed), [*sources(names)]
    n_made = 0
    for i in range(20 * n_cases):
        source, kind = kept[i % len(kept)], KINDS[(i // len(kept)) % len(KINDS)]
        how = HOW[(i // len(kept) // len(KINDS)) % len(HOW)]
        one = (_raised if how == "raised" else _taken_back)(source, kind, rng)
        if one is not None:
            yield one
            n_made += 1
        if n_made == n_cases:
            return


def _proven(case: Case) -> float:
    """[m] What no clearance of a case is below at any time."""
    return float(cl.check(case, contact="none").certificate.lower_bound.min())


def _above(case: Case) -> float:
    """[m] The least clearance of the steps."""
    run = cl.check(case, certify=False, contact="none", need="minimum")
    return float(run.record.worst.clearance)


def _taken_back(source: Source, kind: str, rng: np.random.Generator) -> ViolatedCase | None:
    """A case that is changed until it is violated."""
    case = source.case
    if kind == "waypoints":
        offsets = _offsets(case, rng)
        return offsets and _bent(source, offsets, _bend_of_one(offsets, rng), rng)
    found = _near_pair(case, kind, rng)
    if found is None:
        return None
    shift, who, near = found
    way = np.subtract(near.point_link, near.point_obstacle)
    way = way / np.linalg.norm(way) + 0.3 * rng.normal(size=3)
    for sign in (1.0, -1.0):
        x = _until_short(shift, sign * way / np.linalg.norm(way), NEAR, 1.0, rng)
        if x is not None:
            return ViolatedCase(source.name, HOW[0], _case_of(shift, x), kind, who, shift.size(x))
    return None


def _bent(
    source: Source, offsets: JointOffsets, way: np.ndarray, rng: np.random.Generator
) -> ViolatedCase | None:
    """A case whose path is bent along a way until it is violated; None where it is beyond joint limits then."""
    x = _until_short(offsets, way, MOST_BEND, ARM, rng)
    if x is None or not _within_limits(offsets, x):
        return None
    who = offsets.placed.robot.name
    return ViolatedCase(
        source.name, HOW[0], _case_of(offsets, x), "waypoints", who, offsets.size(x)
    )


def _raised(source: Source, kind: str, rng: np.random.Generator) -> ViolatedCase | None:
    """A case whose limit is between what it comes to and what a change of it is proven to come to."""
    case = source.case
    if kind == "waypoints":
        change: Perturbation | None = _offsets(case, rng)
        who = "" if change is None else change.placed.robot.name
        ways = [] if change is None else [_random_bend(change, rng) for _ in range(TRIED)]
        ways = [way for way in ways if _within_limits(change, way)]
    else:
        found = _near_pair(case, kind, rng)
        if found is None:
            return None
        change, who, _ = found
        ways = [_random_shift(rng) for _ in range(TRIED)]
    if not ways:
        return None
    best = max(ways, key=lambda x: _above(_case_of(change, x)))
    low, high = _above(case), _proven(_case_of(change, best))
    if high < low + 1e-4:
        return None
    fail = low + float(rng.uniform(*OPENED)) * (high - low)
    violated = replace(case, limits=Limits(fail=fail))
    return ViolatedCase(source.name, HOW[-1], violated, kind, who, change.size(best))


def _near_pair(
    case: Case, kind: str, rng: np.random.Generator
) -> tuple[Shift, str, PairMinimum] | None:
    """What can be shifted, and the pair of it that it is pushed into."""
    minima = cl.check(case, certify=False, contact="none").pair_minima
    near = [one for one in minima if 0.0 < one.clearance < NEAR]
    if kind == "base":
        who = str(rng.choice([one.robot.name for one in case.robots if one.mount is None]))
        way = base_shift(case, index_of_robot(case.robots, who))
        return (way, who, near[int(rng.integers(len(near)))]) if near else None
    carried = {carry.part for carry in case.carries}
    free = {one.name for one in case.obstacles if one.mount is None and one.name not in carried}
    links = {name for name in (one.link for one in near) if name not in free}
    near = [one for one in near if one.obstacle in free and one.link in links]
    if not near:
        return None
    pair = near[int(rng.integers(len(near)))]
    return obstacle_shift(case, pair.obstacle), pair.obstacle, pair


def _offsets(case: Case, rng: np.random.Generator) -> JointOffsets | None:
    moving = [
        one.robot.name for one in case.robots if one.trajectory and one.trajectory.n_steps > 2
    ]
    if not moving:
        return None
    i_robot = index_of_robot(case.robots, str(rng.choice(moving)))
    times = case.robots[i_robot].given_trajectory.times
    ends = (times[0], times[0]), (times[-1], times[-1])
    return joint_offsets(case, i_robot, BENDS, ends)


def _random_shift(rng: np.random.Generator) -> np.ndarray:
    way = rng.normal(size=3)
    return np.asarray(rng.uniform(*SHORT) * way / np.linalg.norm(way))


def _random_bend(offsets: JointOffsets, rng: np.random.Generator) -> np.ndarray:
    way = _bend_of_one(offsets, rng)
    return np.asarray(rng.uniform(0.02, 0.2) * way)


def _bend_of_one(offsets: JointOffsets, rng: np.random.Generator) -> np.ndarray:
    """Random offsets of size 1."""
    weights = np.repeat(offsets.weights, offsets.n_splines)
    way = rng.normal(size=len(weights)) / weights
    return np.asarray(way / offsets.size(way))


def _case_of(change: Perturbation, x: np.ndarray) -> Case:
    """The case after a change."""
    return (PathChange((change,)) if isinstance(change, JointOffsets) else change).case_of(x)


def _until_short(
    change: Perturbation, way: np.ndarray, most: float, lever: float, rng: np.random.Generator
) -> np.ndarray | None:
    """A change along a way by which the worst falls short by about a chosen length; None if it never does.

    Args:
        way: a change of size 1. most: no change is larger. lever: [m] about what a unit of it moves.
    """
    fail = change.case.limits.fail
    low, high = 0.0, most / 16.0
    while _above(_case_of(change, high * way)) >= fail:
        low, high = high, 2.0 * high
        if high > most:
            return None
    for _ in range(4):
        middle = 0.5 * (low + high)
        below = _above(_case_of(change, middle * way)) < fail
        low, high = (low, middle) if below else (middle, high)
    x = (high + rng.uniform(*SHORT) / lever) * way
    return x if _above(_case_of(change, x)) < fail else None


def _within_limits(offsets: JointOffsets, x: np.ndarray) -> bool:
    try:
        require_within_limits(offsets.placed_of(x))
    except BadInput:
        return False
    return True
