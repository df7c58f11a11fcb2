"""What can be gained: the least change of a kind, proven, with what no such change can do better.

Not for: how it is written down (`changed_files`), told (`sentences`) or shown (`page`).
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from clearance.errors import BadChange, UnknownRobot, nearest_name
from clearance.gains.binding_constraints import (
    bound_by,
    ends_reached,
    joints_at_limits,
    tools_at_limits,
)
from clearance.gains.delay import least_delay, least_slowing
from clearance.gains.detours import flat_moment, from_detours
from clearance.gains.joint_ranges import require_within_limits
from clearance.gains.lower_bounds import least_offset, least_shift
from clearance.gains.obstruction import (
    HOPELESS,
    HOWEVER_SLOW,
    NOT_FOUND,
    NOT_PROVEN,
    TOO_FAR,
    TOO_LATE,
    TOO_SLOW,
    Obstruction,
    approach_of,
    blocked_by,
    kept_still,
    tool_obstruction,
    unproven,
    worst_pair,
)
from clearance.gains.offsets import joint_offsets
from clearance.gains.path_change import PathChange
from clearance.gains.programme import Box
from clearance.gains.request import Request
from clearance.gains.result import Gain
from clearance.gains.search import Search, SearchResult
from clearance.gains.shift import ANYWHERE, Shift, base_shift, obstacle_shift
from clearance.gains.shortfalls import State
from clearance.gains.stretches import fixed_spans, require_in_path, require_in_run, windows_of
from clearance.gains.tool_path import ToolPathKept, tool_path_kept
from clearance.gains.tool_path_error import tool_path_error
from clearance.options import made
from clearance.run import Question, answer
from clearance.world.case import Case
from clearance.world.notice import listed

INTERVALS = (12, 24, 48, 96)
"""Of the splines of a path, the coarsest that is enough is taken."""

NO_WORSE = 1.05
"""[-] A change that is within this of what no change can beat is not sought elsewhere."""

INSIDE = 0.8
"""[-] Smaller shifts than the first are sought from so far on the other sides."""

FARTHER = (0.05, 0.1)
"""[m] From how far, where the first search found none."""


def gain(case: Case | str | PathLike[str], kind: str = "waypoints", **options: Any) -> Gain:
    """The least change of a kind that was found to make every rule of a case hold, proven.

    Args:
        case: or the path of a case file.
        kind: "waypoints": smooth offsets of a robot's joints; "obstacle", "base": a shift along x, y and z, the
            joints as they are; "timing": a robot begins later.
        options: any of `request.Request`, by name, as `margin=0.003`, `robot="left"`.

    Raises:
        BadInput: what cannot be changed. UnknownRobot, UnknownObstacle, UnknownLink: with the nearest name.
    """
    from clearance.case.case_file import load_case

    request = made(Request, options, kind=kind)
    if isinstance(case, Case):
        return gained(case, request)
    if not isinstance(case, str | PathLike):
        given = type(case).__name__
        raise BadChange(f"a {given} is given", valid="a Case, or the path of a case file")
    return replace(gained(load_case(case), request), case_file=Path(case))


def gained(case: Case, request: Request) -> Gain:
    """The gain of what is request.

    Raises:
        BadInput: as `gain`; clocks that are not tied, where no pair has one time that could be looked at.
    """
    if case.clock.slack:
        raise BadChange("the clocks of the case are not tied", valid="clock: common")
    _refuse_programs(case, request)
    ways = {"timing": _by_delay, "waypoints": _by_path, "obstacle": _by_shift, "base": _by_shift}
    return ways[request.kind](case, request)


def _refuse_programs(case: Case, request: Request) -> None:
    """Nothing, if programs are proven and what is changed leaves the joints of robots with one as they are.

    Raises:
        BadInput: it does not: the program would have to be followed anew.
    """
    for placed in case.robots:
        asked = placed.trajectory
        if asked is not None and asked.unproven:
            raise BadChange(
                f"part of the program of robot {placed.robot.name!r} is not proven, whatever is changed",
                valid="a program that `clearance check` proves",
            )
        tied = () if asked is None else (*asked.drives, *asked.rides)
        if asked is not None and tied and request.kind != "obstacle":
            deed = "moves" if asked.drives else "goes with"
            fault = f"the program of robot {placed.robot.name!r} {deed} {listed([*tied])} too"
            raise BadChange(fault, valid=_what_may_be_moved(case, {*asked.frames, *asked.rides}))
        if asked is None or not asked.moves or request.kind == "timing":
            continue
        if request.kind != "obstacle" or asked.frames:
            raise BadChange(
                f"robot {placed.robot.name!r} follows a program, and kind {request.kind} changes its joints",
                valid="kind timing, or obstacle where no frame of the program is on one",
            )


def _what_may_be_moved(case: Case, used: Container[str]) -> str:
    """What is valid where a change may move no robot, and nothing that a program uses."""
    carried = {one.part for one in case.carries}
    obstacles = [one.name for one in case.obstacles if one.mount is None]
    free = [name for name in obstacles if name not in carried and name not in used]
    if free:
        return f"kind obstacle with {listed(free)}, which changes neither of their motions"
    return "another program: all obstacles ride on something, are carried or carry frames, so none may be moved"


def _by_shift(case: Case, request: Request) -> Gain:
    way, who = _shift(case, request)
    search = Search(way, request.margin)
    first = search.first_state()
    at_least = least_shift(way, first, request.margin)
    blocked = _shift_obstruction(first, way)
    if blocked is None and request.tool_path != "kept" and at_least > way.farthest:
        blocked = worst_pair(first, TOO_FAR)
    found = SearchResult(first, None, 1)
    if blocked is None:
        found = _least_of_several(search, way, first, at_least)
    change, size = way.change_of(found.state.x), way.size(found.state.x)
    result = _gain(case, request, found, change, size, at_least, who, blocked or NOT_FOUND)
    result = replace(result, binding=_binding(found, way, result))
    if not isinstance(way, ToolPathKept):
        return result
    error = tool_path_error(way.placed, result.case.robots[way.i_robot], way.tool)
    return replace(result, joint_names=way.placed.given_trajectory.joint_names, tool_path=error)


def _shift_obstruction(first: State, way: Shift) -> Obstruction | None:
    """What no change of place mends; None where that is not known: a large one may part what a small does not."""
    blocked = blocked_by(first, way.gradient, way.transfers)
    return blocked if blocked is not None and blocked.why in HOPELESS else None


def _least_of_several(search: Search, shift: Shift, first: State, at_least: float) -> SearchResult:
    """The least of a search from where it is, and, where that may be beaten, from all sides."""
    best = search.from_state(first)
    for far in FARTHER:
        if not best.kept:
            best = _best_from_sides(search, shift, best, far)
    if best.kept and shift.size(best.state.x) > NO_WORSE * at_least:
        best = _best_from_sides(search, shift, best, INSIDE * shift.size(best.state.x))
        best = search.shortened(best)
    return best


def _best_from_sides(search: Search, shift: Shift, best: SearchResult, far: float) -> SearchResult:
    """The best, or a better one of searches from `far` [m] along each axis, either way.

    The one that misses least comes first, those in contact last; once a change is known, these are left out.
    """
    states = [search.state_at(start) for start in _starts(far, shift)]
    for state in sorted(states, key=lambda one: np.inf if one.touches else one.worst):
        if best.kept and state.touches:
            break
        found = search.from_state(state, shift.size(best.state.x) if best.kept else np.inf)
        if found.kept:
            best = found
    return best


def _starts(far: float, shift: Shift) -> Iterator[np.ndarray]:
    """(m,) variables `far` [m] along each axis, either way, as far as they may be."""
    axes = np.eye(len(shift.box.low))
    for side in (*axes, *-axes):
        start = np.clip(far * side, *shift.box)
        if start.any():
            yield start


def _by_path(case: Case, request: Request) -> Gain:
    changed = [_robot(case, name) for name in request.robot or (None,)]
    for i_robot in changed:
        require_within_limits(case.robots[i_robot])
        require_in_path(case.robots[i_robot], request.keep_tool)
    first: State | None = None
    for n_intervals in INTERVALS:
        offsets = _offsets(case, changed, n_intervals, request)
        search = Search(offsets, request.margin)
        first = search.first_state(first)
        require_in_run(request.keep, first.record.timeline.times)
        at_least = least_offset(offsets, first, request.margin)
        blocked = _path_obstruction(first, offsets, request)
        found = SearchResult(first, None, 1) if blocked else _least_path(search, offsets, first)
        if not found.kept and blocked is None:  # moments between the steps are looked at by now
            blocked = _left_as_it_is(found.state, offsets, request)
        if found.kept or blocked:
            break
    who = ", ".join(case.robots[i].robot.name for i in changed)
    changes = offsets.offsets(found.state.x)
    change = changes if len(changes) > 1 else changes[0]
    size = offsets.size(found.state.x)
    result = _gain(case, request, found, change, size, at_least, who, blocked or NOT_FOUND)
    moves = () if offsets.tool_poses is None else tuple(offsets.tool_poses.moves(found.state.x))
    tables = (part.placed.given_trajectory for part in offsets.parts)
    names = tuple(name for table in tables for name in table.joint_names)
    binding = _binding(found, offsets, result)
    return replace(result, joint_names=names, tool_moves=moves, binding=binding)


def _path_obstruction(first: State, offsets: PathChange, request: Request) -> Obstruction | None:
    """What no change of the path mends; None where that is not known."""
    if blocked_by(first, offsets.gradient, offsets.transfers) is None:
        return tool_obstruction(first, offsets.parts[0])
    return _left_as_it_is(first, offsets, request)


def _left_as_it_is(state: State, offsets: PathChange, request: Request) -> Obstruction | None:
    """The worst pair that falls short where every change leaves the path as it is; None without one.

    All that moves the pair may be to stay as it is then: that is the reason.
    """
    blocked = blocked_by(state, offsets.gradient, offsets.transfers)
    if blocked is None:
        return None
    approach, why = approach_of(blocked, state), blocked.why
    kept = (
        kept_still(blocked, windows_of(part.case, part.i_robot, request))
        for part in offsets.parts
        if part.gradient(approach) is not None
    )
    blocked = min(kept, key=lambda one: one.why != why, default=blocked)
    return blocked if blocked.why in HOPELESS else None


def _least_path(search: Search, offsets: PathChange, first: State) -> SearchResult:
    """The least of a search from a path as it is, and, where that ends at a pair that no small step parts, from
    beside it, on the coarsest splines."""
    found = search.from_state(first)
    coarse = all(part.basis.n_intervals == INTERVALS[0] for part in offsets.parts)
    flat = flat_moment(found.state, offsets) if coarse and not found.kept else None
    return found if flat is None else from_detours(search, offsets, flat) or found


def _offsets(case: Case, changed: Sequence[int], n_intervals: int, request: Request) -> PathChange:
    """What may be changed of one robot's path, or of several at once."""
    parts = [
        joint_offsets(
            case, i, n_intervals, fixed_spans(case, i, request), request.keep_tool, request.tool
        )
        for i in changed
    ]
    return PathChange(tuple(parts))


def _gain(
    case: Case,
    request: Request,
    found: SearchResult,
    change: np.ndarray | tuple[np.ndarray, ...],
    size: float,
    at_least: float,
    who: str,
    blocked: Obstruction | str,
) -> Gain:
    """The gain of where a search ended.

    Args:
        blocked: by what, as far as that is known, else why it ended.
    """
    before, after = answer(Question(case)), answer(Question(found.state.case))
    stays = blocked if isinstance(blocked, Obstruction) else None
    if isinstance(blocked, str) and not found.kept:
        stays = worst_pair(found.state, blocked) or unproven(after.record, request.margin)
    at_least = min(at_least, size) if found.kept else at_least
    return Gain(
        request, found.kept, found.state.case, change, size, at_least, who, before, after, stays,
        found.n_measured,
    )  # fmt: skip


def _binding(found: SearchResult, way: Shift | PathChange, gain: Gain) -> tuple[str, ...]:
    """What the best that was reached is up against; nothing where that is plain."""
    blocked, x, robots = gain.blocked, found.state.x, gain.case.robots
    if blocked is None or blocked.why not in (NOT_FOUND, NOT_PROVEN):
        return ()
    if isinstance(way, PathChange):
        moves = () if way.tool_poses is None else way.tool_poses.moves(x)
        changed = [robots[part.i_robot] for part in way.parts]
        return (*bound_by(found.state, blocked, changed), *tools_at_limits(moves))
    joints = joints_at_limits(robots[way.i_robot]) if isinstance(way, ToolPathKept) else ()
    return (*bound_by(found.state, blocked), *joints, *ends_reached(x, way.box))


def _by_delay(case: Case, request: Request) -> Gain:
    i_robot = _robot(case, request.one_robot)
    if request.slow_down:
        found = least_slowing(case, i_robot, request.margin)
    else:
        found = least_delay(case, i_robot, request.margin, request.most_delay)
    none_does = np.isinf(found.at_least)
    why = HOWEVER_SLOW if none_does else TOO_SLOW if request.slow_down else TOO_LATE
    at_least, stays = (found.delay, found.stays) if none_does else (found.at_least, None)
    who, change = case.robots[i_robot].robot.name, np.array([found.delay])
    return _gain(case, request, found, change, found.delay, at_least, who, stays or why)


def _shift(case: Case, request: Request) -> tuple[Shift, str]:
    """The shift that is asked for, and the name of the thing that is moved."""
    box = ANYWHERE if request.within is None else Box(*np.array(request.within).T)
    if request.kind == "base":
        i_robot = _robot(case, request.one_robot)
        placed, shift = case.robots[i_robot], base_shift(case, i_robot, box, request.turn)
        if request.tool_path == "kept":
            require_within_limits(placed)
            shift = tool_path_kept(shift, request.tool)
        return shift, placed.robot.name
    if not case.obstacles:
        raise BadChange("the case has no obstacle", valid="kind waypoints, base or timing")
    if request.obstacle is None and len(case.obstacles) != 1:
        names = ", ".join(obstacle.name for obstacle in case.obstacles[:8])
        raise BadChange(
            "there are several obstacles; name one with --obstacle", valid=f"one of {names}"
        )
    who = request.obstacle or case.obstacles[0].name
    return obstacle_shift(case, who, box, request.turn), who


def _robot(case: Case, name: str | None) -> int:
    """Which robot is meant.

    Raises:
        UnknownRobot: with the nearest name. BadInput: none is named, and there are several.
    """
    names = [placed.robot.name for placed in case.robots]
    if name is None and len(names) > 1:
        raise BadChange(
            "there are several robots; name one with --robot", valid=f"one of {', '.join(names)}"
        )
    if name is not None and name not in names:
        raise UnknownRobot(f"there is no robot {name!r}", valid=nearest_name(name, names))
    return 0 if name is None else names.index(name)
