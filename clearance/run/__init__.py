"""Answers a case: from the question, checked, over all that is found, to the record and what it comes to."""

from __future__ import annotations

from os import PathLike

from clearance.errors import BadInput
from clearance.run.answers import answered
from clearance.run.question import Means, Question, limited
from clearance.run.result import Run
from clearance.simulate.measure import Progress
from clearance.simulate.resumable_rows import MeasuredRows
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits

__all__ = ["Run", "check"]


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
    kept: MeasuredRows | None = None,
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
    question = Question(
        limited(case if isinstance(case, Case) else _loaded(case), limits),
        need=need,
        method=method,
        motion=motion,
        certify=certify,
        certify_gap=certify_gap,
        cross_check=cross_check,
        contact=contact,
        paper_tolerance=paper_tolerance,
    )
    means = Means(jobs, progress, kept or MeasuredRows())
    return Run(answered(question, means), means.rows)


def _loaded(path: str | PathLike[str]) -> Case:
    from clearance.load.case_file import load_case

    if not isinstance(path, str | PathLike):
        raise BadInput(
            f"a {type(path).__name__} is given", valid="a Case, or the path of a case file"
        )
    return load_case(path)
