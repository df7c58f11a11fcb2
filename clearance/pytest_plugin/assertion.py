"""`assert_clear`: that two bodies keep their distance over a run, with a message to act on.

Not for: collecting cases (`collected`).
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from clearance.errors import ClearanceError

if TYPE_CHECKING:
    from clearance.run import Run


def assert_clear(
    run: Run, between: tuple[str, str] | None = None, at_least: float | None = None
) -> None:
    """Nothing, if bodies keep a clearance over the motion, as far as proven; at the samples where nothing is.

    With `between` or `at_least` that is proven, whatever the run is; a warning names pairs that are excluded or
    excused, and links of one robot that are not measured against one another. Another says what stands in the
    headline beside the verdict, as time that is not measured, and the warnings of the run.

    Args:
        run: of `check`, or of the fixture `clearance_case`.
        between: patterns of names of two bodies, in any order; all pairs if not given.
        at_least: [m]; the fail limit of the rule that judges each pair if not given. Without it and `between`, the
            run is passed. With either, input must not be suspect, no peer may disagree and programs must be
            proven all the same, and where the case has tolerances what they leave of the pairs is proven to keep
            it. `unproven_ok` of the case excuses its own limits only, not `at_least`.

    Raises:
        AssertionError: what comes nearer, how near, when, and what was asked for; or why the input is in doubt.
        BadInput: no pair is measured between such bodies, with the nearest name.
    """
    __tracebackhide__ = True
    try:
        faults = _faults(run, between, at_least)
    except ClearanceError as error:  # the frame of the test is enough
        raise error.with_traceback(None) from None
    if faults:
        raise AssertionError("\n".join([f"{run.record.case.name} is not clear", *faults]))
    warn_beside(run)


def warn_beside(run: Run) -> None:
    """Warns of what a reader must know beside a run that passes: words of the headline, and warnings."""
    verdict = run.verdict
    headline = verdict.headline()
    if verdict.warnings or headline not in (
        verdict.measured,
        f"{verdict.measured} with tolerances",
    ):
        text = "; ".join([f"{run.record.case.name}: {headline}", *verdict.warnings])
        warnings.warn(text, stacklevel=3)


def _faults(run: Run, between: tuple[str, str] | None, at_least: float | None) -> list[str]:
    if between is None and at_least is None:
        return _reasons(run)
    from clearance.pytest_plugin.kept import faults_of, left_out_of
    from clearance.world.notice import listed

    pairs = between or ("*", "*")
    faults = [*_doubts(run), *faults_of(run, pairs, at_least)]
    if left_out := left_out_of(run, pairs):
        text = f"{pairs[0]} - {pairs[1]}: not measured are {listed(left_out)}"
        warnings.warn(text, stacklevel=3)
    return faults


def _reasons(run: Run) -> list[str]:
    verdict = run.verdict
    return [] if verdict.passed else [verdict.headline(), *verdict.reasons]


def _doubts(run: Run) -> list[str]:
    """Why what was measured is not to be trusted, whichever pair is asked about."""
    verdict = run.verdict
    lines = [f"suspect {one.kind}: {one.line}" for one in verdict.suspects]
    lines += [*verdict.unproven_motion, *verdict.warned]
    return lines if verdict.disputed_by is None else [*lines, f"{verdict.disputed_by} disagrees"]
