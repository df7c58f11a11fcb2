"""Answers a case: moves the robot, measures, cross-checks, and keeps what was found together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clearance.errors import BadInput
from clearance.simulate import inside
from clearance.simulate.fingerprint import fingerprint
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.measure import NEEDS, Measurement, Progress, measure
from clearance.simulate.parts import blocks
from clearance.simulate.record import Certificate, CrossCheck, Record, StepContact
from clearance.simulate.resumable_rows import Rows
from clearance.simulate.steps import (
    PairMinima,
    cut_throughout,
    every_pair,
    status_of,
    step_table,
)
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.motion import Motion
from clearance.world.notice import Notice, worst_first
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.plausibility import notices_of
from clearance.world.reach import require_within_reach

if TYPE_CHECKING:
    import pyarrow as pa

    from clearance.report.intervals import Event
    from clearance.report.verdict import Verdict

MOTIONS = ("kinematic", "simulated")
METHODS = ("exact", "paper")
CONTACT = ("none", "events", "every")


@dataclass(frozen=True, eq=False)
class Run:
    """A case and its answer."""

    record: Record

    @property
    def steps(self) -> pa.Table:
        """One row a step; columns as in `Record.steps_with_contacts`."""
        return self.record.steps_with_contacts

    @property
    def pairs(self) -> pa.Table | None:
        """One row a step and pair: step, link, obstacle, clearance [m]; None unless that was asked for."""
        every = self.record.every_pair
        return None if every is None else every.table

    @property
    def worst(self) -> dict:
        """The moment of least clearance, as a row of `steps`; between two steps if the certificate has found a
        lesser one there: then `between` is true, and `step` the one before it."""
        moment = self.record.worst
        row = self._row(moment.step)
        if moment is self.record.worst_sample:
            return row
        ends = {"link": moment.point_link, "obstacle": moment.point_obstacle}
        told = {f"{body}_{axis}": x for body in ends for axis, x in zip("xyz", ends[body], strict=True)}
        told |= {name: getattr(moment, name) for name in ("time", "clearance", "link", "obstacle")}
        status = status_of(moment.clearance, self.record.case.limits)
        return row | told | {"between": True, "status": status}

    @property
    def worst_sample(self) -> dict:
        """The row of the first step of least clearance, with the status of that step by itself."""
        return self._row(self.record.worst_step)

    def _row(self, step: int) -> dict:
        row = self.record.steps.slice(step, 1).to_pylist()[0]
        if row.get("between"):
            known = row["clearance"]
            status = None if known is None else status_of(known, self.record.case.limits)
            row |= {"between": False, "status": status}
        return row

    @property
    def verdict(self) -> Verdict:
        """What the run comes to, why, and what that rests on."""
        from clearance.report.verdict import verdict_of

        return verdict_of(self.record)

    @property
    def passed(self) -> bool:
        """True if nothing is in contact or below the fail limit, at the steps or as far as proven between them,
        every profile is kept, no input is suspect and no peer disagrees."""
        return self.verdict.passed

    @property
    def status(self) -> str:
        """"clear", "near", "violated" or "contact", whichever is the worst; "violated" where a sweep does not keep
        to a profile of the case; "suspect" where input is in doubt and the case does not accept it."""
        return self.verdict.status

    @property
    def events(self) -> list[Event]:
        """Where a limit was entered or left, in order of time; see `report.intervals.events`."""
        from clearance.report.intervals import events

        return events(self.record)

    @property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` holds, as plain data."""
        from clearance.report import summary_of

        return summary_of(self.record)

    @property
    def certificate(self) -> Certificate | None:
        """What is proven of the motion between the steps; None where only the samples were looked at."""
        return self.record.certificate

    @property
    def cross_check(self) -> CrossCheck | None:
        """How a peer's answers compare, if that was asked for."""
        return self.record.cross_check

    def __repr__(self) -> str:
        from clearance.report.notebook import run_text

        return f"<Run {run_text(self.record)}>"

    def _repr_html_(self) -> str:
        """The verdict and the closest pairs, for a notebook."""
        from clearance.report.notebook import run_html

        return run_html(self.record)

    def save(self, folder: str | Path) -> Path:
        """Writes steps.parquet, steps.csv, summary.json and report.html into `folder`; returns it.

        Raises:
            BadInput: no path. Unwritable: nothing is left half-written.
        """
        from clearance.report import write

        if not isinstance(folder, str | PathLike) or not str(folder):
            raise BadInput(f"the folder is {folder!r:.60}", valid="a path of a folder is needed")
        write(self.record, folder)
        return Path(folder)


def check(
    case: Case | str | PathLike[str],
    *,
    need: str = "steps",
    method: str = "exact",
    motion: str = "kinematic",
    limits: Limits | None = None,
    certify: bool = True,
    certify_gap: float = CERTIFY_GAP,
    cross_check: bool = False,
    contact: str = "events",
    jobs: int | None = None,
    progress: Progress | None = None,
    kept: Rows | None = None,
    paper_tolerance: float | None = None,
) -> Run:
    """The least clearance of every step of a case.

    Args:
        case: or the path of a case file.
        need: "steps" for the clearance of every step; "pairs" for that of every pair at every step as well;
            "limit" for the steps below the warn limit, with a proven lower bound for the others;
            "minimum" for the least of all steps. The worst step is exact in each.
        method: "exact", or "paper" for the first paper's algorithm as published (no guarantee).
        motion: "kinematic" follows the trajectory exactly, "simulated" is what a physics engine's
            controlled robot makes of it.
        limits: instead of the case's.
        certify: also prove a lower bound for the motion between the steps, joints moving linearly or, where
            the trajectory has velocities, on cubics; the verdict then rests on it. Without it, and with method
            "paper", which proves nothing, the verdict is of the samples only, and says so.
        certify_gap: [m] how far that bound may be below a distance that occurs; no finer than rounding allows
            (`tolerance.FINEST_CERTIFY_GAP`), with a warning.
        cross_check: also ask FCL at every step.
        contact: of which overlaps depth, volume and way out are worked out, when they are first looked at: the
            deepest moment of each of the "events" (a pair in contact without a break), "every" one, or "none".
            The verdict does not depend on it.
        jobs: threads, as many as the machine has to offer by default; the answer does not depend on it.
        progress: called with steps done and all steps.
        kept: where the rows are kept; in memory by default. In `open_resumable_rows` memory does not grow with
            the steps, and the same question asked again goes on where an interrupted run was.
        paper_tolerance: [m] of the paper's rule 1, as `tolerance` of `distance`.

    Raises:
        BadInput: an unknown method, motion or need, or some that do not go together.
        NothingToMeasure: no pair is left.
    """
    if not isinstance(case, Case):
        case = _loaded(case)
    _require(method, METHODS, "method")
    _require(motion, MOTIONS, "motion")
    _require(need, NEEDS, "need")
    certify = certify and method == "exact"
    _require(contact, CONTACT, "contact")
    _require_tolerance(paper_tolerance, method)
    if need != "steps" and method != "exact":
        raise BadInput(f"method {method!r} measures every step", valid="need 'steps', or method 'exact'")
    if need in ("limit", "minimum") and cross_check:
        raise BadInput(f"cross-check needs every step, not {need!r}", valid="need 'steps' or 'pairs'")
    if jobs is not None and (not isinstance(jobs, int) or jobs < 1):
        raise BadInput(f"{jobs} jobs", valid="1 or more")
    if limits is not None:
        if not isinstance(limits, Limits):
            raise BadInput(f"limits are {limits!r:.60}", valid="a Limits, as Limits(fail=0.005, warn=0.02)")
        case = replace(case, limits=limits)
    case = replace(case, notices=notices_of(case))
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
            case, motions, pairs, found, certify_gap,
            need=need, jobs=jobs, progress=progress, kept=kept,
        )  # fmt: skip
    steps, let_go = _table(
        step_table(
            case,
            motions,
            pairs,
            found,
            certificate=certificate,
            with_error=motion == "simulated",
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
        notes=(*case.notes, *(note for made in motions for note in made.notes)),
        notices=_notices(case, certificate, inside.notices(case, motions, pairs) if method == "exact" else ()),
        contacts=_contacts(case, motions, pairs, found, contact),
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


def _loaded(path: str | PathLike[str]) -> Case:
    from clearance.load.case_file import load_case

    if not isinstance(path, str | PathLike):
        raise BadInput(f"a {type(path).__name__} is given", valid="a Case, or the path of a case file")
    return load_case(path)


def _notices(
    case: Case, certificate: Certificate | None, measured: Sequence[Notice]
) -> tuple[Notice, ...]:
    """All that a reader of the verdict must know: of the case, and of how it was measured."""
    proven = () if certificate is None else certificate.notices
    return worst_first([*notices_of(case), *measured, *proven])


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
    case: Case, motions: tuple[Motion, ...], pairs: list[Pair], found: Measurement, work_out: str
) -> Sequence[StepContact]:
    """What the steps in contact look like from near; loads what that needs only where there is one."""
    if not any((found.clearance[block] <= 0.0).any() for block in blocks(len(found.clearance))):
        return ()
    from clearance.simulate.contact import find_contacts

    return find_contacts(case, motions, pairs, found.clearance, found.pair, work_out)


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
