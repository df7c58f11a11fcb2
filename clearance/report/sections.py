"""What the page says first: verdict, worst moment, events, and the least clearance of every pair.

Each function returns one piece of HTML made from the summary. An attribute `data-step` marks what
moves the replay when it is clicked.
"""

from __future__ import annotations

from typing import Any

from clearance.report.background import certainty, loaded, provenance, unmeasured
from clearance.report.contact import contacts
from clearance.report.markup import Html, element, section, step_link, table
from clearance.report.profiles import profiles
from clearance.report.wording import count, joint_value, limit_mm, mm, seconds

MAX_EVENT_ROWS = 200
"""Most events printed on the page; all are in `summary.json`."""

_TITLES = {"clear": "Clear", "near miss": "Near miss", "violated": "Limit violated"}
_CLASSES = {"clear": "clear", "near miss": "near", "violated": "violated"}


def header(summary: dict[str, Any]) -> Html:
    """Name, verdict, least clearance, limits."""
    worst, limits = summary["worst"], summary["limits"]
    facts = [
        ("Least clearance", Html(f"<strong>{mm(worst['clearance'])}</strong> mm")),
        ("Between", f"{worst['link']} and {worst['obstacle']}"),
        ("At", f"{seconds(worst['time'])}, step {worst['step']:,}"),
        (
            "Limits",
            f"fail below {limit_mm(limits['fail'])} mm, warn below {limit_mm(limits['warn'])} mm",
        ),
        (
            "Measured",
            f"{_extent(summary)}, {summary['motion']} motion",
        ),
        ("Cross-check", _cross_check_word(summary["cross_check"])),
    ]
    items = [element("div", element("dt", name), element("dd", value)) for name, value in facts]
    kind = _CLASSES[summary["verdict"]]
    return element(
        "div",
        element(
            "div", element("p", "Clearance report", class_="kicker"), element("h1", summary["name"])
        ),
        element("p", _TITLES[summary["verdict"]], class_=f"verdict {kind}"),
        class_="title",
    ) + element("dl", *items, class_="facts")


_EXTENTS = {
    "steps": "",
    "pairs": ", each pair at each step",
    "limit": ", exactly below the warn limit, elsewhere a proven bound",
    "minimum": ", for their minimum only",
}


def _extent(summary: dict[str, Any]) -> str:
    pairs = f", {count(len(summary['pairs']), 'pair')}" if summary["pairs"] else ""
    return count(summary["n_steps"], "step") + pairs + _EXTENTS[summary["need"]]


def _cross_check_word(check: dict[str, Any] | None) -> str:
    if check is None:
        return "not asked for"
    return f"agrees with {check['peer']}" if check["agrees"] else f"disagrees with {check['peer']}"


def sections(summary: dict[str, Any], pictures: dict[str, str]) -> Html:
    """All sections under the replay; `pictures`: SVG of each profile by its name."""
    return Html(
        "".join(
            [
                element(
                    "div",
                    worst_moment(summary),
                    element("div", events(summary), certainty(summary)),
                    class_="columns",
                ),
                contacts(summary),
                profiles(summary, pictures),
                matrix(summary),
                unmeasured(summary),
                loaded(summary),
                provenance(summary),
            ]
        )
    )


def worst_moment(summary: dict[str, Any]) -> Html:
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
    return section(
        "Worst moment",
        element(
            "p",
            f"{mm(worst['clearance'])} mm between {worst['link']} and {worst['obstacle']} at "
            f"{seconds(worst['time'])}, ",
            step_link(worst["step"]),
            ".",
        ),
        table(("Joint", ">Position", "In its range"), rows),
        table(("Witness point", ">x, mm", ">y, mm", ">z, mm"), points),
    )


def _range_bar(joint: dict[str, Any]) -> Html:
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


def events(summary: dict[str, Any]) -> Html:
    """When limits were entered and left."""
    found = summary["events"]
    if not found:
        return section("Events", element("p", "No limit was entered at any step."))
    rows = [
        element(
            "tr",
            element("td", seconds(event["time"]), class_="number"),
            element("td", f"{event['step']:,}", class_="number"),
            element("td", event["what"]),
            *_event_cells(event),
            data_step=event["step"],
            tabindex=0,
        )
        for event in found[:MAX_EVENT_ROWS]
    ]
    more = len(found) - len(rows)
    note = element("p", f"{count(more, 'more event')} in summary.json.") if more else Html("")
    unlisted = summary["not_listed"]["events"]
    if unlisted:
        note += element("p", f"{count(unlisted, 'more event')} follow from the status in steps.csv.")
    heads = (">Time", ">Step", "What", ">mm", "Between")
    return section("Events", table(heads, rows, class_="clickable"), note)


def _event_cells(event: dict[str, Any]) -> tuple[Html, Html]:
    if event["clearance"] is None:
        return element("td", "", class_="number"), element("td", "not measured further")
    return (
        element("td", mm(event["clearance"]), class_="number"),
        element("td", f"{event['link']} - {event['obstacle']}"),
    )


def matrix(summary: dict[str, Any]) -> Html:
    """Least clearance of each link and obstacle in mm, coloured by the limits; nothing if not asked for."""
    if not summary["pairs"]:
        return Html("")
    cells = {(pair["link"], pair["obstacle"]): pair for pair in summary["pairs"]}
    links = [body["name"] for robot in summary["robots"] for body in robot["links"]]
    links = [name for name in dict.fromkeys(links) if any(name == link for link, _ in cells)]
    obstacles = [body["name"] for body in summary["obstacles"]]
    obstacles = [name for name in obstacles if any(name == other for _, other in cells)]
    head = element(
        "tr",
        element("td", ""),
        *[element("th", element("span", name), scope="col") for name in obstacles],
    )
    rows = [
        element(
            "tr",
            element("th", link, scope="row"),
            *[_matrix_cell(cells.get((link, name)), summary["limits"]) for name in obstacles],
        )
        for link in links
    ]
    body = element("table", element("thead", head), element("tbody", *rows), class_="matrix")
    return section(
        "Least clearance of every pair, mm",
        element("div", body, class_="scroll"),
        element(
            "p",
            "Rounded down. A click moves the replay to the step where that pair comes closest; "
            "\N{EN DASH} marks a pair that was not measured.",
            class_="faint",
        ),
    )


def _matrix_cell(pair: dict[str, Any] | None, limits: dict[str, float]) -> Html:
    if pair is None:
        return element("td", "\N{EN DASH}", class_="none")
    title = (
        f"{pair['link']} - {pair['obstacle']}: {mm(pair['clearance'])} mm, step {pair['step']}, "
        f"{seconds(pair['time'])}"
    )
    return element(
        "td",
        mm(pair["clearance"]),
        class_=f"cell {_shade(pair['clearance'], limits)}",
        data_step=pair["step"],
        tabindex=0,
        title=title,
    )


def _shade(clearance: float, limits: dict[str, float]) -> str:
    if clearance <= 0.0:
        return "contact"
    if clearance < limits["fail"]:
        return "violated"
    if clearance < limits["warn"]:
        return "near"
    return next(
        (f"far{i}" for i, bound in enumerate((0.05, 0.1, 0.2, 0.4, 0.8)) if clearance < bound),
        "far5",
    )
