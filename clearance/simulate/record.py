"""What a run found: plain data that reports, viewers and checks read and nobody changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from clearance.simulate.parts import BLOCK
from clearance.world.case import Case, Unmeasured
from clearance.world.motion import Motion
from clearance.world.notice import Notice

if TYPE_CHECKING:
    from clearance.query.contact import Contact


@dataclass(frozen=True)
class PairMinimum:
    """The least clearance of one link-obstacle pair over the whole run."""

    link: str
    obstacle: str
    clearance: float  # [m]
    step: int
    time: float  # [s]
    point_link: tuple[float, float, float]  # world frame [m]
    point_obstacle: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class StepContact:
    """One link-obstacle pair that overlaps at one step.

    Attributes:
        numbers: the overlap in the world frame, the link its body a; without its region if there is `again`.
        again: finds all of it once more.
    """

    step: int
    time: float  # [s]
    link: str
    obstacle: str
    numbers: Contact
    again: Callable[[], Contact] | None = None

    @cached_property
    def found(self) -> Contact:
        """The overlap with its region."""
        return self.numbers if self.again is None else self.again()


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
        upper_bound: (n,) [m] the least distance seen there, at the steps or between them.
        gap: [m] how far apart the two were allowed to stay.
        tally: counters by name.
    """

    lower_bound: np.ndarray
    upper_bound: np.ndarray
    gap: float
    tally: dict[str, int]

    @property
    def worst_interval(self) -> int:
        """The first interval of the least lower bound."""
        return int(np.argmin(self.lower_bound))


@dataclass(frozen=True, eq=False)
class EveryPair:
    """The clearance of every pair at every step.

    Attributes:
        links, obstacles: (p,) names of each pair.
        clearance: (n, p) [m].
    """

    links: list[str]
    obstacles: list[str]
    clearance: np.ndarray

    @cached_property
    def table(self) -> pa.Table:
        """One row a step and pair: step, link, obstacle, clearance [m]."""
        return pa.concat_tables(self.batches()).combine_chunks()

    def batches(self) -> Iterator[pa.Table]:
        """The rows of `table`, a block of steps at a time."""
        n_steps, n_pairs = self.clearance.shape
        size = max(1, BLOCK // n_pairs)
        for start in range(0, n_steps, size):
            part = self.clearance[start : start + size]
            i_pair = pa.array(np.tile(np.arange(n_pairs, dtype=np.int32), len(part)))
            yield pa.table(
                {
                    "step": pa.array(np.repeat(np.arange(start, start + len(part)), n_pairs)),
                    "link": pa.DictionaryArray.from_arrays(i_pair, self.links),
                    "obstacle": pa.DictionaryArray.from_arrays(i_pair, self.obstacles),
                    "clearance": pa.array(part.reshape(-1)),
                }
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
        picture: SVG.
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
    picture: str


@dataclass(frozen=True, eq=False)
class Record:
    """The measured run of one case.

    Attributes:
        motions: one for each of `case.robots`.
        steps: one row a step: step, time, clearance, link, obstacle, link_x … obstacle_z, status
            ("clear" | "near" | "violated" | "contact", null where a bound does not decide),
            tracking_error when simulated, lower_bound when certified (then the status is that of the motion
            from the step to the next) or where `need` leaves clearances unknown (null; then it is proven for
            the step); penetration [m] of the deepest pair in contact and volume [m3] of all, or upper bounds
            of them, null without contact.
        pair_minima: one entry a measured pair, least clearance first; empty if `need` asks for less.
        need: what was asked for, "steps", "pairs", "limit" or "minimum".
        every_pair: the clearance of every pair at every step, if `need` is "pairs".
        tally: counters by name (pairs, queries, nodes, polygons, …).
        notices: suspect input and warnings that measuring found, beside those of the case.
        contacts: every pair in contact at every step, steps first.
        method: "exact" or "paper", which leaves out what is farther than `paper_tolerance` [m]; None for nothing.
        motion_kind: "kinematic" or "simulated".
        let_go: frees the memory of rows that are on disk; it comes back when they are looked at.
        room: tells a folder on the disk of the report for files on the way there, if there still is one.
    """

    case: Case
    motions: tuple[Motion, ...]
    steps: pa.Table
    pair_minima: Sequence[PairMinimum]
    unmeasured: tuple[Unmeasured, ...]
    tally: dict[str, int]
    method: str = "exact"
    paper_tolerance: float | None = None
    motion_kind: str = "kinematic"
    cross_check: CrossCheck | None = None
    certificate: Certificate | None = None
    need: str = "steps"
    every_pair: EveryPair | None = None
    notes: tuple[str, ...] = field(default_factory=tuple)
    notices: tuple[Notice, ...] = ()
    contacts: Sequence[StepContact] = ()
    profiles: tuple[ProfileAnswer, ...] = ()
    let_go: Callable[[], None] = lambda: None
    room: Callable[[], Path | None] = lambda: None

    @cached_property
    def deepest(self) -> StepContact | None:
        """The first contact of greatest penetration; None without contact."""
        return max(self.contacts, key=lambda row: row.numbers.penetration, default=None)

    @property
    def clearances(self) -> np.ndarray:
        """(n,) [m], NaN where only a bound was asked for."""
        return self.steps["clearance"].to_numpy()

    @property
    def worst_step(self) -> int:
        """The first step of least clearance."""
        return int(np.nanargmin(self.clearances))
