"""Who holds what from when to when, and who is not there, as bars over the time of the run.

Not for: where anything is (the replay).
"""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from clearance.record.wording import seconds
from clearance.report.markup import element, section


def cell_time(summary: dict[str, Any]) -> Markup:
    """The section; nothing where nothing changes hands, comes or goes and no rule has a window."""
    parts = dict.fromkeys(carry["part"] for carry in summary["carries"])
    rows = [_row(part, _hands(summary, part)) for part in parts]
    rows += [
        _row(actor["name"], _absences(summary, actor))
        for actor in summary["actors"]
        if actor["absent"] and actor["name"] not in parts
    ]
    rows += [
        _row(f"rule {rule['name']}", [_window(summary, rule)])
        for rule in summary["rules"]
        if rule["from"] is not None or rule["until"] is not None
    ]
    if not rows:
        return Markup("")
    ends = element("span", seconds(summary["start"])), element("span", seconds(summary["end"]))
    axis = element(
        "div", element("span", ""), element("div", *ends, class_="ends"), class_="lane axis"
    )
    note = "A click moves the replay to where a bar begins."
    return section(
        "Who holds what, and when",
        element("div", *rows, axis, class_="lanes"),
        element("p", note, class_="faint"),
    )


def _row(name: str, bars: list[Markup]) -> Markup:
    return element(
        "div",
        element("span", name, class_="lane-name", title=name),
        element("div", *bars, class_="track"),
        class_="lane",
    )


def _hands(summary: dict[str, Any], part: str) -> list[Markup]:
    """The bars of a part: one for each that carries it, and where it is not in the cell."""
    robots = [robot["name"] for robot in summary["robots"]]
    things = {obstacle["name"] for obstacle in summary["obstacles"]}
    bars = []
    for carry in summary["carries"]:
        if carry["part"] == part:
            owner = carry["by"].split("/")[0]
            colour = robots.index(owner) % N_COLOURS if owner in robots else 0
            kind = "thing" if carry["by"] in things else f"hand{colour}"
            bars.append(_bar(summary, carry["from"], carry["until"], kind, carry["by"]))
    own = next(actor for actor in summary["actors"] if actor["name"] == part)
    return bars + _absences(summary, own)


def _absences(summary: dict[str, Any], actor: dict[str, Any]) -> list[Markup]:
    """The bars of an actor while it is not in the cell, or not measured."""
    return [
        _bar(summary, start, end, "absent", _why(summary, start, end))
        for start, end in actor["absent"]
    ]


def _why(summary: dict[str, Any], start: float, end: float) -> str:
    left_out = any(start < until and since < end for since, until in summary["not_measured"])
    return "not measured" if left_out else "not in the cell"


N_COLOURS = 4
"""Tints of robots, on the page and in the replay."""


def _window(summary: dict[str, Any], rule: dict[str, Any]) -> Markup:
    start = summary["start"] if rule["from"] is None else rule["from"]
    end = summary["end"] if rule["until"] is None else rule["until"]
    return _bar(summary, start, end, "window", "holds")


def _bar(summary: dict[str, Any], start: float, end: float, kind: str, text: str) -> Markup:
    """A bar from a time to another [s], as far as they are in the run."""
    first, whole = summary["start"], max(summary["end"] - summary["start"], 1e-300)
    left, right = (min(max((time - first) / whole, 0.0), 1.0) * 100.0 for time in (start, end))
    title = f"{text}: {seconds(start)} to {seconds(end)}"
    return element(
        "a",
        element("span", text),
        class_=f"bar {kind}",
        style=f"left:{left:.3f}%;width:{max(right - left, 0.2):.3f}%",
        title=title,
        aria_label=title,
        href="#stage",
        data_time=start,
    )
