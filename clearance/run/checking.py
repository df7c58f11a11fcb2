"""Answers a case: from the question, checked, over all that is found, to the record and what it comes to.

Two ways in: `check` takes a case and options by name; `answer` takes a `Question`.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

from clearance.case.case_file import load_case
from clearance.errors import BadInput
from clearance.options import made
from clearance.run.made import answered
from clearance.run.options import CheckOptions
from clearance.run.question import Question
from clearance.run.result import Run
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources
from clearance.world.case import Case


def check(
    case: Case | str | PathLike[str], *, resources: Resources = DEFAULT_RESOURCES, **options: Any
) -> Run:
    """The least clearance of every step of a case, and the proof for the motion between.

    Args:
        case: or the path of a case file.
        resources: threads, progress, and where rows are kept; the answer does not depend on them.
        options: any of `CheckOptions`, by name, as `need="limit"`, `limits=Limits(fail=0.005)`.

    Raises:
        BadInput: a value that is none, or options that do not go together; tolerances of what is not there.
        NothingToMeasure: no pair is left. TypeError: an option that is none, with the nearest name.
    """
    asked = made(CheckOptions, options)
    return answer(Question.of(case if isinstance(case, Case) else _loaded(case), asked), resources)


def answer(question: Question, resources: Resources = DEFAULT_RESOURCES) -> Run:
    """Answers a question.

    Raises:
        NothingToMeasure: no pair is left.
    """
    session = answered(question, resources)
    return Run(session.record, session, question, resources.rows)


def _loaded(path: str | PathLike[str]) -> Case:
    if not isinstance(path, str | PathLike):
        raise BadInput(
            f"a {type(path).__name__} is given", valid="a Case, or the path of a case file"
        )
    return load_case(path)
