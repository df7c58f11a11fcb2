"""Answers a case: from the question, checked, over all that is found, to the record and what it comes to.

Two ways in: `check` takes a case and the usual options; `answer` takes a `Question`, which has all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from clearance.errors import BadInput
from clearance.run.answers import answered
from clearance.run.question import Question, limited
from clearance.run.result import Run
from clearance.simulate.resources import DEFAULT_RESOURCES, Resources
from clearance.world.budget import Budget
from clearance.world.case import Case, Limits

__all__ = ["Question", "Resources", "Run", "answer", "check"]


def check(
    case: Case | str | PathLike[str],
    *,
    need: str = "steps",
    limits: Limits | None = None,
    tolerance: Budget | Mapping[str, Any] | str | PathLike[str] | None = None,
    certify: bool = True,
    cross_check: bool = False,
    contact: str = "events",
    motion: str = "kinematic",
    recorded: str | PathLike[str] | None = None,
    recorded_offset: float = 0.0,
    resources: Resources = DEFAULT_RESOURCES,
) -> Run:
    """The least clearance of every step of a case, and the proof for the motion between.

    Args:
        case: or the path of a case file.
        need, certify, cross_check, contact, motion: as in `Question`, which has further options for `answer`.
        limits: instead of the case's.
        tolerance: instead of the case's: a budget, the block of a case file as plain data, or a file with it.
        recorded: with motion "recorded", a bag or a table of what the robot did. recorded_offset: [s] added to its
            times.
        resources: threads, progress, and where rows are kept; the answer does not depend on them.

    Raises:
        BadInput: an unknown motion or need, or some that do not go together; tolerances of what is not there.
        NothingToMeasure: no pair is left.
    """
    asked = limited(case if isinstance(case, Case) else _loaded(case), limits)
    if tolerance is not None:
        from clearance.load.tolerance_file import with_tolerance

        asked = with_tolerance(asked, tolerance)
    asked = _with_recorded(asked, motion, recorded, recorded_offset)
    question = Question(
        asked,
        need=need,
        certify=certify,
        cross_check=cross_check,
        contact=contact,
        motion=motion,
    )
    return answer(question, resources)


def answer(question: Question, resources: Resources = DEFAULT_RESOURCES) -> Run:
    """What a question comes to.

    Raises:
        NothingToMeasure: no pair is left.
    """
    return Run(answered(question, resources), resources.rows)


def _with_recorded(
    case: Case, motion: str, path: str | PathLike[str] | None, offset: float
) -> Case:
    """The case as it was driven, where a recording is given.

    Raises:
        BadInput: a recording of no use, or none.
    """
    if path is None and motion != "recorded":
        return case
    if path is None or motion != "recorded":
        raise BadInput(
            f"motion {motion!r} and {'no' if path is None else 'a'} recording",
            valid="motion 'recorded' and recorded: the file",
        )
    from clearance.load.recorded_run import with_recorded

    return with_recorded(case, Path(path), offset)


def _loaded(path: str | PathLike[str]) -> Case:
    from clearance.load.case_file import load_case

    if not isinstance(path, str | PathLike):
        raise BadInput(
            f"a {type(path).__name__} is given", valid="a Case, or the path of a case file"
        )
    return load_case(path)
