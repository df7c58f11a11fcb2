"""What a run found: plain data that reports, viewers and checks read and nobody changes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from clearance.simulate.moment import Moment
from clearance.simulate.names import LINK_AND_OBSTACLE, SIDES, columns_of, sides_in
from clearance.simulate.parts import BLOCK
from clearance.simulate.status import STATUSES, Status, status_of
from clearance.world.case import Case, Limits, Omission
from clearance.world.motion import Motion
from clearance.world.notice import Notice
from clearance.world.rules import DEFAULT
from clearance.world.timeline import Timeline

if TYPE_CHECKING:
    from clearance.query.contact import Contact
    from clearance.simulate.measure import Measurement


@dataclass(frozen=True)
class PairMinimum:
    """The least clearance of one pair over the whole run, as far as one rule judges it.

    `link` and `obstacle` are its two bodies, whatever they are: a link, a part, an obstacle.
    """

    link: str
    obstacle: str
    clearance: float  # [m]
    step: int
    time: float  # [s]
    point_link: tuple[float, float, float]  # world frame [m]
    point_obstacle: tuple[float, float, float]
    rule: str = DEFAULT


@dataclass(frozen=True, eq=False)
class StepContact:
    """One pair that overlaps at one step; `link` and `obstacle` are its two bodies, whatever they are.

    Attributes:
        known: the overlap in the world frame, `link` its body a; without its region if there is `again`; None
            where the run has not worked it out.
        again: finds all of it once more.
    """

    step: int
    time: float  # [s]
    link: str
    obstacle: str
    known: Contact | None
    again: Callable[[], Contact] | None = None

    @property
    def numbers(self) -> Contact:
        """The overlap, perhaps without its region; worked out now if it is not known."""
        return self.found if self.known is None else self.known

    @cached_property
    def found(self) -> Contact:
        """The overlap with its region."""
        if self.again is not None:
            return self.again()
        assert self.known is not None  # one of the two is always given
        return self.known


class ContactSequence(Sequence[StepContact]):
    """Every pair in contact at every step, steps first; what the run works out of them waits until it is asked."""

    @abstractmethod
    def work_out(self, progress: Callable[[int, int], None] | None = None) -> None:
        """Works out what the run asks for, once; `progress` is called with how many of how many."""

    @property
    @abstractmethod
    def worked_out(self) -> Sequence[StepContact]:
        """The rows that the run works out, steps first."""

    @property
    @abstractmethod
    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves; one line each."""


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
    """Our answers held against a peer's, step by step.

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


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proven bounds on the clearance of the continuous motion, joints moving between steps as `Motion` says.

    Attributes:
        lower_bound: (n,) [m] row i holds from step i to step i + 1; the last row for its step alone.
        upper_bound: (n,) [m] the least distance seen there, at the steps or between them; where `need` leaves
            clearances unknown, the distance that was asked about, if nothing nearer was seen.
        share, pair: (n,) where between the steps that was seen (0 to 1), and of which pair; -1 where nothing
            nearer than at the steps was.
        gap: [m] how far apart the two were allowed to stay.
        tally: counters by name.
        moment_of: measures the pair of an interval at that moment.
        notices: what a reader must know of it.
        touching: (n,) where bodies touch, if padding has lessened the bounds; None without padding.
    """

    lower_bound: np.ndarray
    upper_bound: np.ndarray
    share: np.ndarray
    pair: np.ndarray
    gap: float
    tally: dict[str, int]
    moment_of: Callable[[int], Moment]
    notices: tuple[Notice, ...] = ()
    touching: np.ndarray | None = None

    def touches(self, steps: slice) -> np.ndarray:
        """(k,) where bodies are seen to touch, at some steps or on the way to the next."""
        return self.upper_bound[steps] <= 0.0 if self.touching is None else self.touching[steps]

    @property
    def worst_interval(self) -> int:
        """The first interval of the least lower bound."""
        return int(np.argmin(self.lower_bound))

    @cached_property
    def nearest_between(self) -> int | None:
        """The first interval of the least distance seen between steps; None if all were nearest at a step."""
        seen = np.flatnonzero(self.pair >= 0)
        return int(seen[np.argmin(self.upper_bound[seen])]) if len(seen) else None

    @cached_property
    def worst(self) -> Moment | None:
        """The moment of that distance."""
        return None if self.nearest_between is None else self.moment_of(self.nearest_between)


def motion_codes(certificate: Certificate, limits: Limits, steps: slice) -> np.ndarray:
    """(k,) what is proven of the motion from each of `steps` to the next, as indices into `STATUSES`.

    Below a limit is what is not proven to stay above it; where only distances below the limit were asked about,
    what is really seen below it. Contact is what is seen.
    """
    lower, upper = certificate.lower_bound[steps], certificate.upper_bound[steps]
    seen = certificate.pair[steps] >= 0
    below = [(lower < limit) & (seen | (upper >= limit)) for limit in (limits.fail, limits.warn)]
    below[0] |= upper <= 0.0
    return np.select([certificate.touches(steps), *below], [3, 2, 1], default=0)


@dataclass(frozen=True, eq=False)
class RuleAnswer:
    """How the pairs that one rule judges stand against it.

    Attributes:
        name: of the rule, "default" for the limits that hold where no rule does.
        measurement: of all steps; pairs are those of the run. certificate: None where nothing is proven.
        moment_at: the moment of a step whose clearance is known.
    """

    name: str
    limits: Limits
    measurement: Measurement
    certificate: Certificate | None
    moment_at: Callable[[int], Moment]

    @cached_property
    def worst_sample(self) -> Moment | None:
        """The first step of least clearance; None where none is known."""
        clearance = self.measurement.clearance
        if np.isnan(clearance).all():
            return None
        touching = self.measurement.touches(slice(None))
        if self.measurement.touching is not None and touching.any():
            return self.moment_at(int(np.argmax(touching)))
        return self.moment_at(int(np.nanargmin(clearance)))

    @cached_property
    def worst(self) -> Moment | None:
        """The moment of least clearance, between two steps if a certificate has found a lesser one there."""
        return _lesser(
            self.worst_sample, None if self.certificate is None else self.certificate.worst
        )

    @cached_property
    def status(self) -> str:
        """How its worst moment stands: "clear", "near", "violated" or "contact"."""
        return (
            "clear"
            if self.worst is None
            else status_of(self.worst.clearance, self.limits, self.worst.touches)
        )

    def standing_of(self, moment: Moment) -> tuple[int, float]:
        """What moments are ordered by, the worst first: status, then how far it is above the fail limit [m]."""
        status = status_of(moment.clearance, self.limits, moment.touches)
        return -STATUSES.index(Status(status)), moment.clearance - self.limits.fail


def _lesser(known: Moment | None, between: Moment | None) -> Moment | None:
    """The one of less clearance; contact of the bodies themselves is least."""
    if known is None or between is None:
        return between if known is None else known
    if known.touches:
        return known
    return between if between.touches or between.clearance < known.clearance else known


@dataclass(frozen=True, eq=False)
class EveryPair:
    """The clearance of every pair at every step.

    Attributes:
        links, obstacles: (p,) names of the two bodies of each pair.
        clearance: (n, p) [m]; NaN where a pair is not measured at a step.
        sides: what the first columns of the run's tables call the two bodies.
        by_rule: (n, p) [m] of each rule, by its name, the clearances that it judges, NaN elsewhere.
    """

    links: list[str]
    obstacles: list[str]
    clearance: np.ndarray
    sides: tuple[str, str] = LINK_AND_OBSTACLE
    by_rule: tuple[tuple[str, np.ndarray], ...] = ()

    @cached_property
    def table(self) -> pa.Table:
        """One row a step and pair: step, link and obstacle (where all steps have them), clearance [m] (null where
        the pair is not measured), body_a, body_b, and the rule that judges it."""
        return pa.concat_tables(self.batches()).combine_chunks()

    def batches(self) -> Iterator[pa.Table]:
        """The rows of `table`, a block of steps at a time."""
        n_steps, n_pairs = self.clearance.shape
        size = max(1, BLOCK // n_pairs)
        for start in range(0, n_steps, size):
            part = self.clearance[start : start + size]
            names = [_repeated(each, len(part)) for each in (self.links, self.obstacles)]
            columns = {
                "step": pa.array(np.repeat(np.arange(start, start + len(part)), n_pairs)),
                self.sides[0]: names[0],
                self.sides[1]: names[1],
                "clearance": pa.array(part.reshape(-1), from_pandas=True),
            }
            columns |= dict(zip(SIDES, names, strict=True))
            yield pa.table(columns | {"rule": self._rules(slice(start, start + len(part)))})

    def _rules(self, steps: slice) -> pa.DictionaryArray:
        """What judges each row of some steps; of two the one of less clearance; null where nothing does."""
        names = [name for name, _ in self.by_rule] or [DEFAULT]
        part = self.clearance[steps]
        codes = np.zeros(part.shape, dtype=np.int32)
        if len(names) > 1:
            own = np.array([clearance[steps] for _, clearance in self.by_rule])
            codes = np.argmin(np.where(np.isnan(own), np.inf, own), axis=0).astype(np.int32)
        indices = pa.array(codes.reshape(-1), mask=np.isnan(part).reshape(-1))
        return pa.DictionaryArray.from_arrays(indices, pa.array(names, pa.string()))


def _repeated(names: Sequence[str], times: int) -> pa.DictionaryArray:
    """All names, so many times over.

    Each is in the dictionary once: pyarrow writes one that has a name twice with room for both, and what it leaves
    empty is whatever lay in memory there.
    """
    codes = {name: code for code, name in enumerate(dict.fromkeys(names))}
    indices = np.array([codes[name] for name in names], dtype=np.int32)
    return pa.DictionaryArray.from_arrays(
        pa.array(np.tile(indices, times)), pa.array([*codes], pa.string())
    )


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
        picture: draws it as SVG, when a report asks for it.
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
    picture: Callable[[], str]


@dataclass(frozen=True, eq=False)
class Samples:
    """The steps of a run: what a peer is held against, and what sweeps a profile.

    Attributes:
        motions: one for each of `case.robots`.
        steps: one row a step, as in `Record`.
        unmeasured: links and pairs that are left out, and why.
    """

    case: Case
    motions: tuple[Motion, ...]
    steps: pa.Table
    unmeasured: tuple[Omission, ...]

    @cached_property
    def sides(self) -> tuple[str, ...]:
        """The columns of `steps` that hold the names of the two bodies, then their points, x to z."""
        return columns_of(sides_in(self.steps.column_names))

    @property
    def clearances(self) -> np.ndarray:
        """(n,) [m], NaN where only a bound was asked for."""
        return self.steps["clearance"].to_numpy()


@dataclass(frozen=True, eq=False)
class Record(Samples):
    """The measured run of one case.

    Attributes:
        motions: one for each of `case.robots`.
        steps: one row a step: step, time, clearance [m] (less padding, of the pair that stands worst against its
            rule), body_a, body_b, a_x … b_z, the rule, status ("clear" | "near" | "violated" | "contact", null
            where a bound does not decide); of one robot among obstacles that stand, link, obstacle, link_x …
            obstacle_z as well, which come first; with several rules nearest_clearance, nearest_a, nearest_b of
            the nearest pair whatever judges it; time_b where clocks are not tied;
            tracking_error when simulated; when certified, lower_bound and upper_bound of the motion from the step
            to the next, and `between`: the motion is worse there than at both of its ends, and the status is that
            of the motion, not of the step; else lower_bound of the step where `need` leaves clearances unknown
            (null); penetration [m] of the deepest pair in contact and volume [m3] of all, both null here and
            filled in by `steps_with_contacts`.
        pair_minima: one entry a measured pair, least clearance first; empty if `need` asks for less.
        need: what was asked for, "steps", "pairs", "limit" or "minimum".
        every_pair: the clearance of every pair at every step, if `need` is "pairs".
        tally: counters by name (pairs, queries, nodes, polygons, …).
        contacts: every pair in contact at every step, steps first; what the run works out of them is worked out
            when it is first looked at.
        notices: what a reader of the verdict must know: of the case, and found while measuring.
        rules: what each rule comes to; one, "default", where the case has no rules.
        timeline: when what moves how.
        method: "exact" or "paper", which leaves out what is farther than `paper_tolerance` [m]; None for nothing.
        motion_kind: "kinematic" or "simulated".
    """

    pair_minima: Sequence[PairMinimum]
    tally: dict[str, int]
    rules: tuple[RuleAnswer, ...]
    timeline: Timeline
    method: str = "exact"
    paper_tolerance: float | None = None
    motion_kind: str = "kinematic"
    cross_check: CrossCheck | None = None
    certificate: Certificate | None = None
    need: str = "steps"
    every_pair: EveryPair | None = None
    notes: tuple[str, ...] = field(default_factory=tuple)
    notices: tuple[Notice, ...] = ()
    contacts: ContactSequence | tuple[()] = ()
    profiles: tuple[ProfileAnswer, ...] = ()

    def work_out_contacts(self, progress: Callable[[int, int], None] | None = None) -> None:
        """Works out now what the run asks for of its contacts; `progress` is called with how many of how many."""
        if isinstance(self.contacts, ContactSequence) and len(self.contacts):
            self.contacts.work_out(progress)

    @property
    def worked_out(self) -> Sequence[StepContact]:
        """The contacts whose depth the run works out: the deepest moment of each event, all, or none."""
        return self.contacts.worked_out if isinstance(self.contacts, ContactSequence) else ()

    @property
    def contact_notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves."""
        return self.contacts.notes if isinstance(self.contacts, ContactSequence) else ()

    @cached_property
    def deepest(self) -> StepContact | None:
        """The first of the contacts worked out of greatest penetration; None without any."""
        return max(self.worked_out, key=lambda row: row.numbers.penetration, default=None)

    @cached_property
    def steps_with_contacts(self) -> pa.Table:
        """`steps` with penetration and volume where all pairs in contact at a step are worked out, upper bounds if
        not exact; null at all others."""
        from clearance.simulate.contact_columns import with_contact_columns

        return with_contact_columns(self.steps, self.contacts)

    @property
    def worst_step(self) -> int:
        """The first step that stands worst against what judges it."""
        return self.worst_sample.step

    @cached_property
    def worst_sample(self) -> Moment:
        """The step that stands worst against what judges it; without rules, the first of least clearance."""
        return self._worst({rule: rule.worst_sample for rule in self.rules})

    @cached_property
    def worst(self) -> Moment:
        """The same of the whole motion, between two steps if a certificate has found a lesser moment there."""
        return self._worst({rule: rule.worst for rule in self.rules})

    @staticmethod
    def _worst(moments: dict[RuleAnswer, Moment | None]) -> Moment:
        standing = [
            (rule.standing_of(moment), i, moment)
            for i, (rule, moment) in enumerate(moments.items())
            if moment is not None
        ]
        return min(standing, key=lambda row: row[:2])[2]

    @cached_property
    def nearest(self) -> Moment:
        """The moment of least clearance of all pairs, whatever judges it."""
        known = [rule.worst for rule in self.rules if rule.worst is not None]
        return min(known, key=lambda moment: (not moment.touches, moment.clearance))

    def rule(self, name: str) -> RuleAnswer:
        """What a rule that judges something comes to."""
        return next(rule for rule in self.rules if rule.name == name)

    def status_of(self, moment: Moment) -> str:
        """How a moment stands against what judges it."""
        return status_of(moment.clearance, self.rule(moment.rule).limits, moment.touches)
