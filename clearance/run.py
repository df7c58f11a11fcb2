"""Answers a case: moves the robot, measures, cross-checks, and keeps what was found together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import BadInput
from clearance.simulate import inside
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.measure import NEEDS, Measurement, Progress, measure
from clearance.simulate.parts import blocks
from clearance.simulate.question import fingerprint
from clearance.simulate.record import CrossCheck, Record, StepContact
from clearance.simulate.spool import Rows
from clearance.simulate.steps import (
    STATUSES,
    PairMinima,
    cut_throughout,
    every_pair,
    step_table,
)
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.motion import Motion
from clearance.world.pairs import Pair, measured_pairs
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
    def pairs(self) -> pa.Table | None:
        """One row a step and pair: step, link, obstacle, clearance [m]; None unless that was asked for."""
        every = self.record.every_pair
        return None if every is None else every.table

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
        """The worst status of any step: "clear", "near", "violated" or "contact"; "violated" where a sweep
        does not keep to a profile of the case."""
        occurring = set(self.steps["status"].unique().to_pylist())
        if not all(answer.passed for answer in self.record.profiles):
            occurring.add("violated")
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
    need: str = "steps",
    method: str = "exact",
    motion: str = "kinematic",
    limits: Limits | None = None,
    certify: bool = False,
    certify_gap: float = CERTIFY_GAP,
    cross_check: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
    kept: Rows | None = None,
    paper_tolerance: float | None = None,
) -> Run:
    """The least clearance of every step of a case.

    Args:
        need: "steps" for the clearance of every step; "pairs" for that of every pair at every step as well;
            "limit" for the steps below the warn limit, with a proven lower bound for the others;
            "minimum" for the least of all steps. The worst step is exact in each.
        method: "exact", or "paper" for the first paper's algorithm as published (no guarantee).
        motion: "kinematic" follows the trajectory exactly, "simulated" is what a physics engine's
            controlled robot makes of it.
        limits: instead of the case's.
        certify: also prove a lower bound for the motion between the steps, joints moving linearly or, where
            the trajectory has velocities, on cubics; the verdict then rests on it.
        certify_gap: [m] how far that bound may be below a distance that occurs.
        cross_check: also ask FCL at every step.
        jobs: threads, as many as the machine has to offer by default; the answer does not depend on it.
        progress: called with steps done and all steps.
        kept: where the rows are kept; in memory by default. In a spool (`open_spool`) memory does not grow with
            the steps, and the same question asked again goes on where an interrupted run was.
        paper_tolerance: [m] of the paper's rule 1, as `tolerance` of `distance`.

    Raises:
        BadInput: an unknown method, motion or need, or some that do not go together.
        NothingToMeasure: no pair is left.
    """
    _require(method, METHODS, "method")
    _require(motion, MOTIONS, "motion")
    _require(need, NEEDS, "need")
    _require_tolerance(paper_tolerance, method)
    if certify and method != "exact":
        raise BadInput(f"method {method!r} proves nothing to certify with", valid="method 'exact'")
    if need != "steps" and method != "exact":
        raise BadInput(f"method {method!r} measures every step", valid="need 'steps', or method 'exact'")
    if need in ("limit", "minimum") and (certify or cross_check):
        other = "certify" if certify else "cross-check"
        raise BadInput(f"{other} needs every step, not {need!r}", valid="need 'steps' or 'pairs'")
    if jobs is not None and jobs < 1:
        raise BadInput(f"{jobs} jobs", valid="1 or more")
    if limits is not None:
        case = replace(case, limits=limits)
    pairs, unmeasured = measured_pairs(case)
    motions = _motions(case, motion)
    require_within_reach(case, motions)
    kept = kept or Rows()
    if kept.folder is not None:
        options = (need, method, motion, certify, certify_gap, paper_tolerance)
        kept.ask(fingerprint(case, motions, pairs, options))
    if method == "paper":
        from clearance.query.paper import NO_TOLERANCE
        from clearance.simulate.measure_paper import measure_paper

        found = measure_paper(case, motions, pairs, progress, paper_tolerance or NO_TOLERANCE)
    else:
        found = measure(case, motions, pairs, need, jobs=jobs, progress=progress, kept=kept)
    certificate = None
    if certify:
        from clearance.simulate.certify import certify_motion

        certificate = certify_motion(
            case, motions, pairs, found, certify_gap, jobs=jobs, progress=progress, kept=kept
        )
    contacts, contact_notes = _contacts(case, motions, pairs, found)
    steps, let_go = _table(
        step_table(
            case,
            motions,
            pairs,
            found,
            certificate=certificate,
            with_error=motion == "simulated",
            contacts=contacts,
        ),
        kept,
    )
    record = Record(
        case=case,
        motions=motions,
        steps=steps,
        pair_minima=PairMinima(case, motions, pairs, found),
        unmeasured=(*unmeasured, *cut_throughout(case, pairs, found)),
        tally=found.tally,
        method=method,
        paper_tolerance=paper_tolerance,
        motion_kind=motion,
        need=need,
        every_pair=every_pair(case, pairs, found),
        certificate=certificate,
        notes=(*case.notes, *(note for made in motions for note in made.notes), *contact_notes),
        notices=inside.notices(case, motions, pairs) if method == "exact" else (),
        contacts=contacts,
        let_go=let_go,
        room=lambda: kept.folder,
    )
    if case.profiles:
        from clearance.profiles.answer import answer_profiles

        record = replace(record, profiles=answer_profiles(record))
    if cross_check:
        from clearance.crosscheck import cross_check as ask_peer

        record = replace(record, cross_check=ask_peer(record, progress))
    return Run(record)


def _table(batches: Iterator[pa.Table], kept: Rows) -> tuple[pa.Table, Callable[[], None]]:
    """The batches as one table, on disk if the rows are, and a way to free the memory that it takes there."""
    import pyarrow as pa

    if kept.folder is None:
        return pa.concat_tables(batches), kept.let_go
    from clearance.simulate.table_file import mapped_table

    table, let_go = mapped_table(_letting_go(batches, kept), kept.folder / "steps.arrow")

    def let_all_go() -> None:
        kept.let_go()
        let_go()

    return table, let_all_go


def _letting_go(batches: Iterator[pa.Table], kept: Rows) -> Iterator[pa.Table]:
    for batch in batches:
        yield batch
        kept.let_go()


def _contacts(
    case: Case, motions: tuple[Motion, ...], pairs: list[Pair], found: Measurement
) -> tuple[Sequence[StepContact], tuple[str, ...]]:
    """What the steps in contact look like from near; loads what that needs only where there is one."""
    if not any((found.clearance[block] <= 0.0).any() for block in blocks(len(found.clearance))):
        return (), ()
    from clearance.simulate.contact import find_contacts

    return find_contacts(case, motions, pairs, found.clearance, found.pair)


def _motions(case: Case, kind: str) -> tuple[Motion, ...]:
    if kind == "kinematic":
        return tuple(kinematic_motion(placed) for placed in case.robots)
    from clearance.simulate.bullet import simulated_motion

    return tuple(
        simulated_motion(placed, case.obstacles, contact_response=case.contact_response)
        for placed in case.robots
    )


def _require_tolerance(tolerance: float | None, method: str) -> None:
    if tolerance is None:
        return
    if method != "paper":
        raise BadInput(f"method {method!r} has no tolerance", valid="only method 'paper' has one")
    from clearance.query.paper import checked_tolerance

    checked_tolerance(tolerance)


def _require(given: str, valid: tuple[str, ...], what: str) -> None:
    if given not in valid:
        raise BadInput(f"unknown {what} {given!r}", valid=f"one of {', '.join(valid)}")
