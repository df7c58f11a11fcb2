"""A run's steps and its phases: from moments at which something changes hands, comes, goes or jumps to the next.

Steps are the union of all sample times, and of the ends of all windows. In a phase the case is a plain one: what
is carried rides on what carries it, and every table has a sample at every step. Where two phases meet, the step
belongs to both, with its values before and after. Not for: where an actor is between its samples (`knots`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import BadTime, Contradiction, UnknownObstacle, at, nearest_name
from clearance.world.body import Mount, Obstacle
from clearance.world.case import Case
from clearance.world.corner_paddings import corner_windows, with_corner_paddings
from clearance.world.forest import (
    owner_of,
    require_known,
)
from clearance.world.hands import with_parts
from clearance.world.knots import Knots, knots_of_motion, knots_of_poses, looped
from clearance.world.motion import Motion
from clearance.world.path_error import path_error_of
from clearance.world.phase import Phase
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing, Window, time_text

NOT_THERE = "after: absent, or gaps: not_measured"
"""Why an actor may not be there."""


@dataclass(frozen=True, eq=False)
class Timeline:
    """A case over time.

    Attributes:
        motions: of the robots at all steps; where two phases meet, after the jump.
        phases: in order of time; each begins where the one before ends.
    """

    motions: tuple[Motion, ...]
    phases: tuple[Phase, ...]

    @property
    def times(self) -> np.ndarray:
        """(n,) [s] of the steps."""
        return self.motions[0].times

    @property
    def path_error(self) -> float:
        """[m] By how much clearances are lessened since paths are off their samples' motion."""
        return self.phases[0].case.path_error

    def phase_of(self, step: int) -> Phase:
        """The phase that a step begins or is in; of the last step the last."""
        starts = [phase.first for phase in self.phases]
        return self.phases[max(0, int(np.searchsorted(starts, step, side="right")) - 1)]


@dataclass(frozen=True, eq=False)
class _Table:
    """The commanded motion of one actor.

    Attributes:
        knots: those of the whole run; one where it stands.
        once: [s] the first and the last time of its own samples.
        moves: False where it stands, and so says nothing of when the run begins and ends.
        not_measured: stretches of the run in which it is omitted as if it were not in the cell.
    """

    knots: Knots
    once: tuple[float, float]
    timing: Timing
    moves: bool = True
    not_measured: tuple[Window, ...] = ()

    def is_absent(self, times: np.ndarray) -> bool:
        """True if it is not in the cell over a stretch in which that does not change."""
        first, last = self.once
        if any(window.holds(times[0], times[-1]) for window in self.not_measured):
            return True
        return self.timing.after == "absent" and bool(times[0] < first or times[-1] > last)


def timeline_of(case: Case, own: Sequence[Motion]) -> Timeline:
    """The timeline of a case.

    Args:
        own: the motion of each robot at the times of its own table.

    Raises:
        NoTrajectory: nothing moves. BadTime: a window outside the run, or a part that is carried while it is
            absent. UnknownObstacle, UnknownLink: a part, or what carries it, that is not there.
    """
    _require_parts(case)
    error = path_error_of(case, own)
    if error:
        case = replace(case, path_error=error)
    robots = [_of_robot(motion) for motion in own]
    obstacles = {i: _of_obstacle(o) for i, o in enumerate(case.obstacles) if o.moves is not None}
    start, end = _span(case, [*robots, *obstacles.values()])
    robots = [_laid_out(table, end) for table in robots]
    obstacles = {i: _laid_out(table, end) for i, table in obstacles.items()}
    tables = [*robots, *obstacles.values()]
    corners = corner_windows(case)
    cuts = _cuts(case, tables, [window for _, _, window in corners], start, end)
    times = _steps([table.knots for table in tables if table.moves], cuts, start, end)
    edges = [0, *np.searchsorted(times, cuts).tolist(), len(times) - 1]
    phases: list[Phase] = []
    for first, last in zip(edges, edges[1:], strict=False):
        here = times if len(edges) == 2 else times[first : last + 1]
        plain = Phase(
            first,
            last,
            _with_samples(case, obstacles, here),
            tuple(_resampled(m, t.knots, here) for m, t in zip(own, robots, strict=True)),
            {c.part: c for c in case.carries if c.window.holds(float(here[0]), float(here[-1]))},
            frozenset(i for i, table in enumerate(robots) if table.is_absent(here)),
            frozenset(i for i, table in obstacles.items() if table.is_absent(here)),
        )
        plain = _with_carried_present(plain, phases)
        _require_carried_present(plain)
        phases.append(_with_absent(with_parts(plain, phases)))
        _require_carriers_present(phases[-1], end)
    phases = with_corner_paddings(phases, corners)
    return Timeline(_joined(own, phases), tuple(phases))


def _require_parts(case: Case) -> None:
    names = [obstacle.name for obstacle in case.obstacles]
    for i, carry in enumerate(case.carries):
        with at(f"carry[{i}].part"):
            if carry.part not in names:
                raise UnknownObstacle(
                    f"there is no part {carry.part!r}", valid=nearest_name(carry.part, names)
                )
        with at(f"carry[{i}].by"):
            require_known(case, carry.by)


def _with_carried_present(phase: Phase, before: Sequence[Phase]) -> Phase:
    """The phase with the parts that have been picked up, whose own tables say nothing from then on."""
    if not phase.absent_obstacles:
        return phase
    carried = {part for then in before for part in then.carried}
    if before:
        names = [obstacle.name for obstacle in phase.case.obstacles]
        gone = {names[i] for i in before[-1].absent_obstacles}
        carried |= phase.carried.keys() - gone
    absent = (i for i in phase.absent_obstacles if phase.case.obstacles[i].name not in carried)
    return replace(phase, absent_obstacles=frozenset(absent))


def _require_carried_present(phase: Phase) -> None:
    """Nothing, if what is carried is in the cell.

    Raises:
        BadTime: a part whose own table says that it is not.
    """
    for i in phase.absent_obstacles:
        carry = phase.carried.get(phase.case.obstacles[i].name)
        if carry is not None:
            start, end = phase.span
            raise BadTime(
                f"part {carry.part!r} is not in the cell from {time_text(start)} s to {time_text(end)} s "
                f"({NOT_THERE})",
                where=f"carry[{phase.case.carries.index(carry)}]",
                valid="a window in which it is, or after: hold",
            )


def _require_carriers_present(phase: Phase, end: float) -> None:
    """Nothing, if what picks up or lets go is in the cell then; it may leave with what it carries.

    Args:
        end: [s] of the run.

    Raises:
        BadTime: a part that would vanish when it is picked up, or appear when it is let go.
    """
    names = [obstacle.name for obstacle in phase.case.obstacles]
    start, until = phase.span
    for carry in phase.carried.values():
        if names.index(carry.part) not in phase.absent_obstacles:
            continue
        is_picked = phase.first == 0 or start == carry.window.start
        if is_picked or until == carry.window.end < end:
            deed = "picks up" if is_picked else "lets go of"
            raise BadTime(
                f"{carry.by!r} is not in the cell from {time_text(start)} s to {time_text(until)} s "
                f"({NOT_THERE}), and {deed} part {carry.part!r} then",
                where=f"carry[{phase.case.carries.index(carry)}]",
                valid="a window at whose ends it is, or after: hold",
            )


def _of_robot(motion: Motion) -> _Table:
    timing, asked = motion.placed.timing, motion.placed.trajectory
    knots = knots_of_motion(motion)
    not_measured = asked.not_measured if asked is not None else ()
    if not_measured and timing.after == "loop":
        raise Contradiction(
            f"the recording of robot {motion.placed.robot.name!r} has holes and repeats (after: loop)",
            valid="after: hold, or gaps: hold or linear",
        )
    spans = (timing.run_times(np.array(window.ends)) for window in not_measured)
    windows = tuple(Window(*map(float, span)) for span in spans)
    return _Table(knots, _ends(knots), timing, asked is not None, windows)


def _of_obstacle(obstacle: Obstacle) -> _Table:
    table = obstacle.moves
    assert table is not None
    knots = knots_of_poses(table)
    return _Table(knots, _ends(knots), table.timing)


def _ends(knots: Knots) -> tuple[float, float]:
    return float(knots.times[0]), float(knots.times[-1])


def _span(case: Case, tables: Sequence[_Table]) -> tuple[float, float]:
    """[s] From the first sample to the last of all that do not loop, and once through each table that does.

    What loops may have begun before.
    """
    moving = [table for table in tables if table.moves]
    if not moving:
        _ = case.robots[0].given_trajectory  # refuses a case in which nothing moves
    loops = [table.once for table in moving if table.timing.after == "loop"]
    once = [table.once for table in moving if table.timing.after != "loop"]
    start = min(first for first, _ in once or loops)
    ends = [last + max(0.0, start - first) for first, last in loops]
    return start, max(ends + [last for _, last in once])


def _laid_out(table: _Table, end: float) -> _Table:
    """The table over the whole run."""
    if table.timing.after != "loop":
        return table
    return replace(table, knots=looped(table.knots, end))


def _cuts(
    case: Case, tables: Sequence[_Table], corners: Sequence[Window], start: float, end: float
) -> np.ndarray:
    """The times [s] inside the run at which a phase ends and the next begins."""
    found = [jumps for table in tables if len(jumps := table.knots.jumps)]
    found += [np.array(table.once) for table in tables if table.timing.after == "absent"]
    found += [np.array(window.ends) for table in tables for window in table.not_measured]
    found += [np.array(window.ends) for window in corners]
    for where, window in _windows(case):
        with at(where):
            _require_within(window, start, end)
        found.append(np.array(window.ends))
    if not found:
        return np.empty(0)
    cuts = np.unique(np.concatenate(found))
    return cuts[(cuts > start) & (cuts < end)]


def _windows(case: Case) -> Iterator[tuple[str, Window]]:
    found = [(f"carry[{i}]", carry.window) for i, carry in enumerate(case.carries)]
    found += [(f"limits.rules[{i}]", rule.window) for i, rule in enumerate(case.limits.rules)]
    found += [(f"allow[{i}]", row.window) for i, row in enumerate(case.allow)]
    yield from (row for row in found if row[1].ends)


def _require_within(window: Window, start: float, end: float) -> None:
    """Nothing, if a window's bounds are in the run; from 0 s is from its beginning, which may be later.

    Raises:
        BadTime: a bound that is not.
    """
    for edge in window.ends:
        if not start <= edge <= end and not edge == window.start == 0.0 < start < window.end:
            raise BadTime(
                f"{time_text(edge)} s is outside the run",
                valid=f"a time from {time_text(start)} s to {time_text(end)} s",
            )


def _steps(laid: Sequence[Knots], cuts: np.ndarray, start: float, end: float) -> np.ndarray:
    """(n,) [s] all samples and cuts of the run, and its end, each once; the array of a table that is alone."""
    if len(laid) == 1 and not len(cuts) and start == laid[0].times[0] and end == laid[0].times[-1]:
        return laid[0].times
    times = np.unique(np.concatenate([*(knots.times for knots in laid), cuts, [end]]))
    return times[(times >= start) & (times <= end)]


def _resampled(motion: Motion, knots: Knots, times: np.ndarray) -> Motion:
    """The motion at other times."""
    if times is motion.times or np.array_equal(times, motion.times):
        if not len(knots.jumps) or not np.isin(knots.jumps, times[1:-1]).any():
            return motion
    return replace(
        motion,
        times=times,
        positions=knots.values_at(times),
        velocities=knots.rates_at(times),
        tracking_error=_errors_at(motion, times),
    )


def _errors_at(motion: Motion, times: np.ndarray) -> np.ndarray:
    """(n,) the greater tracking error of the samples before and after each time; the greatest where a table
    loops.
    """
    timing, errors = motion.placed.timing, motion.tracking_error
    if timing.after == "loop":
        return np.full(len(times), errors.max())
    own = timing.run_times(motion.times)
    after = np.clip(np.searchsorted(own, times), 0, len(own) - 1)
    before = np.clip(np.searchsorted(own, times, side="right") - 1, 0, len(own) - 1)
    return np.maximum(errors[before], errors[after])


def _with_samples(case: Case, tables: Mapping[int, _Table], times: np.ndarray) -> Case:
    """The case with a sample of every obstacle that moves at each of some times."""
    if not tables:
        return case
    obstacles = list(case.obstacles)
    for i, table in tables.items():
        values = table.knots.values_at(times)
        obstacles[i] = replace(obstacles[i], moves=PoseTable(times, values[:, :3], values[:, 3:]))
    return replace(case, obstacles=tuple(obstacles))


def _with_absent(phase: Phase) -> Phase:
    """The phase without what stands on something that is not in the cell."""
    case = phase.case
    gone = {(False, i) for i in phase.absent_robots} | {(True, i) for i in phase.absent_obstacles}
    if not gone:
        return phase
    mounts = [((False, i), placed.mount) for i, placed in enumerate(case.robots)]
    mounts += [((True, i), obstacle.mount) for i, obstacle in enumerate(case.obstacles)]
    for _ in mounts:
        gone |= {thing for thing, mount in mounts if _stands_on(case, mount, gone)}
    robots = frozenset(i for is_obstacle, i in gone if not is_obstacle)
    obstacles = frozenset(i for is_obstacle, i in gone if is_obstacle)
    return replace(phase, absent_robots=robots, absent_obstacles=obstacles)


def _stands_on(case: Case, mount: Mount | None, gone: Collection[tuple[bool, int]]) -> bool:
    return mount is not None and owner_of(case, mount) in gone


def _joined(own: Sequence[Motion], phases: Sequence[Phase]) -> tuple[Motion, ...]:
    """The motions over all phases."""
    if len(phases) == 1:
        return phases[0].motions
    joined = []
    for i, motion in enumerate(own):
        parts = [phase.motions[i] for phase in phases]
        rates = [part.velocities for part in parts if part.velocities is not None]
        joined.append(
            replace(
                motion,
                times=_row_once([part.times for part in parts]),
                positions=_row_once([part.positions for part in parts]),
                velocities=None if motion.velocities is None else _row_once(rates),
                tracking_error=_row_once([part.tracking_error for part in parts]),
            )
        )
    return tuple(joined)


def _row_once(parts: Sequence[np.ndarray]) -> np.ndarray:
    """The rows of all phases; where two meet, that of the later one."""
    return np.concatenate([*(part[:-1] for part in parts[:-1]), parts[-1]])
