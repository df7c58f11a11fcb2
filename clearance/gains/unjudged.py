"""The effects of a change that no rule judges: on obstacles, on allowed pairs, on grips. Each is a warning.

Not for: pairs that a run measures, whose rules the search keeps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import inverse
from clearance.record.record import Record
from clearance.record.wording import depth_mm
from clearance.simulate.answers.handling import TOUCHING, depth_between, gap_between
from clearance.world.carry import Carry
from clearance.world.forest import WORLD, forest_of, link_poses_at
from clearance.world.pairs import OBSTACLE, BodyIndex, bodies_of, selected_pairs
from clearance.world.phase import Phase
from clearance.world.timing import time_text

DEEPER = 1e-5
"""[m] An allowed pair that is deeper by no more than this is as deep as before."""

MOST_STEPS = 50
"""Steps of a phase at which an allowed pair is looked at."""

STILL = 1e-6
"""[m], [rad] A grip that is off by no more than this is the same."""


def unjudged_effects(before: Record, after: Record) -> Iterator[str]:
    """A line for each effect that no rule of the changed case sees."""
    yield from _obstacles(before, after)
    yield from _allowed_pairs(before, after)
    yield from _grips(before, after)


def _obstacles(before: Record, after: Record) -> Iterator[str]:
    """Obstacles that a change of place puts into each other at the first step, or takes from each other."""
    phases = before.timeline.phases[0], after.timeline.phases[0]
    bodies = [BodyIndex(OBSTACLE, i) for i in range(len(after.case.obstacles))]
    old, new = ([_poses(phase, body, np.zeros(1, int))[0] for body in bodies] for phase in phases)
    moved = [not np.array_equal(*poses) for poses in zip(old, new, strict=True)]
    shapes = [obstacle.body.shape for obstacle in after.case.obstacles]
    names = [obstacle.name for obstacle in after.case.obstacles]
    for i in np.flatnonzero(moved):
        for k in np.flatnonzero(~np.array(moved)):
            was, now = (gap_between(shapes[i], at[i], shapes[k], at[k]) for at in (old, new))
            if now <= 0.0 < was:
                yield (
                    f"{names[i]!r} stands in {names[k]!r} after the change: "
                    "obstacles are not measured against each other"
                )
            if was <= TOUCHING < now:
                yield (
                    f"{names[i]!r} and {names[k]!r} touch before the change and are {now * 1e3:.4g} mm "
                    "apart after it: move what lies on the other as well"
                )


def _allowed_pairs(before: Record, after: Record) -> Iterator[str]:
    """Allowed pairs that are deeper in each other than before, at the steps."""
    old, new = (_placed_pairs(record) for record in (before, after))
    for names, placed in new.items():
        if names in old and _alike(old[names], placed):
            continue
        was, now = _deepest(old.get(names, [])), _deepest(placed)
        pair = f"{names[0]!r} and {names[1]!r}, an allowed pair"
        if math.isnan(now):
            yield f"{pair}, touch after the change: how deep is not known"
        elif not now <= was + DEEPER:
            past = "not known" if math.isnan(was) else f"{depth_mm(was)} mm"
            yield f"{pair}, are {depth_mm(now)} mm deep in each other after the change ({past} before)"


class _Placed(NamedTuple):
    """Two shapes and their (k, 4, 4) poses [m] at steps."""

    shapes: tuple[Polyhedron, Polyhedron]
    poses: tuple[np.ndarray, np.ndarray]


def _placed_pairs(record: Record) -> dict[tuple[str, str], list[_Placed]]:
    """The pairs that a row of `allow` or of `touch` excuses, where they are in each phase that it does in."""
    found: dict[tuple[str, str], list[_Placed]] = {}
    for phase in record.timeline.phases:
        case = phase.case
        called = {body.name_in(case): body for body in bodies_of(case)}
        rows = {str(row) for row in case.allow}
        steps = np.unique(np.linspace(0, phase.n_steps - 1, MOST_STEPS).astype(int))
        for one in selected_pairs(phase).unmeasured:
            pair = called.get(one.link), called.get(one.obstacle)
            if pair[0] is None or pair[1] is None:
                continue
            if one.reason in rows or one.reason.startswith("touch: "):
                a, b = pair[0], pair[1]
                poses = _poses(phase, a, steps), _poses(phase, b, steps)
                shapes = a.shape_in(case), b.shape_in(case)
                found.setdefault((one.link, one.obstacle), []).append(_Placed(shapes, poses))
    return found


def _alike(old: list[_Placed], new: list[_Placed]) -> bool:
    """True if a pair is placed alike before and after, as one body sees the other."""
    seen = [
        np.concatenate([np.linalg.solve(one.poses[0], one.poses[1]) for one in placed])
        for placed in (old, new)
    ]
    return seen[0].shape == seen[1].shape and bool(np.abs(seen[0] - seen[1]).max() <= STILL)


def _deepest(placed: list[_Placed]) -> float:
    """[m] The greatest depth of a pair at its steps; NaN where one is not known."""
    depths = [
        depth_between(a, at_a, b, at_b)
        for (a, b), poses in placed
        for at_a, at_b in zip(*poses, strict=True)
        if gap_between(a, at_a, b, at_b) <= 0.0
    ]
    return float(np.max(depths, initial=0.0))


def _grips(before: Record, after: Record) -> Iterator[str]:
    """Parts that are picked up otherwise, or put down elsewhere, than before."""
    end = float(after.timeline.times[-1])
    for carry, then in zip(before.case.carries, after.case.carries, strict=True):
        was, now = _grip(before, carry), _grip(after, then)
        if was is None or now is None:
            continue
        picked, put = (_way(*poses) for poses in zip(was, now, strict=True))
        if picked:
            yield (
                f"part {carry.part!r} is {picked} off its old place on {carry.by} at the pick-up "
                f"({time_text(then.window.start)} s): nothing says that the grip still holds it"
            )
        if put and then.window.end <= end:
            yield f"part {carry.part!r} is put down {put} off its old place ({time_text(then.window.end)} s)"


def _grip(record: Record, carry: Carry) -> tuple[np.ndarray, np.ndarray] | None:
    """(4, 4) each [m]: `carrier_from_part` at the pick-up, `world_from_part` at the end; None: not in the run."""
    held = [one for one in record.timeline.phases if one.carried.get(carry.part) == carry]
    if not held:
        return None
    names = [one.name for one in held[0].case.obstacles]
    part = BodyIndex(OBSTACLE, names.index(carry.part))
    first, last = (
        _poses(held[0], part, np.zeros(1, int)),
        _poses(held[-1], part, np.array([held[-1].n_steps - 1])),
    )
    links = link_poses_at(held[0].case, held[0].motions, slice(0, 1))[0]
    link = forest_of(held[0].case).link_called(held[0].case, carry.by)
    return (first[0] if link == WORLD else inverse(links[link]) @ first[0]), last[0]


def _way(one: np.ndarray, other: np.ndarray) -> str:
    """How far and by what angle two (4, 4) poses differ, in words; "" where they are the same."""
    between = inverse(one) @ other
    far = float(np.linalg.norm(one[:3, 3] - other[:3, 3]))
    turn = 2.0 * math.asin(
        min(1.0, float(np.linalg.norm(between[:3, :3] - np.eye(3))) / math.sqrt(8.0))
    )
    parts = [f"{far * 1e3:.4g} mm"] * (far > STILL) + [f"{math.degrees(turn):.3g} deg"] * (
        turn > STILL
    )
    return " and ".join(parts)


def _poses(phase: Phase, body: BodyIndex, steps: np.ndarray) -> np.ndarray:
    """(k, 4, 4) `world_from_body` [m] at some of a phase's own steps."""
    return body.poses_in(phase.case, link_poses_at(phase.case, phase.motions, steps))
