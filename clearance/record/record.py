"""What a run found: plain data that reports, viewers and checks read and nobody changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.record.budget import RuleBudget
from clearance.record.certificate import Certificate
from clearance.record.contact import ContactRows, StepContact
from clearance.record.every_pair import EveryPair
from clearance.record.moment import Moment
from clearance.record.names import columns_of, sides_in
from clearance.record.rows.resumable import IN_MEMORY
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import status_of
from clearance.record.steps import StepColumns
from clearance.record.table import Table
from clearance.world.case import Case, Omission
from clearance.world.made_moves import MadeMoves
from clearance.world.motion import Motion
from clearance.world.notice import Notice
from clearance.world.pairs import Pair
from clearance.world.rules import DEFAULT
from clearance.world.timeline import Timeline

if TYPE_CHECKING:
    import pyarrow as pa

CUT = "the paper's rules cut every polygon pair at every step"
"""Why the paper's method says nothing of a pair."""


@dataclass(frozen=True)
class PairMinimum:
    """The least clearance of one pair over the whole run, as far as one rule judges it.

    `link` and `obstacle` are its two bodies, whatever they are: a link, a part, an obstacle. Where it is `between`
    two steps, `step` is the one before. `proven`: a bound for the motion [m], or None.
    """

    link: str
    obstacle: str
    clearance: float  # [m]
    step: int
    time: float  # [s]
    point_link: tuple[float, float, float]  # world frame [m]
    point_obstacle: tuple[float, float, float]
    rule: str = DEFAULT
    between: bool = False
    proven: float | None = None


@dataclass(frozen=True)
class Disagreement:
    """A step at which the peer's answer differs by more than the tolerance."""

    step: int
    clearance: float  # ours [m]
    peer_clearance: float  # [m]
    link: str
    obstacle: str
    peer_link: str
    peer_obstacle: str
    reason: str


@dataclass(frozen=True)
class CrossCheck:
    """Our answers compared with a peer's, step by step.

    Attributes:
        greatest_difference: [m] over all steps.
        tolerance: [m] what counts as agreement.
        worst_witness_error: [m] greatest | |link point - obstacle point| - clearance |, and distance of a
            witness point from its body as the peer sees it.
        n_settled: steps at which exact arithmetic refutes the peer's answer and bears out ours; no disagreement.
        greatest_settled: [m] greatest difference at those.
    """

    peer: str
    n_steps: int
    greatest_difference: float
    worst_step: int
    tolerance: float
    worst_witness_error: float
    disagreements: tuple[Disagreement, ...] = ()
    n_settled: int = 0
    greatest_settled: float = 0.0

    @property
    def agrees(self) -> bool:
        """True if no step differs by more than the tolerance."""
        return not self.disagreements


@dataclass(frozen=True)
class ProfileAnswer:
    """Whether what the robot sweeps keeps to a reserved outline, and how close it comes.

    Attributes:
        passed: proven, for the continuous motion.
        contained: nothing that is swept crosses the sketch (outside, inside).
        gap: [m] proven lower bound of the gap between sweep and sketch; negative: how far the swept outline
            is beyond it. For nearest the Hausdorff distance.
        bound: [m] the true gap is at most this much larger.
        point_sweep, point_sketch: [m] in the plane, where it is attained. link, step: who swept there.
        links: names or patterns of the links that alone are judged; empty for all.
        left_out: motion, links and obstacles that the sweep does not contain, one line each.
    """

    name: str
    plane: str
    section: float | None
    mode: str
    limit: float
    passed: bool
    contained: bool
    gap: float
    bound: float
    point_sweep: tuple[float, float]
    point_sketch: tuple[float, float]
    link: str
    step: int
    links: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @property
    def kept_text(self) -> str:
        """Whether the outline is kept, in a few words."""
        in_part = ", as far as swept" if self.left_out else ""
        return f"kept{in_part}" if self.passed else "NOT KEPT"


@dataclass(frozen=True, eq=False)
class CommandedCourse:
    """The clearances of what was commanded, beside those of what was done.

    Attributes:
        times: (n,) [s]. clearances: (n,) [m] of the most critical pair at each step; NaN where there is none.
        worst: the most critical step.
    """

    times: np.ndarray
    clearances: np.ndarray
    worst: Moment


@dataclass(frozen=True, eq=False)
class Samples:
    """The steps of a run: what a peer is held against, and what sweeps a profile.

    Attributes:
        motions: one for each of `case.robots`.
        table: of `rows`, or what it is made of, where it may never be read.
        unmeasured: links and pairs that are left out, and why.
    """

    case: Case
    motions: tuple[Motion, ...]
    table: Table | StepColumns
    unmeasured: tuple[Omission, ...]

    @cached_property
    def rows(self) -> Table:
        """One row a step, as in `Record`."""
        if isinstance(self.table, StepColumns):
            return IN_MEMORY.table("table", self.table.n_steps, self.table.batches())
        return self.table

    @cached_property
    def steps(self) -> pa.Table:
        """The same as a table of pyarrow, null where a number is NaN.

        Raises:
            Unavailable: pyarrow is not installed.
        """
        return self.rows.arrow()

    @cached_property
    def sides(self) -> tuple[str, ...]:
        """The columns of `steps` that hold the names of the two bodies, then their points, x to z."""
        return columns_of(sides_in(self.rows.columns))

    @property
    def clearances(self) -> np.ndarray:
        """(n,) [m], NaN where only a bound was asked for."""
        return self.rows.numbers("clearance")


@dataclass(frozen=True, eq=False)
class Record(Samples):
    """The measured run of one case: data, and nothing that measures.

    Attributes:
        motions: one for each of `case.robots`.
        table: of `rows`, one row a step: step, time, clearance [m] (less padding, of the most critical pair
            against its rule), body_a, body_b, a_x … b_z, the rule, status ("clear" | "near" | "violated" |
            "contact", none where a bound does not decide); of one robot among obstacles that stand, link,
            obstacle, link_x … obstacle_z as well, which come first; with several rules nearest_clearance,
            nearest_a, nearest_b of the nearest pair whatever judges it; time_b where clocks are not tied;
            tracking_error when simulated; proven and expected [m] where the case has tolerances (expected NaN
            in contact); when certified, lower_bound and upper_bound of the motion from the step to the next, and
            `between`: the motion is worse there than at both of its ends, and the status is that of the motion,
            not of the step; else lower_bound of the step where `need` leaves clearances unknown (NaN);
            penetration [m] of the deepest pair in contact and volume [m3] of all, both NaN here:
            `Run.steps` fills them in.
        tally: counters by name (pairs, queries, nodes, polygons, …).
        rules: what each rule comes to; one, "default", where the case has no rules.
        timeline: when what moves how. pairs: all that were measured at some time, each once.
        worst_sample: the most critical step; without rules, the first of least
            clearance. In contact it is the deepest, as far as depth is known.
        worst: the same of the whole motion, between two steps if a certificate has found a lesser moment there.
        need: what was asked for, "steps", "pairs", "limit" or "minimum".
        every_pair: the clearance of every pair at every step, if `need` is "pairs".
        contacts: every pair in contact at every step, steps first, with the overlaps that were asked for. `worst`
            has contact between two steps, which is not among them.
        notices: what a reader of the verdict must know: of the case, and found while measuring.
        depths_asked: whether it is to be told how deep contact is.
        today: the day that waivers are held against; None where the case has none.
        budget: what the case's tolerances leave, of each of `rules`; None where the case has none.
        method: "exact" or "paper", which leaves out what is farther than `paper_tolerance` [m]; None for nothing.
        motion_kind: "kinematic", "simulated" or "recorded". commanded: of recorded motion, in its place.
        body_gaps: whether gaps that people may be caught in are to be told.
    """

    tally: dict[str, int]
    rules: tuple[RuleAnswer, ...]
    timeline: Timeline
    pairs: tuple[Pair, ...]
    worst_sample: Moment
    worst: Moment
    method: str = "exact"
    paper_tolerance: float | None = None
    motion_kind: str = "kinematic"
    cross_check: CrossCheck | None = None
    certificate: Certificate | None = None
    need: str = "steps"
    every_pair: EveryPair | None = None
    notes: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
    contacts: ContactRows | tuple[()] = ()
    profiles: tuple[ProfileAnswer, ...] = ()
    depths_asked: bool = False
    today: date | None = None
    budget: tuple[RuleBudget, ...] | None = None
    commanded: CommandedCourse | None = None
    body_gaps: bool = False

    @property
    def basis(self) -> str:
        """What the answer is of: "motion" where that is proven, else "samples"; "pose" where nothing moves."""
        if self.motions[0].n_steps == 1:
            return "pose"
        return "samples" if self.certificate is None else "motion"

    @property
    def worked_out(self) -> Iterator[StepContact]:
        """The contacts whose depth the run works out: the deepest moment of each event, all, or none."""
        return self.contacts.worked_out if isinstance(self.contacts, ContactRows) else iter(())

    @property
    def contact_notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves."""
        return self.contacts.notes if isinstance(self.contacts, ContactRows) else ()

    @cached_property
    def deepest(self) -> StepContact | None:
        """The first of the contacts worked out of greatest penetration; None without any at the steps."""
        return max(self.worked_out, key=lambda row: row.penetration, default=None)

    @property
    def worst_step(self) -> int:
        """The step of `worst_sample`."""
        return self.worst_sample.step

    @cached_property
    def nearest(self) -> Moment:
        """The moment of least clearance of all pairs, whatever judges it."""
        if self.worst.touches:
            return self.worst
        known = [rule.worst for rule in self.rules if rule.worst is not None]
        return min(known, key=lambda moment: (not moment.touches, moment.clearance))

    @cached_property
    def moves(self) -> MadeMoves:
        """The moves of its programs, by which times are named."""
        return MadeMoves.of(self.case)

    def rule(self, name: str) -> RuleAnswer:
        """What a rule that judges something comes to."""
        return next(rule for rule in self.rules if rule.name == name)

    def status_of(self, moment: Moment) -> str:
        """How a moment stands against what judges it."""
        return status_of(moment.clearance, self.rule(moment.rule).limits, moment.touches)
