"""Measurement conditions of a run: what must be alike for its findings to be compared with another run's.

Where obstacles stand and how robots move is not among it: that is what changes from run to run, and what a
comparison is about. Not for: comparing (`comparison`).
"""

from __future__ import annotations

import hashlib
import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np

from clearance.record.fingerprint import robot_digest
from clearance.record.names import pair_names
from clearance.record.record import Record
from clearance.record.status import Status
from clearance.world.budget import Budget, PlacementTolerance, RobotTolerance
from clearance.world.case import Case, Limits
from clearance.world.cell import once_a_cell
from clearance.world.pairs import Pair
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Robot
from clearance.world.rules import DEFAULT


@dataclass(frozen=True)
class MeasuredRobot:
    """A robot: the sha256 of its joints, shapes and paddings, and the names of its links as findings have them."""

    name: str
    sha256: str
    links: tuple[str, ...]


@dataclass(frozen=True)
class MeasuredRule:
    """A rule: its bodies (empty for the limits that hold without one), when it holds, and its limits [m]."""

    name: str
    between: tuple[str, ...]
    when: str
    fail: float
    warn: float


@dataclass(frozen=True)
class MeasuredPairs:
    """Each of some bodies with each of others."""

    a: tuple[str, ...]
    b: tuple[str, ...]

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return itertools.product(self.a, self.b)


@dataclass(frozen=True)
class MeasurementConditions:
    """How a run was measured.

    Attributes:
        need, method: as in `run.Question`. basis: as `Record.basis`.
        motion: as in `run.Question`; "simulated, contact_response" where obstacles push back.
        certify_gap: [m] how far the bound may be below a distance that occurs; None at the samples only.
        clock_slack: [s] how far the actors' clocks may be apart; "not tied" where nothing bounds that.
        pairs: all that were measured at some time. unmeasured: those that were not, or not always; "*" stands for
            all that a link could meet.
        joints: what a joint beyond its limits is: "warn" or "fail". paddings: [m] of bodies that have one.
        moving: robots and obstacles with a motion of their own.
        tolerances: sha256 of the errors that were counted with; empty without any. errors: their sizes by name.
        sizes: [m] of each obstacle, along its own axes.
        present: [s] how long robots and obstacles are in the cell that are not there all the time.
    """

    need: str
    method: str
    motion: str
    basis: str
    certify_gap: float | None
    clock_slack: float | Literal["not tied"]
    robots: tuple[MeasuredRobot, ...]
    rules: tuple[MeasuredRule, ...]
    pairs: tuple[MeasuredPairs, ...]
    unmeasured: tuple[MeasuredPairs, ...]
    tolerances: str = ""
    joints: str = "warn"
    paddings: dict[str, float] = field(default_factory=dict, hash=False)
    moving: tuple[str, ...] = ()
    errors: dict[str, float] = field(default_factory=dict, hash=False)
    present: dict[str, float] = field(default_factory=dict, hash=False)
    sizes: dict[str, tuple[float, float, float]] = field(default_factory=dict, hash=False)

    def has_pair(self, one: str, other: str) -> bool:
        """True if two bodies were measured against each other."""
        ends = {one, other}
        return any(
            ends & {*block.a} and ends & {*block.b} and ends <= {*block.a, *block.b}
            for block in self.pairs
        )

    def has_body(self, name: str) -> bool:
        """True if a body was measured against another."""
        return any(name in block.a or name in block.b for block in self.pairs)

    def rules_of(self, status: str) -> tuple[MeasuredRule, ...]:
        """The rules as far as they decide on a finding: warn limits do not on one that fails."""
        if status not in (Status.VIOLATED, Status.CONTACT):
            return self.rules
        return tuple(replace(rule, warn=0.0) for rule in self.rules)


def conditions_of(record: Record) -> MeasurementConditions:
    """The conditions that a record was measured under."""
    certificate, slack = record.certificate, record.case.clock.slack
    unmeasured = sorted({(one.link, one.obstacle) for one in record.unmeasured})
    return MeasurementConditions(
        need=record.need,
        method=record.method,
        motion=_motion(record),
        basis=record.basis,
        certify_gap=None if certificate is None else float(certificate.gap),
        clock_slack="not tied" if math.isinf(slack) else float(slack),
        robots=tuple(_robot(record, placed) for placed in record.case.robots),
        rules=tuple(_rules(record.case.limits)),
        pairs=_measured_blocks(record.case, _measured(record)),
        unmeasured=tuple(_blocks(unmeasured)),
        tolerances=_tolerances(record.case.tolerance),
        joints=record.case.limits.joints,
        paddings=paddings_in(record.case),
        moving=tuple(_moving(record.case)),
        errors={name: size for name, size in _errors(record.case.tolerance) if size},
        present=_present(record),
        sizes={
            one.name: tuple(np.ptp(one.body.shape.bounds, axis=0).tolist())
            for one in record.case.obstacles
        },
    )


def _motion(record: Record) -> str:
    pushed = record.motion_kind == "simulated" and record.case.contact_response
    return f"{record.motion_kind}, contact_response" if pushed else record.motion_kind


def _present(record: Record) -> dict[str, float]:
    """[s] How long those are in the cell that some phase is without."""
    case, found = record.case, dict[str, float]()
    for phase in record.timeline.phases:
        robots = (case.robots[i].robot.name for i in sorted(phase.absent_robots))
        obstacles = (case.obstacles[i].name for i in sorted(phase.absent_obstacles))
        found |= dict.fromkeys([*robots, *obstacles], 0.0)
    for phase in record.timeline.phases if found else ():
        gone = {case.robots[i].robot.name for i in phase.absent_robots}
        gone |= {case.obstacles[i].name for i in phase.absent_obstacles}
        for name in found.keys() - gone:
            found[name] += phase.span[1] - phase.span[0]
    return found


def _moving(case: Case) -> Iterator[str]:
    for placed in case.robots:
        if placed.trajectory is not None and placed.trajectory.n_steps > 1:
            yield placed.robot.name
    yield from (obstacle.name for obstacle in case.obstacles if obstacle.moves is not None)


def paddings_in(case: Case) -> dict[str, float]:
    """[m] By how much clearances of a body are lessened, by its name; bodies without padding are left out."""
    return {name: padding for name, padding in _paddings(case) if padding}


def _paddings(case: Case) -> Iterator[tuple[str, float]]:
    for placed in case.robots:
        before = case.prefix_of(placed)
        for body in placed.robot.bodies:
            asked = placed.padding.get(body.name, 0.0)
            yield before + body.name, float(asked + body.shape.shortfall)
    for obstacle in case.obstacles:
        yield obstacle.name, float(obstacle.padding + obstacle.body.shape.shortfall)


def _tolerances(budget: Budget | None) -> str:
    """Of what decides what is proven and expected: not where the numbers come from, nor what is let pass."""
    if budget is None:
        return ""
    parts = (
        sorted((name, _sorted(one)) for name, one in budget.robots.items()),
        sorted((name, repr(one)) for name, one in budget.obstacles.items()),
        budget.coverage,
        budget.is_normal,
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _errors(budget: Budget | None) -> Iterator[tuple[str, float]]:
    """Each error by the name of its part and its kind, with its size [m, rad or s]."""
    for name, robot in ({} if budget is None else budget.robots).items():
        yield from _placed(f"base of {name}", robot.base)
        yield f"clock of {name}", robot.timing
        yield from ((f"surface of {name}/{link}", size) for link, size in robot.surfaces.items())
        for joint, one in robot.joints.items():
            yield f"position of joint {name}/{joint}", one.position
            yield f"tracking of joint {name}/{joint}", one.tracking
            yield from _placed(f"frame of joint {name}/{joint}", one.frame)
    for name, obstacle in ({} if budget is None else budget.obstacles).items():
        yield from _placed(name, obstacle.place)
        yield f"clock of {name}", obstacle.timing
        yield f"surface of {name}", obstacle.surface


def _placed(name: str, place: PlacementTolerance) -> Iterator[tuple[str, float]]:
    yield f"place of {name}", place.xyz
    yield f"angle of {name}", place.angle


def _sorted(robot: RobotTolerance) -> str:
    errors = sorted(robot.joints.items()), sorted(robot.surfaces.items())
    return repr((*errors, robot.base, robot.timing))


def _robot(record: Record, placed: PlacedRobot) -> MeasuredRobot:
    before = record.case.prefix_of(placed)
    links = tuple(before + link for link in placed.robot.link_names)
    shape = _digest(placed.robot)
    parts = repr((shape, sorted(placed.exclude_links), sorted(placed.padding.items())))
    return MeasuredRobot(placed.robot.name, hashlib.sha256(parts.encode()).hexdigest(), links)


_DIGESTS: WeakKeyDictionary[Robot, str] = WeakKeyDictionary()
"""Of robots that were asked about: a mesh of a million triangles is not hashed again for each run."""


def _digest(robot: Robot) -> str:
    if robot not in _DIGESTS:
        _DIGESTS[robot] = robot_digest(robot)
    return _DIGESTS[robot]


def _rules(limits: Limits) -> Iterator[MeasuredRule]:
    yield MeasuredRule(DEFAULT, (), "", limits.fail, limits.warn)
    for i, rule in enumerate(limits.rules, start=1):
        own = limits.of_rule(i)
        yield MeasuredRule(rule.name, rule.between, rule.when, own.fail, own.warn)


def _blocks(pairs: Iterable[tuple[str, str]]) -> Iterator[MeasuredPairs]:
    """Pairs of names; first bodies that have the same second ones together."""
    seconds: dict[str, dict[str, None]] = {}
    for a, b in pairs:
        seconds.setdefault(a, {})[b] = None
    blocks: dict[tuple[str, ...], list[str]] = {}
    for a, others in seconds.items():
        blocks.setdefault(tuple(sorted(others)), []).append(a)
    for seconds_of, firsts in blocks.items():
        yield MeasuredPairs(tuple(sorted(firsts)), seconds_of)


def _measured(record: Record) -> tuple[tuple[Pair, ...], ...]:
    """The pairs of each section of each rule."""
    return tuple(pairs for rule in record.rules for pairs in rule.sections)


@once_a_cell(16)
def _measured_blocks(
    case: Case, sections: tuple[tuple[Pair, ...], ...]
) -> tuple[MeasuredPairs, ...]:
    names = (zip(*pair_names(case, pairs), strict=True) for pairs in sections)
    return tuple(_blocks(itertools.chain.from_iterable(names)))
