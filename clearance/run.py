"""Answers a case: moves the robot, measures, cross-checks, and keeps what was found together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import BadInput
from clearance.simulate.certify import certify_motion
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.measure import Progress, measure
from clearance.simulate.record import CrossCheck, Record
from clearance.simulate.steps import STATUSES, PairMinima, cut_throughout, step_table
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.motion import Motion
from clearance.world.pairs import measured_pairs
from clearance.world.reach import require_within_reach

if TYPE_CHECKING:
    import pyarrow as pa

MOTIONS = ("kinematic", "simulated")
METHODS = ("exact", "paper")


@dataclass(frozen=True, eq=False)
class Run:
    """A case and its answer."""

    record: Record

    @property
    def steps(self) -> pa.Table:
        """One row a step; columns as in `Record.steps`."""
        return self.record.steps

    @property
    def worst(self) -> dict:
        """The row of the first step of least clearance."""
        return self.steps.slice(self.record.worst_step, 1).to_pylist()[0]

    @property
    def passed(self) -> bool:
        """True if no step is in contact or below the fail limit; when certified, nothing in between either."""
        return self.status not in ("violated", "contact")

    @property
    def status(self) -> str:
        """The worst status of any step: "clear", "near", "violated" or "contact"."""
        occurring = set(self.steps["status"].unique().to_pylist())
        return str([status for status in STATUSES if status in occurring][-1])

    @property
    def cross_check(self) -> CrossCheck | None:
        """How a peer's answers compare, if that was asked for."""
        return self.record.cross_check

    def save(self, folder: str | Path) -> Path:
        """Writes steps.parquet, steps.csv, summary.json and report.html into `folder`; returns it.

        Raises:
            Unwritable: nothing is left half-written.
        """
        from clearance.report import write

        return write(self.record, Path(folder))


def check(
    case: Case,
    *,
    method: str = "exact",
    motion: str = "kinematic",
    limits: Limits | None = None,
    certify: bool = False,
    certify_gap: float = CERTIFY_GAP,
    cross_check: bool = False,
    progress: Progress | None = None,
) -> Run:
    """The least clearance of every step of a case.

    Args:
        method: "exact", or "paper" for the first paper's algorithm as published (no guarantee).
        motion: "kinematic" follows the trajectory exactly, "simulated" is what a physics engine's
            controlled robot makes of it.
        limits: instead of the case's.
        certify: also prove a lower bound for the motion between the steps, joints moving linearly or, where
            the trajectory has velocities, on cubics; the verdict then rests on it.
        certify_gap: [m] how far that bound may be below a distance that occurs.
        cross_check: also ask FCL at every step.
        progress: called with steps done and all steps.

    Raises:
        BadInput: an unknown method or motion. NothingToMeasure: no pair is left.
    """
    _require(method, METHODS, "method")
    _require(motion, MOTIONS, "motion")
    if certify and method != "exact":
        raise BadInput(f"method {method!r} proves nothing to certify with", valid="method 'exact'")
    if limits is not None:
        case = replace(case, limits=limits)
    pairs, unmeasured = measured_pairs(case)
    motions = _motions(case, motion)
    require_within_reach(case, motions)
    if method == "paper":
        from clearance.simulate.measure_paper import measure_paper

        found = measure_paper(case, motions, pairs, progress)
    else:
        found = measure(case, motions, pairs, progress)
    certificate = None
    if certify:
        certificate = certify_motion(case, motions, pairs, found, certify_gap, progress)
    record = Record(
        case=case,
        motions=motions,
        steps=step_table(
            case, motions, pairs, found, certificate=certificate, with_error=motion == "simulated"
        ),
        pair_minima=PairMinima(case, motions, pairs, found),
        unmeasured=(*unmeasured, *cut_throughout(case, pairs, found)),
        tally=found.tally,
        method=method,
        motion_kind=motion,
        certificate=certificate,
        notes=(*case.notes, *(note for made in motions for note in made.notes)),
    )
    if cross_check:
        from clearance.crosscheck import cross_check as ask_peer

        record = replace(record, cross_check=ask_peer(record, progress))
    return Run(record)


def _motions(case: Case, kind: str) -> tuple[Motion, ...]:
    if kind == "kinematic":
        return tuple(kinematic_motion(placed) for placed in case.robots)
    from clearance.simulate.bullet import simulated_motion

    return tuple(
        simulated_motion(placed, case.obstacles, contact_response=case.contact_response)
        for placed in case.robots
    )


def _require(given: str, valid: tuple[str, ...], what: str) -> None:
    if given not in valid:
        raise BadInput(f"unknown {what} {given!r}", valid=f"one of {', '.join(valid)}")
