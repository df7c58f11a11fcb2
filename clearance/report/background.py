"""How far the figures can be trusted and what they were made from: the lower half of the page.

Each function returns one piece of HTML made from the summary.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from markupsafe import Markup

from clearance.record.wording import certified_text, count, limit_mm, scientific_mm
from clearance.report.contact import HEADS
from clearance.report.markup import element, section, step_link, table

MAX_DISAGREEMENTS = 200
"""Most steps of a failed cross-check printed on the page; all are in `summary.json`."""


def certainty(summary: dict[str, Any]) -> Markup:
    """How exact the figures are, and what the cross-check found."""
    notes = [element("li", note) for note in summary["notes"]]
    return section(
        "How sure",
        element("p", _exactness(summary["method"], summary["paper_tolerance"])),
        element("p", _tessellation(summary["tessellation_bound"])),
        element("p", *_sampling(summary)),
        *[element("p", text) for text in _moving(summary)],
        *_cross_check(summary["cross_check"]),
        element("ul", *notes) if notes else Markup(""),
    )


def _exactness(method: str, tolerance: float | None) -> str:
    if method == "paper":
        first = "no tolerance" if tolerance is None else f"a tolerance of {tolerance * 1000:g} mm"
        return (
            f"Method “paper”: the distance as first published, with {first} for its first rejection "
            "rule, "
            "and with its second one, which can overlook the nearest faces. For a safe figure use the "
            "method “exact”."
        )
    return (
        "Method “exact”: the global minimum over all polygons of the shapes as loaded, never hulls "
        "or samples; what is left is the rounding of float64."
    )


def _tessellation(bound: float) -> str:
    if bound == 0.0:
        return "All shapes are measured as given; none is faceted."
    return (
        f"Round shapes are faceted from outside: the facets of a pair stand up to "
        f"{bound * 1000:.3g} mm outside the true surfaces, so a clearance can be too small by "
        "that much and never too large."
    )


def _moving(summary: dict[str, Any]) -> list[str]:
    """What is assumed of what moves by a table of poses, of paddings, and of clocks."""
    told = []
    tables = [
        one["name"]
        for one in summary["actors"]
        if one["kind"] != "robot" and one["between_samples"]
    ]
    if tables:
        told.append(
            f"What moves by a table of poses ({', '.join(tables)}) goes straight from one row to the next, and "
            "turns about one axis at constant speed."
        )
    if summary["paddings"]:
        paddings = [f"{name} {limit_mm(value)} mm" for name, value in summary["paddings"].items()]
        told.append(f"Clearances are less the padding of both bodies: {', '.join(paddings)}.")
    clocks = {
        "slack": "may be up to {slack:g} s apart either way",
        "unsynchronised": "are not tied",
    }
    kind = summary["clock"]["kind"]
    if kind in clocks:
        how = clocks[kind].format(slack=summary["clock"]["slack"])
        told.append(
            f"The clocks of the actors {how}: every pair of times that this allows is looked at."
        )
    return told


_MEASURED = {
    "steps": "measured at",
    "pairs": "measured for every pair at",
    "limit": "measured where it is below the warn limit, and at its least, of",
    "minimum": "measured only as far as it takes to find the least of",
}


def _sampling(summary: dict[str, Any]) -> list[object]:
    steps = f"Clearance is {_MEASURED[summary['need']]} {count(summary['n_steps'], 'step')}; "
    if summary["certified"] is None:
        parts: list[object] = [steps, "nothing is said about the motion between two steps."]
    else:
        parts = [steps, f"proven is {certified_text(summary['certified'])}."]
    error = summary["tracking_error"]
    if error is not None:
        greatest = f"{error['greatest']:.4g} rad or m"
        parts += [" The simulated joints leave the trajectory by at most ", greatest, ", at "]
        parts += [step_link(error["step"]), "."]
    return parts


def _cross_check(check: dict[str, Any] | None) -> list[Markup]:
    if check is None:
        return [element("p", "No cross-check was asked for.")]
    figures = (
        f"{check['peer']} measured {count(check['n_steps'], 'step')} too: the greatest difference "
        f"is {scientific_mm(check['greatest_difference'])} mm, at step {check['worst_step']:,}; "
        f"witness points are off by at most {scientific_mm(check['worst_witness_error'])} mm; "
        f"{scientific_mm(check['tolerance'])} mm counts as agreement."
    )
    if check["n_settled"]:
        figures += (
            f" It is off by up to {scientific_mm(check['greatest_settled'])} mm at "
            f"{count(check['n_settled'], 'step')}, where exact arithmetic on the faces that it names, "
            "and on those under our witness points, settles it for us."
        )
    if check["agrees"]:
        return [element("p", figures)]
    rows = [
        element(
            "tr",
            element("td", f"{item['step']:,}", class_="number"),
            element("td", f"{item['clearance'] * 1000:.12g}", class_="number"),
            element("td", f"{item['peer_clearance'] * 1000:.12g}", class_="number"),
            element("td", f"{item['link']} - {item['obstacle']}"),
            element("td", f"{item['peer_link']} - {item['peer_obstacle']}"),
            element("td", item["reason"]),
            data_step=item["step"],
            tabindex=0,
        )
        for item in check["disagreements"][:MAX_DISAGREEMENTS]
    ]
    heads = (">Step", ">Ours, mm", f">{check['peer']}, mm", "Ours", check["peer"], "Why")
    return [element("p", figures), table(heads, rows, class_="clickable")]


def unmeasured(summary: dict[str, Any]) -> Markup:
    """Which links and pairs were left out, and why."""
    rows = [
        element(
            "tr",
            element("td", pair["link"]),
            element("td", _whole(summary) if pair["obstacle"] == "*" else pair["obstacle"]),
            element("td", pair["reason"]),
        )
        for pair in summary["unmeasured"]
    ]
    if not rows:
        told = "Nothing was left out: every link with a shape was measured against every obstacle."
        return section("Not measured", element("p", told))
    heads = (*HEADS[summary["sides"][0]], "Why")
    found = table(heads, rows, class_="bodies", tall=len(rows) > MOST_SHOWN_AT_ONCE)
    return section("Not measured", *_counted(summary), found)


MOST_SHOWN_AT_ONCE = 24
"""Most rows of what was not measured that do not scroll."""


def _whole(summary: dict[str, Any]) -> str:
    return "every obstacle" if summary["sides"][0] == "link" else "everything"


def _counted(summary: dict[str, Any]) -> list[Markup]:
    """How many pairs there are of each reason, where there are many."""
    reasons = Counter(pair["reason"] for pair in summary["unmeasured"])
    if len(summary["unmeasured"]) <= MOST_SHOWN_AT_ONCE:
        return []
    told = ", ".join(f"{reason}: {number:,}" for reason, number in reasons.most_common())
    return [element("p", f"{told}.")]


def loaded(summary: dict[str, Any]) -> Markup:
    """Every body with its size and quality."""
    groups = [(f"Robot {robot['name']}", robot["links"]) for robot in summary["robots"]]
    groups.append(("Obstacles", summary["obstacles"]))
    heads = (
        "Body",
        "From",
        ">Triangles",
        ">Polygons",
        ">Size, mm",
        ">Volume, cm³",
        "Surface",
        ">Facets, mm",
    )
    parts = [
        table((name, *heads[1:]), [_body_row(body) for body in bodies], class_="bodies")
        for name, bodies in groups
    ]
    return section("What was loaded", *parts)


def _quality(body: dict[str, Any]) -> str:
    """What kind of surface a body has; one that holds faces once for each side has no inside there."""
    if "points" in body:
        return f"{body['points']:,} balls of {body['ball_radius'] * 1000:.4g} mm"
    if not body["closed"]:
        return "open"
    if body["two_sided"]:
        return "two-sided"
    return "closed" if body["oriented"] else "closed, not oriented"


def _body_row(body: dict[str, Any]) -> Markup:
    low, high = body["bounding_box"]
    size = " \N{MULTIPLICATION SIGN} ".join(
        f"{(b - a) * 1000:.4g}" for a, b in zip(low, high, strict=True)
    )
    volume = "" if body["volume"] is None else _rounded(body["volume"] * 1e6)
    quality = _quality(body)
    facets = "exact" if body["excess"] == 0.0 else f"{body['excess'] * 1000:.3g}"
    return element(
        "tr",
        element("td", body["name"]),
        element("td", body["origin"], class_="faint"),
        element("td", f"{body['triangles']:,}", class_="number"),
        element("td", f"{body['polygons']:,}", class_="number"),
        element("td", size, class_="number"),
        element("td", volume, class_="number"),
        element("td", quality),
        element("td", facets, class_="number"),
    )


def _rounded(value: float) -> str:
    if abs(value) < 1e-6:  # a double wall: its sides cancel but for rounding
        return "0"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def provenance(summary: dict[str, Any]) -> Markup:
    """Files with their sha256, versions, counters."""
    files = [
        element(
            "tr",
            element("td", item["path"]),
            element("td", f"{item['n_bytes']:,}", class_="number"),
            element("td", element("code", item["sha256"])),
        )
        for item in summary["inputs"]
    ]
    versions = ", ".join(f"{name} {version}" for name, version in summary["versions"].items())
    counters = ", ".join(
        f"{name.replace('_', ' ')} {number:,}" for name, number in summary["tally"].items()
    )
    return section(
        "Where this comes from",
        table(("File", ">Bytes", "sha256"), files, class_="bodies"),
        element("p", versions, class_="faint"),
        element("p", f"Counted: {counters}." if counters else "", class_="faint"),
    )


def sign_off(fields: dict[str, str] | None) -> Markup:
    """Author and revision, and room to sign; nothing where the case has no such fields."""
    if fields is None:
        return Markup("")
    heads = ("", "Name", "Date", "Signature")
    roles = {"Author": fields["author"], "Checked": "", "Approved": ""}
    rows = [
        element(
            "tr", element("th", role, scope="row"), element("td", name), *[element("td", "")] * 2
        )
        for role, name in roles.items()
    ]
    revision = element("p", f"Revision {fields['revision']}") if fields["revision"] else Markup("")
    return section("Sign-off", revision, table(heads, rows, class_="sign-off"))
