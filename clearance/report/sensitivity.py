"""What the clearance of the worst moment changes by, as data and as a table. Not for: working it out
(`simulate.answers.sensitivity`).
"""

from __future__ import annotations

import math
from typing import Any

from markupsafe import Markup

from clearance.record.sensitivity import Sensitivity
from clearance.report.markup import element, table

MOST_PAIRS = 8
"""Pairs that are as near, by name."""

_PER = {"rad": (math.radians(1.0) * 1e3, "1°"), "m": (1.0, "1 mm")}
"""Of a variable's unit: from metres of clearance a unit to millimetres a step, and the step."""


def sensitivity_data(found: Sensitivity) -> dict[str, Any]:
    """Slopes in metres of clearance per radian or metre, or why there are none."""
    return {
        "why_not": found.why_not or None,
        "pairs": [list(pair) for pair in found.pairs],
        "rates": [rate._asdict() | {"both_ways": rate.both_ways} for rate in found.rates],
    }


def sensitivity_table(given: dict[str, Any], *, several_robots: bool) -> Markup:
    """The table under the worst moment, or a line that says why there is none."""
    if given["why_not"]:
        told = f"What it changes by is not worked out: {given['why_not']}."
        return element("p", told, class_="faint")
    if not given["rates"]:
        return element("p", "Nothing that can be moved changes it.", class_="faint")
    rows = [_row(rate, several_robots) for rate in given["rates"]]
    heads = ("What this clearance changes by", ">Moved by", ">Up, mm", ">Down, mm", "")
    return table(heads, rows, tall=True) + element("p", _note(given), class_="faint")


def _row(rate: dict[str, Any], several_robots: bool) -> Markup:
    factor, step = _PER[rate["unit"]]
    name = f"{rate['kind']} {rate['of']}, {rate['name']}"
    if rate["kind"] == "joint":
        name = f"{rate['of']} / {rate['name']}" if several_robots else rate["name"]
    figures = [_signed(rate[way] * factor) for way in ("more", "less")]
    cells = [element("td", text, class_="number") for text in (step, *figures)]
    one_way = "" if rate["both_ways"] else "each holds one way only"
    return element("tr", element("td", name), *cells, element("td", one_way, class_="faint"))


def _signed(value: float) -> str:
    text = f"{value:+.3f}"
    return "0" if float(text) == 0.0 else text


def _note(given: dict[str, Any]) -> str:
    told = "In first order, near this moment: a large move changes it otherwise, and other pairs come near."
    if len(given["pairs"]) > 1:
        names = [f"{a} and {b}" for a, b in given["pairs"][:MOST_PAIRS]]
        more = len(given["pairs"]) - len(names)
        names += [f"{more} more"] if more else []
        told = f"As near are {'; '.join(names)}: the least of them counts. {told}"
    return told
