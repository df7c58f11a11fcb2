"""The page's section on reserved outlines: is each kept, how close, who and when, with a picture."""

from __future__ import annotations

import base64
from typing import Any

from markupsafe import Markup

from clearance.record.wording import gap_text
from clearance.report.markup import element, section, step_link, table


def profiles(summary: dict[str, Any], pictures: dict[str, str]) -> Markup:
    """The section; nothing where the case names no profile."""
    if not summary["profiles"]:
        return Markup("")
    heads = ("Profile", "Plane", "Kept", ">Gap, mm", ">Limit, mm", "Closest", "When")
    rows = [_row(answer) for answer in summary["profiles"]]
    figures = [_figure(answer, pictures) for answer in summary["profiles"]]
    note = element(
        "p",
        "Gaps are proven for the continuous motion, between the steps too, and rounded down; "
        "the true gap is larger by at most the bound in summary.json. A negative gap is how far the swept "
        "outline is beyond the sketch.",
        class_="faint",
    )
    return section("Profiles", table(heads, rows, class_="clickable"), note, *figures)


def plane_text(answer: dict[str, Any]) -> str:
    """The plane, and the height of the cut if it is one."""
    cut = answer["section"]
    return answer["plane"] if cut is None else f"{answer['plane']} at {cut:g} m"


def _row(answer: dict[str, Any]) -> Markup:
    kept = (
        element("span", "yes")
        if answer["passed"]
        else element("span", "no", class_="text-violated")
    )
    return element(
        "tr",
        element("td", f"{answer['name']} ({answer['mode']})"),
        element("td", plane_text(answer)),
        element("td", kept),
        element("td", gap_text(answer["gap"]), class_="number"),
        element("td", f"{answer['limit'] * 1000:g}", class_="number"),
        element("td", answer["link"]),
        element("td", step_link(answer["step"])),
        data_step=answer["step"],
        tabindex=0,
    )


def _figure(answer: dict[str, Any], pictures: dict[str, str]) -> Markup:
    picture = pictures.get(answer["name"])
    if picture is None:
        return Markup("")
    source = "data:image/svg+xml;base64," + base64.b64encode(picture.encode()).decode()
    style = "max-width:100%;height:auto;background:white"
    return element("p", element("img", src=source, alt=f"profile {answer['name']}", style=style))
