"""What the page says first: verdict, worst moment, events, and the least clearance of every pair.

Each function returns one piece of HTML made from the summary. An attribute `data-step` marks what
moves the replay when it is clicked.
"""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from clearance.findings.finding import NOT_PROVEN
from clearance.findings.of_budget import NOT_WORKED_OUT
from clearance.findings.verdict import ACCEPTED, STALE, verdict_text
from clearance.record.moment import Depth
from clearance.record.wording import (
    count,
    depth_text,
    joint_value,
    least_proven,
    limits_text,
    mm,
    other_time,
    seconds,
)
from clearance.report.background import certainty, loaded, provenance, sign_off, unmeasured
from clearance.report.body_gaps import body_gaps
from clearance.report.cell_time import cell_time
from clearance.report.contact import contacts
from clearance.report.markup import (
    element,
    moment_link,
    section,
    step_link,
    table,
)
from clearance.report.matrix import matrix
from clearance.report.profiles import profiles
from clearance.report.recordings import recordings
from clearance.report.rules import name_shown, rules
from clearance.report.sensitivity import sensitivity_table
from clearance.report.tolerance_section import tolerances

MAX_EVENT_ROWS = 200
"""Most events printed on the page; all are in `summary.json`."""

NOTHING = Markup("")

_TITLES = {
    "clear": "clear",
    "near": "near miss",
    "violated": "limit violated",
    "contact": "contact",
    "suspect": "suspect input",
    STALE: STALE,
    NOT_PROVEN: NOT_PROVEN,
}


def header(summary: dict[str, Any]) -> Markup:
    """Name, verdict, what puts it in doubt, the moment that stands worst, limits."""
    facts = [
        *_worst_facts(summary),
        ("Certified", _certified_word(summary["certified"])),
        *_limit_facts(summary),
        ("Measured", f"{_extent(summary)}, {summary['motion']} motion"),
        ("Cross-check", _cross_check_word(summary["cross_check"])),
    ]
    signed = summary["sign_off"] or {}
    facts += [(name.capitalize(), value) for name, value in signed.items() if value]
    items = [element("div", element("dt", name), element("dd", value)) for name, value in facts]
    title = element(
        "div", element("p", "Clearance report", class_="kicker"), element("h1", summary["name"])
    )
    badge = element("p", badge_text(summary), class_=f"verdict {_badge_class(summary)}")
    return (
        element("div", title, badge, class_="title")
        + _headline(summary)
        + _beside(summary)
        + element("dl", *items, class_="facts")
    )


def _worst_facts(summary: dict[str, Any]) -> list[tuple[str, object]]:
    worst = summary["worst"]
    name = "Least clearance" if summary["nearer"] is None else "Worst against its rule"
    near = element("strong", mm(worst["clearance"])) + " mm"
    if worst["touches"]:
        name, near = "Deepest contact", element("strong", depth_of(worst))
    return [
        (name, near),
        ("Between", f"{worst['link']} and {worst['obstacle']}"),
        ("At", moment_of(worst)),
    ]


def depth_of(moment: dict[str, Any]) -> str:
    """How deep bodies are in each other at a moment, given as plain data."""
    return depth_text(None if moment["depth"] is None else Depth(**moment["depth"]))


def _limit_facts(summary: dict[str, Any]) -> list[tuple[str, object]]:
    if len(summary["rules"]) == 1:
        limits = summary["limits"]
        return [("Limits", limits_text(limits["fail"], limits["warn"]))]
    rule = next(one for one in summary["rules"] if one["name"] == summary["worst"]["rule"])
    limits = limits_text(rule["fail"], rule["warn"])
    return [("Judged by", name_shown(rule["name"])), ("Its limits", limits)]


def _headline(summary: dict[str, Any]) -> Markup:
    """What stands worst against which rule, and what is nearest if that is something else; where there are
    rules."""
    if len(summary["rules"]) == 1:
        return Markup("")
    worst = summary["worst"]
    told = next(iter(summary["reasons"]), None) if worst["status"] != "clear" else None
    lines = [element("li", told, class_=f"text-{worst['status']}")] if told else []
    lines += [element("li", f"Nearest of all: {summary['nearer']}")] if summary["nearer"] else []
    return element("ul", *lines, class_="beside headline") if lines else Markup("")


def badge_text(summary: dict[str, Any]) -> str:
    """The verdict in a few words."""
    status, measured, basis, disputed_by, clocks, n_waivers = (
        summary[name]
        for name in ("verdict", "measured", "basis", "disputed_by", "clocks", "n_waivers")
    )
    title = _TITLES.__getitem__
    given = summary.get("tolerances", {}).get("verdict", "")
    text = verdict_text(status, measured, basis, disputed_by, clocks, n_waivers, title, given)
    return text[0].upper() + text[1:]


def _badge_class(summary: dict[str, Any]) -> str:
    failing = summary["disputed_by"] or summary["verdict"] in (STALE, NOT_PROVEN)
    return "violated" if failing else summary["verdict"]


def _beside(summary: dict[str, Any]) -> Markup:
    """What a reader must know beside the clearance, right below the verdict."""
    rows = [
        element("li", f"Suspect {one['kind']}: {one['text']}", class_="text-suspect")
        for one in summary["suspects"]
    ]
    failing = [*(f"Violated: {text}" for text in summary["broken"])]
    failing += [text[0].upper() + text[1:] for text in summary["stale"]]
    rows += [element("li", text, class_="text-violated") for text in failing]
    rows += [element("li", f"Waived: {text}", class_="text-near") for text in summary["waived"]]
    rows += _with_tolerances(summary)
    doubts = [text for text in (summary["at_level"], summary["unproven"]) if text]
    doubts += [f"Warning: {text}" for text in summary["warnings"]]
    rows += [element("li", text[0].upper() + text[1:], class_="text-near") for text in doubts]
    measured = [one["text"] for one in summary["self_clearance"]]
    rows += [element("li", text[0].upper() + text[1:]) for text in measured]
    rows += [element("li", f"{name.capitalize()} not checked") for name in summary["not_checked"]]
    return element("ul", *rows, class_="beside") if rows else Markup("")


def _with_tolerances(summary: dict[str, Any]) -> list[Markup]:
    """What the tolerances leave, a line a rule; marked where a limit is not proven with them."""
    told = summary.get("tolerances")
    if told is None:
        return []
    marked = told["verdict"] in (NOT_PROVEN, ACCEPTED)
    lines = told["lines"] or [f"{NOT_WORKED_OUT[0].upper()}{NOT_WORKED_OUT[1:]}."]
    return [element("li", line, class_="text-violated" if marked else None) for line in lines]


def _certified_word(certified: dict[str, Any] | None) -> str:
    if certified is None:
        return "no, looked at the samples only"
    return least_proven(certified)


def moment_of(worst: dict[str, Any]) -> str:
    """When a moment of the summary is."""
    step = f"step {worst['step']:,}"
    if worst["between"]:
        step = f"between the steps {worst['step']:,} and {worst['step'] + 1:,}"
    return f"{seconds(worst['time'])}, {step}{other_time(worst['obstacle'], worst['time_b'])}"


_EXTENTS = {
    "steps": "",
    "pairs": ", each pair at each step",
    "limit": ", exactly below the warn limit, elsewhere a proven bound",
    "minimum": ", for their minimum only",
}


def _extent(summary: dict[str, Any]) -> str:
    measured = {(pair["link"], pair["obstacle"]) for pair in summary["pairs"]}  # a row a rule
    pairs = f", {count(len(measured), 'pair')}" if measured else ""
    return count(summary["n_steps"], "step") + pairs + _EXTENTS[summary["need"]]


def _cross_check_word(check: dict[str, Any] | None) -> str:
    if check is None:
        return "not asked for"
    return f"agrees with {check['peer']}" if check["agrees"] else f"disagrees with {check['peer']}"


def sections(
    summary: dict[str, Any], pictures: dict[str, str], findings: Markup = NOTHING
) -> Markup:
    """All sections under the replay.

    Args:
        pictures: SVG of each profile by its name. findings: their section.
    """
    return Markup("").join(
        [
            element(
                "div",
                worst_moment(summary),
                element("div", events(summary), certainty(summary)),
                class_="columns",
            ),
            recordings(summary),
            tolerances(summary),
            body_gaps(summary),
            findings,
            rules(summary),
            cell_time(summary),
            contacts(summary),
            profiles(summary, pictures),
            matrix(summary),
            unmeasured(summary),
            loaded(summary),
            provenance(summary),
            sign_off(summary["sign_off"]),
        ]
    )


def worst_moment(summary: dict[str, Any]) -> Markup:
    """The joint values and witness points of the worst step."""
    worst = summary["worst"]
    several = len({joint["robot"] for joint in worst["joints"]}) > 1
    rows = [
        element(
            "tr",
            element("td", f"{joint['robot']} / {joint['name']}" if several else joint["name"]),
            element("td", joint_value(joint["kind"], joint["position"]), class_="number"),
            element("td", _range_bar(joint)),
        )
        for joint in worst["joints"]
    ]
    points = [
        element(
            "tr",
            element("td", f"on {worst[body]}"),
            *[
                element("td", f"{value * 1000:.3f}", class_="number")
                for value in worst[f"point_{body}"]
            ],
        )
        for body in ("link", "obstacle")
    ]
    near = depth_of(worst) if worst["touches"] else f"{mm(worst['clearance'])} mm"
    return section(
        "Worst moment",
        element(
            "p",
            f"{near} between {worst['link']} and {worst['obstacle']} at ",
            moment_link(worst, moment_of(worst)),
            ".",
        ),
        *_nearest(summary),
        *_worst_sample(summary),
        table(("Joint", ">Position", "In its range"), rows, tall=True) if rows else Markup(""),
        table(("Witness point", ">x, mm", ">y, mm", ">z, mm"), points),
        sensitivity_table(summary["sensitivity"], several_robots=several),
    )


def _nearest(summary: dict[str, Any]) -> list[Markup]:
    """The least clearance of all, where something else stands worse against its rule."""
    if summary["nearer"] is None:
        return []
    nearest = summary["nearest"]
    text = f"Nearest of all are {nearest['link']} and {nearest['obstacle']}: {mm(nearest['clearance'])} mm at "
    by = f", judged by {name_shown(nearest['rule'])}: {nearest['status']}."
    return [element("p", text, moment_link(nearest, moment_of(nearest)), by)]


def _worst_sample(summary: dict[str, Any]) -> list[Markup]:
    """The least clearance at the steps, where that between them is less."""
    sample = summary["worst_sample"]
    if not summary["worst"]["between"]:
        return []
    least = "least" if len(summary["rules"]) == 1 else "worst"
    text = f"At the steps the {least} is {mm(sample['clearance'])} mm between {sample['link']} and "
    return [element("p", text, f"{sample['obstacle']}, ", step_link(sample["step"]), ".")]


def _range_bar(joint: dict[str, Any]) -> Markup:
    """Where in its limits a joint stands, as a bar; a word where it has none."""
    lower, upper = joint["lower"], joint["upper"]
    if lower is None or upper is None or upper <= lower:
        return element("span", "no limits", class_="faint")
    share = (joint["position"] - lower) / (upper - lower)
    if not 0.0 <= share <= 1.0:
        return element("span", "outside its limits", class_="text-violated")
    ends = f"{joint_value(joint['kind'], lower)} to {joint_value(joint['kind'], upper)}"
    mark = element("i", style=f"left:{100 * share:.1f}%")
    return element("span", mark, class_="range", title=ends)


def events(summary: dict[str, Any]) -> Markup:
    """When limits were entered and left."""
    found = summary["events"]
    if not found:
        where = "at any moment" if summary["certified"] else "at any step"
        return section("Events", element("p", f"No limit was entered {where}."))
    rows = [
        element(
            "tr",
            element("td", seconds(event["time"]), class_="number"),
            element("td", f"{event['step']:,}{'+' if event['between'] else ''}", class_="number"),
            element("td", event["what"]),
            *_event_cells(event, several=len(summary["rules"]) > 1),
            data_step=event["step"],
            data_time=event["time"] if event["between"] else None,
            tabindex=0,
        )
        for event in found[:MAX_EVENT_ROWS]
    ]
    more = len(found) - len(rows)
    unlisted = summary["not_listed"]["events"]
    told = [f"{count(more, 'more event')} in summary.json."] if more else []
    told += (
        [f"{count(unlisted, 'more event')} follow from the status in steps.csv."]
        if unlisted
        else []
    )
    if any(event["between"] for event in found):
        told.append("A step with + is the one before a moment between two steps.")
    notes = [element("p", text, class_="faint") for text in told]
    heads = [">Time", ">Step", "What", ">mm", ">Least, mm", "Between"]
    heads += ["Rule"] if len(summary["rules"]) > 1 else []
    return section("Events", table(heads, rows, class_="clickable", tall=True), *notes)


def _event_cells(event: dict[str, Any], *, several: bool) -> list[Markup]:
    least = "" if event["least"] is None else mm(event["least"])
    if event["clearance"] is None:
        figures, who = ("", least), "not measured further"
    else:
        figures, who = (mm(event["clearance"]), least), f"{event['link']} - {event['obstacle']}"
    now, until = (element("td", figure, class_="number") for figure in figures)
    rule = [element("td", name_shown(event["rule"]))] if several else []
    return [now, until, element("td", who), *rule]
