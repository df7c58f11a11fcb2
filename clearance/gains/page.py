"""A gain as a page: both curves, what moved by how much, both worst moments, what is proven.

Not for: the sentences (`sentences`), nor the replays, which are in the reports beside it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from clearance.gains.answer import Gain
from clearance.gains.change_parts import (
    ChangePart,
    change_parts,
    joint_parts,
    proven_after,
    proven_bound,
)
from clearance.gains.sentences import is_hopeless, lines_of, signed_text, size_text
from clearance.record.wording import limit_mm, mm, moment_text, seconds
from clearance.report.comparison_page import curve_of
from clearance.report.markup import element, section, table
from clearance.report.plain_page import ClearanceCurve, CurvesWithLimit, plain_page
from clearance.run import Run

NAMES = ("before", "after")


def page_of(gain: Gain, notes: Sequence[str] = (), *, with_reports: bool) -> str:
    """The whole page.

    Args:
        notes: on how the case was written. with_reports: those of before and after lie beside it.
    """
    content = [
        _curves(gain),
        _moved(gain),
        _worst_moments(gain),
        _reports(gain) if with_reports else _no_reports(),
        _notes(gain, notes),
    ]
    title = f"{gain.case.name}: {_badge(gain)}"
    return plain_page(title, _header(gain), Markup("").join(content), _chart(gain))


def _chart(gain: Gain) -> CurvesWithLimit:
    runs = (gain.before, gain.after)
    curves = [motion_curve(name, run) for name, run in zip(NAMES, runs, strict=True)]
    fail = max(run.record.rule(run.record.worst.rule).limits.fail for run in runs)
    called = "with margin" if gain.request.margin else "fail"
    return CurvesWithLimit(curves, fail + gain.request.margin, called)


def _header(gain: Gain) -> Markup:
    kicker = element("p", f"Least change of kind {gain.request.kind}", class_="kicker")
    title = element("div", kicker, element("h1", gain.case.name))
    badge = element("p", _badge(gain), class_=f"verdict {'clear' if gain.kept else 'violated'}")
    lines = [
        element("li", f"{label[0].upper()}{label[1:]}: {line}")
        for label, line in lines_of(gain)
        if label not in ("before", "after", "reached")
    ]
    return element("div", title, badge, class_="title") + element("ul", *lines, class_="beside")


def _badge(gain: Gain) -> str:
    if not gain.kept:
        return "not kept"
    return f"kept, changed by {size_text(gain)}" if gain.size else "kept as it is"


def _curves(gain: Gain) -> Markup:
    key = [
        element("span", element("i"), name, class_=letter)
        for letter, name in zip("ab", NAMES, strict=True)
    ]
    picture = element("div", id="curves", class_="plot")
    what = element(
        "p",
        "Least clearance at each step, and between steps where it is lower or steps are far apart in time"
        + (f"; the line is the limit with the margin of {limit_mm(gain.request.margin)} mm."
           if gain.request.margin else "; the line is the limit."),
        class_="faint",
    )  # fmt: skip
    return section("Clearance over time", picture, element("div", *key, class_="key"), what)


def motion_curve(name: str, run: Run) -> ClearanceCurve:
    """The curve of a run, with the moments between its steps that are known."""
    steps, moments = curve_of(name, run.record.steps), run.session.curve_moments()
    times = np.append(steps.times, [moment.time for moment in moments])
    clearances = np.append(steps.clearances, [moment.clearance for moment in moments])
    order = np.argsort(times, kind="stable")
    return ClearanceCurve(name, times[order], clearances[order])


def _moved(gain: Gain) -> Markup:
    parts = change_parts(gain)
    if not parts or gain.size == 0.0:
        return section("What is changed", element("p", "Nothing is changed."))
    if gain.request.kind == "waypoints":
        return section("What is changed", _joints(parts))
    rows = [
        element("tr", element("td", _what(gain, part)), _number(signed_text(part)))
        for part in parts
    ]
    if gain.request.kind != "timing":
        rows.append(
            element(
                "tr",
                element("td", "length" if gain.request.turn is None else "size"),
                _number(size_text(gain)),
            )
        )
    shifted = table((f"{gain.who}", ">By"), rows)
    if gain.tool_path is None:
        return section("What is changed", shifted)
    return section("What is changed", shifted, _joints(joint_parts(gain)))


def _joints(parts: Sequence[ChangePart]) -> Markup:
    heads = ("Joint", ">Greatest offset", ">At", ">From", ">Until")
    return table(heads, [_joint(part) for part in parts])


def _what(gain: Gain, part: ChangePart) -> str:
    if part.unit == "rad":
        return part.name
    if gain.request.slow_down:
        return "takes longer"
    return "begins later" if gain.request.kind == "timing" else f"along {part.name}"


def _joint(part: ChangePart) -> Markup:
    times = [part.time, part.start, part.end]
    cells = [_number(seconds(time)) for time in times if time is not None]
    return element("tr", element("td", part.name), _number(signed_text(part)), *cells)


def _number(text: str) -> Markup:
    return element("td", text, class_="number")


def _worst_moments(gain: Gain) -> Markup:
    proven = (proven_bound(gain.before), proven_after(gain))
    runs = (gain.before, gain.after)
    rows = [_worst(*one) for one in zip(NAMES, runs, proven, strict=True)]
    heads = (
        "Run",
        ">Clearance, mm",
        ">Fail below, mm",
        "Between",
        "When",
        "Verdict",
        ">Proven, mm",
    )
    return section("Worst moments", table(heads, rows, "findings"))


def _worst(name: str, run: Run, proven: float | None) -> Markup:
    worst = run.record.worst
    fail = run.record.rule(worst.rule).limits.fail
    return element(
        "tr",
        element("td", name, style="white-space: nowrap"),
        _number(mm(worst.clearance)),
        _number(limit_mm(fail)),
        element("td", f"{worst.link} and {worst.obstacle}", class_="wide"),
        element("td", moment_text(worst), class_="wide"),
        element("td", element("span", run.status, class_=f"tag {run.status}")),
        _number("" if proven is None else mm(proven)),
    )


def _reports(gain: Gain) -> Markup:
    both = " of both motions" if gain.size > 0.0 else ""
    links = [
        element(
            "li",
            element("a", f"the report {name}, with its replay{what}", href=f"{name}/report.html"),
        )
        for name, what in zip(NAMES, ("", both), strict=True)
    ]
    return section("Both motions", element("ul", *links, class_="beside"))


def _no_reports() -> Markup:
    told = "The reports with the replays are left out: what draws them is not installed here."
    return section("Both motions", element("p", told))


def _of_bound(gain: Gain) -> str:
    if is_hopeless(gain):
        return "That no change of this kind is enough is proven."
    if gain.kept and gain.size == 0.0:
        return "That every rule holds as it is is proven."
    if gain.lower_bound <= 0.0:
        return "The search is local: smaller changes are not excluded."
    return "The bound is proven. The search is local: smaller changes, down to the bound, are not excluded."


def _notes(gain: Gain, notes: Sequence[str]) -> Markup:
    told = [
        _of_bound(gain),
        "case.yaml is the changed case, with the limits of the one that it is from; gain.json has all figures.",
        *notes,
    ]  # fmt: skip
    return section("What this rests on", *(element("p", line, class_="faint") for line in told))
