"""The options of a check, each declared once; command line, Python, batch, pytest and the guide are made of them.

Not for: how an option is declared and read (`clearance.options`), and answering (`answers`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clearance.errors import BadInput, Contradiction
from clearance.options import (
    DAY,
    FILE,
    LENGTH,
    NAME,
    POSITIVE_LENGTH,
    SECONDS,
    SWITCH,
    Sort,
    check_values,
    one_of,
    option,
    options_in,
)
from clearance.tolerance import CERTIFY_GAP
from clearance.world.notice import GAPS, KINDS, accepted_kind

if TYPE_CHECKING:
    from clearance.world.budget import Budget
    from clearance.world.case import Case, Limits
    from clearance.world.rules import Waiver

KIND = Sort("KIND|CODE", "a kind of suspect input or of a warning, or its code", accepted_kind)
NEEDS = ("steps", "pairs", "limit", "minimum")
MOTIONS = ("kinematic", "simulated", "recorded")
METHODS = ("exact", "paper")
CONTACT = ("none", "events", "every")


def _limits(given: Any) -> Limits:
    from clearance.world.case import Limits

    if not isinstance(given, Limits):
        raise TypeError(given)
    return given


def _tolerance(given: Any) -> Budget | Mapping[str, Any] | Path:
    from clearance.world.budget import Budget

    return given if isinstance(given, Budget | Mapping) else FILE.of_value(given)


def _waivers(given: Any) -> Waiver | Path:
    from clearance.world.rules import Waiver

    return given if isinstance(given, Waiver) else FILE.of_value(given)


def _columns(given: Any) -> tuple[tuple[str, str], ...]:
    """Each joint, or time, with its column."""
    pairs = given.items() if isinstance(given, Mapping) else list(given)
    found = [(one, one) if isinstance(one, str) else one for one in pairs]
    if isinstance(given, str) or not found:
        raise TypeError(given)
    return tuple((NAME.of_value(name), NAME.of_value(column)) for name, column in found)


def _columns_of_text(text: str) -> list[tuple[str, str]]:
    found = []
    for part in text.split(","):
        name, separator, column = (one.strip() for one in part.partition("="))
        if separator and not column:
            raise ValueError(part)
        found.append((name, column or name))
    return found


LIMITS = Sort("", "a Limits, as Limits(fail=0.005, warn=0.02)", _limits)
TOLERANCE = Sort("FILE", "a mapping, the path of a file, or a Budget", _tolerance)
WAIVERS = Sort("FILE", "the path of a file, or a Waiver", _waivers)
COLUMNS = Sort("A,B=C,…", "columns such as time,elbow=q3", _columns, _columns_of_text)

RECORDED = ("motion", "recorded")

CASE_SUFFIXES = (".clearance.yaml", ".clearance.yml")
"""Of the files that pytest collects, and that `clearance pre-commit` looks for: cases, or lists of them."""

USUAL = {"need": "limit"}
"""Defaults that are others where many cases are checked."""


@dataclass(frozen=True, kw_only=True)
class QuestionOptions:
    """The options that say what is answered of a case.

    Attributes:
        need: "steps" for the clearance of every step; "pairs" for that of every pair at every step as well;
            "limit" for the steps below the warn limit, with a proven lower bound for the others;
            "minimum" for the least of all steps. The worst step is exact in each.
        certify: also prove a lower bound for the motion between the steps, joints moving linearly or, where
            the trajectory has velocities, on cubics; the verdict then rests on it. Without it, and with method
            "paper", which proves nothing, the verdict is of the samples only, and says so.
        certify_gap: [m] how far that bound may be below a distance that occurs; no finer than rounding allows
            (`tolerance.FINEST_CERTIFY_GAP`), with a warning.
        contact: of which overlaps depth, volume and separation vector are computed, once they are looked at: the
            deepest moment of each of the "events" (a pair in contact without a break), "every" one, or "none".
            No status depends on it; the worst moment of bodies in contact is the deepest that is worked out.
        body_gaps: tell which gaps between what moves and what else there is are of a width that parts of a person
            may be caught in; no verdict depends on it.
        cross_check: also ask FCL at every step.
        method: "exact", or "paper" for the first paper's algorithm as published (no guarantee).
        paper_tolerance: [m] of the paper's rule 1, as `tolerance` of `distance`.
        motion: "kinematic" follows the trajectory exactly, "simulated" is what a physics engine's
            controlled robot makes of it, "recorded" what a robot really did, of a case with a recording.
        today: the day that the case's waivers are held against; that of the clock, in UTC, if not given; None
            where it has none.

    Raises:
        BadInput: a value that is none, with the option; some that do not go together.
    """

    need: str = option(
        "steps", one_of(NEEDS),
        "How much to compute; the verdict is the same. steps: every step. pairs: every pair at every step too "
        "(pairs.parquet). limit: steps below the warn limit, a bound for the rest. minimum: the worst moment.",
    )  # fmt: skip
    certify: bool = option(
        True, SWITCH, "Prove the motion between the samples, or measure the samples only.",
        off="samples_only",
    )  # fmt: skip
    certify_gap: float = option(
        CERTIFY_GAP, POSITIVE_LENGTH, "Greatest gap between the proven bound and a distance that occurs.",
        flag="certify-mm", needs=("certify", True),
    )  # fmt: skip
    contact: str = option(
        "events", one_of(CONTACT),
        "Compute penetration depth for none, for the deepest moment of each contact (events), or for every step.",
    )  # fmt: skip
    body_gaps: bool = option(
        False, SWITCH, "Report gaps that can trap parts of a body, by the widths of ISO 13854."
    )
    cross_check: bool = option(False, SWITCH, "Compare every step with FCL.")
    method: str = option(
        "exact", one_of(METHODS),
        "exact: the true minimum. paper: the published algorithm of Lim et al. for comparison, without guarantee.",
    )  # fmt: skip
    paper_tolerance: float | None = option(
        None, POSITIVE_LENGTH, "Distance beyond which method paper leaves pairs of polygons out, its rule 1.",
        needs=("method", "paper"),
    )  # fmt: skip
    motion: str = option(
        "kinematic", one_of(MOTIONS),
        "kinematic: the trajectory itself. simulated: a simulated robot that follows it. recorded: a real run.",
    )  # fmt: skip
    today: date | None = option(
        None, DAY, "Day on which waivers are judged; today in UTC if not given."
    )

    def __post_init__(self) -> None:
        check_values(self)
        if self.body_gaps and self.need not in ("steps", "pairs"):
            fault = f"body gaps need the least of every pair, not {self.need!r}"
            raise Contradiction(fault, valid="need 'steps' or 'pairs'")
        if self.need != "steps" and self.method != "exact":
            fault = f"method {self.method!r} measures every step"
            raise Contradiction(fault, valid="need 'steps', or method 'exact'")
        if self.need in ("limit", "minimum") and self.cross_check:
            fault = f"cross-check needs every step, not {self.need!r}"
            raise Contradiction(fault, valid="need 'steps' or 'pairs'")


@dataclass(frozen=True, kw_only=True)
class CheckOptions(QuestionOptions):
    """All options of a check: what is answered, and what is changed of the case first.

    Attributes:
        limits: instead of the case's. fail, warn: [m] instead of the case's; rules that give one keep theirs.
        accept: kinds of suspect input that decide no verdict, and of warnings, beside the case's.
        fail_on_warning: a warning that is not accepted fails the run.
        tolerance: instead of the case's: a file, the block of a case file as plain data, or a budget.
        unproven_ok: a limit that is kept, but not proven with the tolerances, does not fail the run.
        waivers: beside the case's: files of them, then waivers.
        recorded: a bag or a table of the motion that a robot made, for motion "recorded".
        recorded_offset: [s] added to its times, which are else taken as they are. recorded_robot: whose run it is.
        recorded_gaps: how joints move in holes of it: "hold", "linear" or "not_measured".
        recorded_columns: of a table the columns to read; as a mapping, the column of time and of each joint.
    """

    limits: Limits | None = option(None, LIMITS, "Limits instead of the case's.", said=False)
    fail: float | None = option(
        None, LENGTH, "Fail limit instead of the case's; rules with a limit of their own keep it."
    )
    warn: float | None = option(
        None, LENGTH, "Warn limit instead of the case's; rules with a limit of their own keep it."
    )
    accept: tuple[str, ...] = option(
        (),
        KIND,
        f"Accept suspect input of this kind ({', '.join(KINDS)}), or warnings of this code.",
        many=True,
    )
    fail_on_warning: bool = option(
        False, SWITCH, "Fail (exit code 1) by any warning that is not accepted."
    )
    tolerance: Budget | Mapping[str, Any] | Path | None = option(
        None, TOLERANCE, "Tolerances of the real machine, instead of the case's."
    )
    unproven_ok: bool = option(
        False, SWITCH, "Pass limits that are kept, but not proven with the tolerances."
    )
    waivers: tuple[Waiver | Path, ...] = option(
        (), WAIVERS, "Waivers beside the case's.", many=True
    )
    recorded: Path | None = option(
        None, FILE, "Recorded run: a bag of joint states, or a CSV.", needs=RECORDED
    )
    recorded_offset: float | None = option(
        None, SECONDS, "Offset to add to the times of the recorded run [s]; else they are taken as they are.",
        needs=RECORDED,
    )  # fmt: skip
    recorded_robot: str | None = option(
        None,
        NAME,
        "Robot that made the recorded run, of several with trajectories.",
        needs=RECORDED,
    )
    recorded_gaps: str | None = option(
        None, one_of(GAPS),
        "Motion of joints in a hole of the recorded run: hold the position, go straight, or leave the hole out of "
        "the check; if not given, a hole is suspect input.",
        needs=RECORDED,
    )  # fmt: skip
    recorded_columns: Any = option(
        None, COLUMNS, "Columns of the recorded table to read, no others: time, joints, or joint=column.",
        needs=RECORDED,
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.motion == "recorded" and self.recorded is None:
            valid = "motion 'recorded' needs the file of a recorded run"
            raise BadInput("nothing is given", where="recorded", valid=valid)

    @property
    def files(self) -> dict[str, tuple[Path, ...]]:
        """The files that are named, by option."""
        known = options_in(CheckOptions)
        values = {name: getattr(self, name) for name, one in known.items() if one.is_of_files}
        listed = {name: one if known[name].many else (one,) for name, one in values.items()}
        return {name: tuple(p for p in one if isinstance(p, Path)) for name, one in listed.items()}

    def apply(self, case: Case) -> Case:
        """The case with all that these options change of it; nothing else changes a case before it is answered.

        Raises:
            BadInput: a file of no use for this case; a warn limit below the fail limit; no tolerances that
                `unproven_ok` could be of.
        """
        limits = with_levels(self.limits or case.limits, self.fail, self.warn)
        accept = tuple(dict.fromkeys([*case.accept, *self.accept]))
        fails = case.fail_on_warning or self.fail_on_warning
        if (limits, accept, fails) != (case.limits, case.accept, case.fail_on_warning):
            case = replace(case, limits=limits, accept=accept, fail_on_warning=fails)
        case = self._with_recording(self._with_tolerance(self._with_waivers(case)))
        if not self.unproven_ok:
            return case
        if case.tolerance is None:
            raise BadInput("the case has no tolerances", where="unproven_ok")
        return replace(case, tolerance=replace(case.tolerance, unproven_ok=True))

    def _with_waivers(self, case: Case) -> Case:
        if not self.waivers:
            return case
        from clearance.case.waiver_file import with_waivers
        from clearance.world.rules import Waiver

        case = with_waivers(case, self.files["waivers"])
        made = [one for one in self.waivers if isinstance(one, Waiver)]
        return replace(case, waivers=(*case.waivers, *made)) if made else case

    def _with_tolerance(self, case: Case) -> Case:
        if self.tolerance is None:
            return case
        from clearance.case.tolerance.tolerance_file import with_tolerance

        return with_tolerance(case, self.tolerance)

    def _with_recording(self, case: Case) -> Case:
        if self.recorded is None:
            return case
        from clearance.case.recorded_run import with_recorded

        columns = None if self.recorded_columns is None else dict(self.recorded_columns)
        return with_recorded(
            case,
            self.recorded,
            self.recorded_offset or 0.0,
            self.recorded_robot,
            self.recorded_gaps,
            columns,
        )


def with_levels(limits: Limits, fail: float | None, warn: float | None) -> Limits:
    """The limits with other levels [m]; None leaves one as it is.

    Raising `fail` alone takes `warn` along, a rule's too that gives no `fail` of its own.

    Raises:
        BadDimension: a warn limit below the fail limit.
    """
    if fail is None and warn is None:
        return limits
    fail = limits.fail if fail is None else fail
    rules = tuple(
        replace(rule, warn=max(rule.warn, fail))
        if rule.fail is None and rule.warn is not None
        else rule
        for rule in limits.rules
    )
    warn = max(limits.warn, fail) if warn is None else warn
    return replace(limits, fail=fail, warn=warn, rules=rules)
