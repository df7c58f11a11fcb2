"""The bodies that a profile is swept by: links of robots, what they carry, and obstacles by name."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from clearance.errors import BadShape, UnknownLink, UnknownObstacle, nearest_name
from clearance.profiles.chain import Chain, chain_of
from clearance.profiles.chords import BodyKnots, knots_of, standing
from clearance.profiles.plane import Plane
from clearance.profiles.profile import IN_DOUBT, MOVING, NOT_SWEPT
from clearance.record.wording import not_measured_text
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.corner_paddings import corner_off
from clearance.world.forest import WORLD
from clearance.world.motion import kinematic_motion
from clearance.world.notice import Notice, Severity, listed
from clearance.world.pairs import OBSTACLE, BodyIndex, names_of
from clearance.world.phase import Phase
from clearance.world.plausibility import notices_of
from clearance.world.plausible_recordings import not_measured
from clearance.world.robot_in_cell import link_below
from clearance.world.rules import matches
from clearance.world.timeline import Timeline, timeline_of

if TYPE_CHECKING:
    from clearance.record.record import Record


class RecordHolder(Protocol):
    """Anything with a record, as a run."""

    @property
    def record(self) -> Record: ...


@dataclass(frozen=True, eq=False)
class TimedCase:
    """A case, when what of it moves how, and what was found about it that bears on the sweep."""

    case: Case
    timeline: Timeline
    notices: tuple[Notice, ...] = ()


@dataclass(frozen=True, eq=False)
class SweptBody:
    """A body in one phase of a run; `chain` carries it, or it stands at `pose`.

    Attributes:
        off: [m] how far it may be off, in a corner zone of its program.
    """

    label: str
    body: Body
    first: int
    chain: Chain | None
    pose: np.ndarray | None = None
    off: float = 0.0

    def knots(self, plane: Plane, limit: float, *, solid: bool) -> BodyKnots:
        """The instants of its poses, in steps of the run."""
        if self.chain is None:
            assert self.pose is not None, "what nothing carries stands at a pose"
            return standing(self.pose, self.first)
        return knots_of(self.chain, self.body.shape, plane, limit, solid=solid, first=self.first)


def over_time(run: Case | TimedCase | Record | RecordHolder) -> TimedCase:
    """The case, and when what moves how: as its trajectories say, or as it was in a run.

    Raises:
        NoTrajectory and what else `timeline_of` raises.
    """
    if isinstance(run, Case):
        motions = [kinematic_motion(one) for one in run.robots]
        return TimedCase(run, timeline_of(run, motions), notices_of(run))
    timed = run.record if hasattr(run, "record") else run
    return TimedCase(timed.case, timed.timeline, timed.notices)


def swept_bodies(
    run: TimedCase, links: Sequence[str] | None, obstacles: Sequence[str]
) -> list[SweptBody]:
    """The links with all that they carry, then the obstacles: body by body, and of each phase by phase.

    Args:
        links: patterns of links, as in tables or without their robot's name; None for all but floors of their own.
        obstacles: patterns of obstacles, which are swept wherever they are.

    Raises:
        UnknownLink, UnknownObstacle: a pattern of none.
    """
    case = run.case
    chosen = _chosen_links(run, links)
    named = _chosen_obstacles(case, obstacles)
    found: list[SweptBody] = []
    phases = run.timeline.phases
    for i, placed in enumerate(case.robots):
        present = [i not in phase.absent_robots for phase in phases]
        for k in range(len(placed.robot.bodies)):
            index = BodyIndex(i, k)
            if index.name_in(case) in chosen:
                found += _over_phases(run, index, present)
    for i, obstacle in enumerate(case.obstacles):
        if obstacle.name not in named:
            carried = [_holder(phase, i) in chosen for phase in phases]
            found += _over_phases(run, BodyIndex(OBSTACLE, i), carried)
    places = {obstacle.name: i for i, obstacle in enumerate(case.obstacles)}
    for i in (places[name] for name in named):
        present = [i not in phase.absent_obstacles for phase in phases]
        found += _over_phases(run, BodyIndex(OBSTACLE, i), present)
    _require_surfaces(found)
    return found


def notes_on_sweep(run: TimedCase, swept: Sequence[SweptBody]) -> Iterator[str]:
    """What a sweep leaves out, and what it rests on that is in doubt; one line each."""
    case, moving = run.case, moving_but_not_swept(run, swept)
    if moving:
        yield f"{MOVING} {listed(moving)}"
    holes = not_measured_text(not_measured(case))
    if holes:
        yield f"{NOT_SWEPT}: motion {holes}"
    for placed in case.robots:
        whose = f" (robot {placed.robot.name!r})" if len(case.robots) > 1 else ""
        without = (one for one in placed.robot.notices if one.kind == "geometry")
        yield from (f"{NOT_SWEPT}: {one.text}{whose}" for one in without)
    open_kinds = (Severity.SUSPECT, Severity.UNPROVEN)
    for one in run.notices:
        if one.accepted_by(case.accept):
            continue
        if one.kind == "columns":
            yield f"{NOT_SWEPT}: {one.line}"
        elif one.severity in open_kinds or one.kind in ("equality", "rest"):
            yield f"{IN_DOUBT}: {one.line}"


def moving_but_not_swept(run: TimedCase, swept: Sequence[SweptBody]) -> list[str]:
    """The names of obstacles that move by themselves at some time, and are not swept then."""
    known = {(one.label, one.first) for one in swept}
    return [
        obstacle.name
        for i, obstacle in enumerate(run.case.obstacles)
        if any(
            BodyIndex(OBSTACLE, i).frame_in(phase.case) != WORLD and link_below(phase, i) is None
            for phase in run.timeline.phases
            if i not in phase.absent_obstacles and (obstacle.name, phase.first) not in known
        )
    ]


def _require_surfaces(found: Sequence[SweptBody]) -> None:
    for one in found:
        if one.body.is_cloud:
            raise BadShape(
                f"{one.label!r} is a cloud of points, which has no outline",
                valid="bodies with a surface",
            )


def _chosen_links(run: TimedCase, links: Sequence[str] | None) -> Collection[str]:
    """Names of links as in tables: those with a shape, and those that carry an obstacle."""
    case = run.case
    bodies = [
        BodyIndex(i, k) for i, p in enumerate(case.robots) for k in range(len(p.robot.bodies))
    ]
    known = {body.name_in(case): names_of(case, body) for body in bodies}
    for phase in run.timeline.phases:
        for i in range(len(case.obstacles)):
            holder = _holder(phase, i)
            if holder is not None:
                known.setdefault(holder, tuple(dict.fromkeys((holder, holder.split("/", 1)[-1]))))
    if links is None:
        floors = {body.name_in(case) for body in bodies if body.is_floor_in(case)}
        return frozenset(known) - floors
    found: set[str] = set()
    for pattern in links:
        fitting = [n for n, names in known.items() if any(matches(own, pattern) for own in names)]
        if not fitting:
            is_bare = any(matches(name, pattern) for name in _bare_links(case))
            fault = (
                f"link {pattern!r} has no shape to sweep"
                if is_bare
                else f"unknown link {pattern!r}"
            )
            raise UnknownLink(fault, where="links", valid=nearest_name(pattern, known))
        found.update(fitting)
    return found


def _bare_links(case: Case) -> Iterator[str]:
    """The names of all links, those without a shape too, with and without their robot's."""
    for placed in case.robots:
        yield from placed.robot.link_names
        yield from (f"{placed.robot.name}/{name}" for name in placed.robot.link_names)


def _chosen_obstacles(case: Case, patterns: Sequence[str]) -> list[str]:
    known = [obstacle.name for obstacle in case.obstacles]
    found: dict[str, None] = {}
    for pattern in patterns:
        fitting = [name for name in known if matches(name, pattern)]
        if not fitting:
            raise UnknownObstacle(
                f"unknown obstacle {pattern!r}",
                where="obstacles",
                valid=nearest_name(pattern, known),
            )
        found.update(dict.fromkeys(fitting))
    return list(found)


def _holder(phase: Phase, i_obstacle: int) -> str | None:
    """The name as in tables of the robot's link that an obstacle is on in the end, or None."""
    carrying = link_below(phase, i_obstacle)
    if carrying is None:
        return None
    i_robot, link = carrying
    case = phase.case
    robot = case.robots[i_robot].robot
    name = robot.link_names[link]
    return name if len(case.robots) == 1 else f"{robot.name}/{name}"


def _over_phases(run: TimedCase, index: BodyIndex, is_swept: Sequence[bool]) -> Iterator[SweptBody]:
    """The body in each phase in which it is swept; where it stands on at one pose, once."""
    label, body = index.name_in(run.case), index.body_in(run.case)
    last: np.ndarray | None = None
    for phase, swept in zip(run.timeline.phases, is_swept, strict=True):
        if not swept:
            last = None
            continue
        frame = index.frame_in(phase.case)
        if frame != WORLD:
            chain = chain_of(phase.case, phase.motions, frame)
            off = corner_off(run.case, phase, index)
            yield SweptBody(label, body, phase.first, chain, off=off)
            last = None
            continue
        pose = phase.case.obstacles[index.i_body].world_from_body
        if last is None or not np.array_equal(last, pose):
            yield SweptBody(label, body, phase.first, None, pose)
        last = pose
