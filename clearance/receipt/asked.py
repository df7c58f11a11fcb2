"""The options of a run beside its case's files, written to a receipt and read back to run the case again.

Whoever wrote the receipt chose these options. So `changed_options` names each one that changes how the case is
judged. Not for: answering (`run`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from clearance.errors import BadSyntax, NoReceipt, shown
from clearance.receipt.case_data import require_covered
from clearance.receipt.receipt_file import DAMAGED, REMEDY
from clearance.run import CheckOptions, Question
from clearance.world.case import Case

OF_THE_CASE = ("levels", "accept", "unproven_ok", "fail_on_warning")
"""Fields of a case that a command line can change."""

NOT_RECORDED = ("case", "inside")


def asked_of(question: Question) -> dict[str, Any]:
    """The options of a run, as plain data for JSON."""
    case = question.case
    options = {one.name: getattr(question, one.name) for one in fields(question)}
    recorded = {name: value for name, value in options.items() if name not in NOT_RECORDED}
    recorded["today"] = None if question.today is None else question.today.isoformat()
    levels = [case.limits.fail, case.limits.warn]
    of_the_case = (levels, list(case.accept), _unproven_ok(case), case.fail_on_warning)
    return recorded | dict(zip(OF_THE_CASE, of_the_case, strict=True))


def question_of(case: Case, asked: dict[str, Any]) -> Question:
    """The question of a case that `asked_of` has written.

    Raises:
        BadInput: it is no such data, or asks for a run without receipts.
    """
    options = {name: value for name, value in asked.items() if name not in OF_THE_CASE}
    try:
        fail, warn = asked["levels"]
        own = {"accept": asked["accept"], "unproven_ok": asked["unproven_ok"]}
        own["fail_on_warning"] = asked.get("fail_on_warning", False)
        question = Question.of(case, CheckOptions(fail=fail, warn=warn, **own, **options))
    except (KeyError, TypeError, ValueError, AttributeError):
        raise BadSyntax(DAMAGED, valid=REMEDY) from None
    refuse_uncovered(question)
    return question


def refuse_uncovered(question: Question) -> None:
    """Refuses a run for which no receipt can be written.

    Raises:
        BadInput: why not.
    """
    for given, needed, what in (
        (question.method, "exact", f"of the method {question.method}"),
        (question.certify, True, "of a run that is not certified"),
        (question.inside, True, "of a run that does not look for bodies inside others"),
    ):
        if given != needed:
            raise NoReceipt(f"no receipt {what}", valid=f"{needed}")
    if question.motion != "kinematic":
        raise NoReceipt(
            f"no receipt of {question.motion} motion: it proves commanded motion alone",
            valid="kinematic motion",
        )
    require_covered(question.case)


def changed_options(case: Case, question: Question, files: tuple[str, ...]) -> tuple[str, ...]:
    """The options that change the verdict beside the case's own files, in words.

    Args:
        case: as its file has it. files: that were given besides.
    """
    return tuple(_changed_options(case, question, files))


def _changed_options(case: Case, question: Question, files: tuple[str, ...]) -> Iterator[str]:
    own, limits = case.limits, question.case.limits
    for level in ("fail", "warn"):
        here, there = getattr(limits, level), getattr(own, level)
        if here != there:
            yield f"{level} {here * 1e3:g} mm, not the case's {there * 1e3:g} mm"
    accepted = [kind for kind in question.case.accept if kind not in case.accept]
    if accepted:
        yield f"accepted for this run: {shown(', '.join(accepted))}"
    if _unproven_ok(question.case) and not _unproven_ok(case):
        yield "limits not proven with tolerances are accepted"
    if files:
        yield f"with {', '.join(map(shown, files))}"
    if question.today is not None:
        yield f"waivers as of {question.today}"


def _unproven_ok(case: Case) -> bool:
    return case.tolerance is not None and case.tolerance.unproven_ok
