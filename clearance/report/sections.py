"""What the page says first: verdict, worst moment, events, and the least clearance of every pair.

Each function returns one piece of HTML made from the summary. An attribute `data-step` marks what
moves the replay when it is clicked.
"""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from clearance.report.background import certainty, loaded, provenance, sign_off, unmeasured
from clearance.report.contact import contacts
from clearance.report.markup import (
    element,
    moment_link,
    section,
    step_link,
    table,
)
from clearance.report.profiles import profiles
from clearance.report.verdict import verdict_text
from clearance.report.wording import count, joint_value, limit_mm, mm, seconds

MAX_EVENT_ROWS = 200
"""Most events printed on the page; all are in `summary.json`."""

_TITLES = {
    "clear": "clear",
    "near": "near miss",
    "violated": "limit violated",
    "contact": "contact",
    "suspect": "suspect input",
}


def header(summary: dict[str, Any]) -> Markup:
    """Name, verdict, what puts it in doubt, least clearance, limits."""
    limits = summary["limits"]
    facts = [
        ("Least clearance", element("strong", mm(summary["worst"]["clearance"])) + " mm"),
        ("Certified", _certified_word(summary["certified"])),
        ("Between", f"{summary['worst']['link']} and {summary['worst']['obstacle']}"),
        ("At", moment_of(summary["worst"])),
        (
            "Limits",
            f"fail below {limit_mm(limits['fail'])} mm, warn below {limit_mm(limits['warn'])} mm",
        ),
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
        + _beside(summary)
        + element("dl", *items, class_="facts")
    )


def badge_text(summary: dict[str, Any]) -> str:
    """The verdict in a few words."""
    status, measured, basis, disputed_by = (
        summary[name] for name in ("verdict", "measured", "basis", "disputed_by")
    )
    text = verdict_text(status, measured, basis, disputed_by, shown=_TITLES.__getitem__)
    return text[0].upper() + text[1:]


def _badge_class(summary: dict[str, Any]) -> str:
    return "violated" if summary["disputed_by"] else summary["verdict"]


def _beside(summary: dict[str, Any]) -> Markup:
    """What a reader must know beside the clearance, right below the verdict."""
    rows = [
        element("li", f"Suspect {one['kind']}: {one['text']}", class_="text-suspect")
        for one in summary["suspects"]
    ]
    rows += [
        element("li", f"Violated: {text}", class_="text-violated") for text in summary["broken"]
    ]
    doubts = [summary["unproven"]] if summary["unproven"] else []
    doubts += [f"Warning: {text}" for text in summary["warnings"]]
    rows += [element("li", text[0].upper() + text[1:], class_="text-near") for text in doubts]
    rows += [element("li", f"{name.capitalize()} not checked") for name in summary["not_checked"]]
    return element("ul", *rows, class_="beside") if rows else Markup("")


def _certified_word(certified: dict[str, Any] | None) -> str:
    if certified is None:
        return "no, looked at the samples only"
    return f"at least {mm(certified['lower_bound'])} mm at every moment"


def moment_of(worst: dict[str, Any]) -> str:
    """When a moment of the summary is."""
    step = f"step {worst['step']:,}"
    if worst["between"]:
        step = f"between the steps {worst['step']:,} and {worst['step'] + 1:,}"
    return f"{seconds(worst['time'])}, {step}"


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


def sections(summary: dict[str, Any], pictures: dict[str, str]) -> Markup:
    """All sections under the replay; `pictures`: SVG of each profile by its name."""
    return Markup("").join(
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
    return section(
        "Worst moment",
        element(
            "p",
            f"{mm(worst['clearance'])} mm between {worst['link']} and {worst['obstacle']} at ",
            moment_link(worst, moment_of(worst)),
            ".",
        ),
        *_worst_sample(summary),
        table(("Joint", ">Position", "In its range"), rows, tall=True),
        table(("Witness point", ">x, mm", ">y, mm", ">z, mm"), points),
    )


def _worst_sample(summary: dict[str, Any]) -> list[Markup]:
    """The least clearance at the steps, where that between them is less."""
    sample = summary["worst_sample"]
    if not summary["worst"]["between"]:
        return []
    text = f"At the steps the least is {mm(sample['clearance'])} mm between {sample['link']} and "
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
            *_event_cells(event),
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
    heads = (">Time", ">Step", "What", ">mm", ">Least, mm", "Between")
    return section("Events", table(heads, rows, class_="clickable", tall=True), *notes)


def _event_cells(event: dict[str, Any]) -> tuple[Markup, Markup, Markup]:
    least = "" if event["least"] is None else mm(event["least"])
    if event["clearance"] is None:
        figures, who = ("", least), "not measured further"
    else:
        figures, who = (mm(event["clearance"]), least), f"{event['link']} - {event['obstacle']}"
    now, until = (element("td", figure, class_="number") for figure in figures)
    return now, until, element("td", who)


_PAIR_SHOWN = {True: "its own curve", False: "its place beside the curve"}


def matrix(summary: dict[str, Any]) -> Markup:
    """Least clearance of each link and obstacle in mm, coloured by the limits; nothing if not asked for."""
    if not summary["pairs"]:
        return Markup("")
    cells = {(pair["link"], pair["obstacle"]): (i, pair) for i, pair in enumerate(summary["pairs"])}
    all_links = dict.fromkeys(
        body["name"] for robot in summary["robots"] for body in robot["links"]
    )
    links = [name for name in all_links if any(name == link for link, _ in cells)]
    obstacles = [*(body["name"] for body in summary["obstacles"]), *all_links]
    obstacles = [name for name in obstacles if any(name == other for _, other in cells)]
    head = element(
        "tr",
        element("td", ""),
        *[element("th", element("span", name), scope="col", title=name) for name in obstacles],
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
        element("div", body, class_="scroll tall whole"),
        element(
            "p",
            "At the steps, rounded down. A click moves the replay to the step where that pair comes "
            f"closest, with its line and {_PAIR_SHOWN[summary['need'] == 'pairs']}; "
            "\N{EN DASH} marks a pair that was not measured.",
            class_="faint",
        ),
    )


def _matrix_cell(found: tuple[int, dict[str, Any]] | None, limits: dict[str, float]) -> Markup:
    if found is None:
        return element("td", "\N{EN DASH}", class_="none")
    place, pair = found
    title = (
        f"{pair['link']} - {pair['obstacle']}: {mm(pair['clearance'])} mm, step {pair['step']}, "
        f"{seconds(pair['time'])}"
    )
    return element(
        "td",
        mm(pair["clearance"]),
        class_=f"cell {_shade(pair['clearance'], limits)}",
        data_step=pair["step"],
        data_pair=place,
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
