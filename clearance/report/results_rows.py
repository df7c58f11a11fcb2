"""Rows of `summary.json`, as its JSON Schema has them (`results_schema`), in metres, seconds, radians."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from clearance.record.budget import ErrorSource
from clearance.record.moment import Depth
from clearance.record.sensitivity import Rate
from clearance.world.recording import JointError

Point = tuple[float, float, float]
Span = tuple[float, float]
Status = Literal["clear", "near", "violated", "contact"]


class Keys(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Moment(Keys):
    """A moment of two bodies [m, s]; `time_b` on the second body's own clock."""

    step: int
    time: float
    time_b: float | None
    between: bool
    clearance: float
    touches: bool
    depth: Depth | None
    status: Status
    rule: str
    link: str
    obstacle: str
    point_link: Point
    point_obstacle: Point
    body_a: str
    body_b: str
    point_a: Point
    point_b: Point


class Joint(Keys):
    """A joint at a moment [rad or m]."""

    robot: str
    name: str
    kind: str
    position: float
    lower: float | None
    upper: float | None


class CriticalMoment(Moment):
    """The most critical moment, with all joints."""

    joints: list[Joint]


class Sensitivity(Keys):
    """Slopes of the clearance at the most critical moment, or why there are none."""

    why_not: str | None
    pairs: list[tuple[str, str]]
    rates: list[Rate]


class Limits(Keys):
    """The limits [m] of pairs without a rule."""

    fail: float
    warn: float
    joints: Literal["warn", "fail"]


class Rule(Keys):
    """A rule [m, s]; `status` is null where it judges no pair."""

    name: str
    between: tuple[str, str] | None
    start: float | None = Field(alias="from")
    until: float | None
    while_carried: str | None
    fail: float
    warn: float
    status: Status | None
    n_pairs: int | None
    lower_bound: float | None
    worst: Moment | None
    worst_sample: Moment | None


class Suspect(Keys):
    """Suspect input that is not accepted."""

    code: str
    kind: str
    text: str


class Certified(Keys):
    """The least proven clearance of the motion [m, s]."""

    joints: Literal["linear", "cubic", "quintic", "program", "program with zones"]
    lower_bound: float
    upper_bound: float | None
    step: int
    start: float
    end: float
    allowed_gap: float
    greatest_gap: float
    not_measured: list[Span]
    not_proven: list[Span]
    is_pose: bool
    touches: bool
    tally: dict[str, int]


class Overlap(Keys):
    """An overlap of two bodies [m, m³]."""

    step: int
    time: float
    link: str
    obstacle: str
    penetration: float
    penetration_at_least: float
    exact: bool
    direction: Point
    volume: float
    volume_at_least: float
    volume_exact: bool
    centroid: Point
    notes: list[str]


class PairOverlap(Overlap):
    """The deepest overlap of a pair; `n_steps` in contact."""

    n_steps: int


class Contact(Keys):
    """The deepest overlap of all, and of each pair."""

    deepest: Overlap
    pairs: list[PairOverlap]


class Carried(Keys):
    """A part and what carries it [s]."""

    part: str
    by: str
    start: float = Field(alias="from")
    until: float
    touch: list[str]
    grasp: Literal["exact", "as driven"]


class Made(Keys):
    """A move of a robot program [s]."""

    robot: str
    name: str
    start: float = Field(alias="from")
    until: float


class Timing(Keys):
    """When a table runs [s]."""

    start: float
    rate: float
    after: str


class Actor(Keys):
    """A robot, or an obstacle that moves, rides or is carried."""

    name: str
    kind: Literal["robot", "obstacle", "part"]
    on: str | None
    self_clearance: bool = False
    between_samples: str | None
    timing: Timing | None
    absent: list[Span]


class ClockRow(Keys):
    """How clocks hang together [s]."""

    kind: Literal["common", "slack", "unsynchronised"]
    slack: float | None


class SelfClearanceRow(Keys):
    """Pairs of links of one robot."""

    robot: str
    n_pairs: int
    n_measured: int
    n_not_always: int
    left_out: dict[str, int]
    text: str


class BodyRow(Keys):
    """A body as it was loaded [m, m³]."""

    name: str
    origin: str
    triangles: int
    polygons: int
    bounding_box: tuple[Point, Point]
    excess: float
    closed: bool
    oriented: bool
    two_sided: bool
    volume: float | None
    points: int = 0
    ball_radius: float = 0.0


class RobotRow(Keys):
    """A robot as it was loaded."""

    name: str
    excluded_links: list[str]
    links: list[BodyRow]
    links_without_shape: list[str]


class Input(Keys):
    """A file that was read."""

    path: str
    sha256: str
    n_bytes: int


class TrackingError(Keys):
    """The greatest tracking error [rad or m] of a simulated or recorded run."""

    greatest: float
    step: int


class BodyGap(Keys):
    """A gap between a moving and a standing body [m, s]."""

    body_a: str
    body_b: str
    gap: float
    step: int
    time: float
    may_catch: list[str]


class Asked(Keys):
    """The critical moment of the motion that was asked for [m, s]."""

    clearance: float
    step: int
    time: float
    body_a: str
    body_b: str


class RecordedRun(Keys):
    """A recorded run beside what was asked for [s]."""

    robot: str
    path: str
    offset: float
    start: float
    end: float
    joints: list[JointError]


class Recordings(Keys):
    """Recorded runs."""

    asked: Asked
    runs: list[RecordedRun]


class ErrorMoment(Keys):
    """A moment at which tolerances leave least, with what each error takes [m, s]."""

    step: int
    time: float
    time_b: float | None
    between: bool
    body_a: str
    body_b: str
    point_a: Point
    point_b: Point
    clearance: float
    proven: float
    expected: float | None
    sources: list[ErrorSource]


class RuleLeft(Keys):
    """What tolerances leave of a rule [m]; of the pairs of a waiver apart, with its level as `fail`."""

    rule: str
    waived: tuple[str, str] | None
    fail: float
    warn: float
    keeps: bool
    proven: float
    expected: float | None
    basis: Literal["samples", "motion"]
    worst: list[ErrorMoment]


class Tolerances(Keys):
    """What tolerances leave."""

    coverage: float
    distributions: Literal["normal", "uniform"]
    unproven_ok: bool
    sources: list[str]
    lines: list[str]
    rules: list[RuleLeft]
    verdict: str
