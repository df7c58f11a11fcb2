"""Violated cases that are known to be feasible: a case that keeps its limits, changed by what can be taken back.

A path is bent by smooth offsets, a base or an obstacle is pushed towards what is nearest, until less than the fail
limit is left, by 1 to 50 mm. Taken back, the limits are kept again. Not for: solving them (`gain`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from inputs import ROOT

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.joint_ranges import require_within_limits
from clearance.gains.offsets import joint_offsets
from clearance.gains.shift import Shift, base_shift, obstacle_shift
from clearance.world.case import Case, Limits

OURS = (
    "iiwa_pipe_rack",
    "hot_cell",
    "box_box",
    "dual_arm_handover",
    "turntable_cell",
    "door_and_arm",
)
SHARED = (
    "fetch_cage_planned",
    "kuka_iiwa_valve_wall",
    "lbr_puzzle_grinder",
    "panda_bookshelf_thin_planned",
)

LEFT = 0.6
"""[-] Of the least clearance of a case, what its fail limit is set to: the case as it is keeps it."""

DEEPEST = 0.05
"""[m] How far below the fail limit the worst is pushed at most."""

BENDS = 8
"""Intervals of the splines that a path is bent by; not those that it is mended with."""


@dataclass(frozen=True, eq=False)
class Made:
    """A violated case.

    Attributes:
        kind, who: what may be changed to mend it. known: the size of the change that takes it back.
    """

    name: str
    case: Case
    kind: str
    who: str
    known: float


def sources() -> Iterator[tuple[str, Case]]:
    """Cases that keep limits which are set a little below what they come to."""
    folders = [(name, ROOT / "scenes" / name) for name in OURS]
    folders += [(name, ROOT.parent / "shared" / "cases" / name) for name in SHARED]
    for name, folder in folders:
        if not (Path(folder) / "case.yaml").exists():
            continue
        case = cl.load_case(folder / "case.yaml")
        case = replace(case, limits=Limits())
        least = cl.check(case).certificate.lower_bound.min()
        if least > 1e-3:
            yield name, replace(case, limits=Limits(fail=LEFT * float(least)))


def made(n_cases: int, seed: int = 0) -> list[Made]:
    """So many cases, of each source and kind as many as can be."""
    rng = np.random.default_rng(seed)
    found: list[Made] = []
    kept = [*sources()]
    for i in range(10 * n_cases):
        name, case = kept[i % len(kept)]
        kind = ("waypoints", "obstacle", "base")[(i // len(kept)) % 3]
        one = _bent(name, case, rng) if kind == "waypoints" else _pushed(name, case, kind, rng)
        if one is not None:
            found.append(one)
        if len(found) == n_cases:
            break
    return found


def _below(case: Case) -> float:
    """[m] How far the least clearance of the steps is below the fail limit."""
    run = cl.check(case, certify=False, contact="none", need="minimum")
    return case.limits.fail - run.record.worst.clearance


def _bent(name: str, case: Case, rng: np.random.Generator) -> Made | None:
    moving = [
        i for i, one in enumerate(case.robots) if one.trajectory and one.trajectory.n_steps > 2
    ]
    if not moving:
        return None
    i_robot = int(rng.choice(moving))
    times = case.robots[i_robot].asked.times
    ends = ((times[0], times[0]), (times[-1], times[-1]))
    offsets = joint_offsets(case, i_robot, BENDS, ends)
    way = rng.normal(size=offsets.n_joints * offsets.n_splines) / np.repeat(
        offsets.weights, offsets.n_splines
    )
    found = _scaled(offsets.case_of, way / offsets.size(way), 0.5, rng)
    if found is None:
        return None
    try:
        require_within_limits(offsets.case_of(found).robots[i_robot])
    except BadInput:
        return None
    who = case.robots[i_robot].robot.name
    return Made(name, offsets.case_of(found), "waypoints", who, offsets.size(found))


def _pushed(name: str, case: Case, kind: str, rng: np.random.Generator) -> Made | None:
    record = cl.check(case, certify=False, contact="none").record
    shift, who = _shift_of(case, kind, record, rng)
    if shift is None:
        return None
    way = rng.normal(size=3)
    found = _scaled(shift.case_of, way / np.linalg.norm(way), 0.3, rng)
    return None if found is None else Made(name, shift.case_of(found), kind, who, shift.size(found))


def _shift_of(case, kind, record, rng) -> tuple[Shift | None, str]:  # type: ignore[no-untyped-def]
    if kind == "base":
        standing = [one.robot.name for one in case.robots if one.mount is None]
        who = str(rng.choice(standing))
        return base_shift(case, who), who
    carried = {carry.part for carry in case.carries}
    names = [o.name for o in case.obstacles if o.mount is None and o.name not in carried]
    near = record.worst.obstacle
    if near not in names:
        return None, near
    return obstacle_shift(case, near), near


def _scaled(case_of, way, most, rng) -> np.ndarray | None:  # type: ignore[no-untyped-def]
    """The way so far that the least clearance is below the limit by a chosen length; None if it never is."""
    wanted = float(rng.uniform(0.001, DEEPEST))
    low, high = 0.0, None
    scale = most / 16.0
    while scale <= most:
        below = _below(case_of(scale * way))
        if below > 0.0:
            high = scale
            break
        low, scale = scale, 2.0 * scale
    if high is None:
        return None
    for _ in range(6):
        scale = 0.5 * (low + high)
        below = _below(case_of(scale * way))
        if 0.0 < below <= wanted:
            low = scale
        elif below > wanted:
            high = scale
        else:
            low = scale
    return high * way
