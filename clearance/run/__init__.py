"""Answers a case: from the question, checked, over all that is found, to the record and what it comes to.

Two ways in: `check` takes a case and the usual options; `answer` takes a `Question`, which has all of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypedDict, Unpack

from clearance.errors import BadInput, nearest_name
from clearance.run.made import answered
from clearance.run.question import Question, limited
from clearance.run.result import Run
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources
from clearance.world.budget import Budget
from clearance.world.case import Case, Limits

__all__ = ["Question", "Resources", "Run", "answer", "check"]


class CheckOptions(TypedDict, total=False):
    """The options of `check`, as in `Question`; options `recorded…` need the motion "recorded".

    Attributes:
        recorded: a bag or a table of the motion that the robot made. recorded_offset: [s] added to its times.
        recorded_gaps: how joints move in holes of the recording: "hold", "linear" or "not_measured".
        recorded_columns: the columns of a table to read; as a mapping, the column of time and of each joint.
    """

    need: str
    certify: bool
    cross_check: bool
    contact: str
    motion: str
    recorded: str | PathLike[str] | None
    recorded_offset: float
    recorded_gaps: str | None
    recorded_columns: Mapping[str, str] | Sequence[str] | None


def check(
    case: Case | str | PathLike[str],
    *,
    limits: Limits | None = None,
    tolerance: Budget | Mapping[str, Any] | str | PathLike[str] | None = None,
    resources: Resources = DEFAULT_RESOURCES,
    **options: Unpack[CheckOptions],
) -> Run:
    """The least clearance of every step of a case, and the proof for the motion between.

    Args:
        case: or the path of a case file.
        limits: instead of the case's.
        tolerance: instead of the case's: a budget, the block of a case file as plain data, or a file with it.
        resources: threads, progress, and where rows are kept; the answer does not depend on them.
        options: need, certify, cross_check, contact, motion as in `Question`, which has further ones for `answer`;
            with motion "recorded", recorded, recorded_offset, recorded_gaps and recorded_columns.

    Raises:
        BadInput: an unknown motion or need, or some that do not go together; tolerances of what is not there.
        NothingToMeasure: no pair is left. TypeError: an option that is none.
    """
    _require_options(options)
    asked = limited(case if isinstance(case, Case) else _loaded(case), limits)
    if tolerance is not None:
        from clearance.case.tolerance.tolerance_file import with_tolerance

        asked = with_tolerance(asked, tolerance)
    given: dict[str, Any] = {**options}
    path, offset = given.pop("recorded", None), given.pop("recorded_offset", 0.0)
    how = given.pop("recorded_gaps", None), given.pop("recorded_columns", None)
    asked = _with_recorded(asked, given.get("motion", "kinematic"), path, offset, *how)
    return answer(Question(asked, **given), resources)


def _require_options(options: CheckOptions) -> None:
    """Nothing, if all of them are.

    Raises:
        TypeError: with the nearest name.
    """
    for name in options:
        if name not in CheckOptions.__annotations__:
            near = nearest_name(name, CheckOptions.__annotations__)
            raise TypeError(f"check() has no option {name!r}; {near}")


def answer(question: Question, resources: Resources = DEFAULT_RESOURCES) -> Run:
    """What a question comes to.

    Raises:
        NothingToMeasure: no pair is left.
    """
    session = answered(question, resources)
    return Run(session.record, session, question, resources.rows)


def _with_recorded(
    case: Case,
    motion: str,
    path: str | PathLike[str] | None,
    offset: float,
    gaps: str | None,
    columns: Mapping[str, str] | Sequence[str] | None,
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
    from clearance.case.recorded_run import with_recorded

    return with_recorded(case, Path(path), offset, gaps=gaps, columns=columns)


def _loaded(path: str | PathLike[str]) -> Case:
    from clearance.case.case_file import load_case

    if not isinstance(path, str | PathLike):
        raise BadInput(
            f"a {type(path).__name__} is given", valid="a Case, or the path of a case file"
        )
    return load_case(path)
