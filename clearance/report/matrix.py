"""The least clearance of every pair as a table, grouped: each robot, what is carried, what moves, what stands.

A cell is coloured by the rule that judges its pair; of a pair that several judge it shows how it stands worst.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from clearance.record.status import STATUSES, Status
from clearance.record.wording import mm, seconds
from clearance.report.markup import element, section
from clearance.world.rules import DEFAULT

_PAIR_SHOWN = {True: "its own curve", False: "its place beside the curve"}

_FAR = (0.05, 0.1, 0.2, 0.4, 0.8)
"""[m] Clearances at which the shade of a cell that is clear changes."""


@dataclass(frozen=True)
class Group:
    """Bodies of one actor, or of one kind: its name and theirs."""

    name: str
    bodies: tuple[str, ...]


def groups_of(summary: dict[str, Any]) -> list[Group]:
    """All bodies: robots one by one, carried parts, obstacles that move, obstacles that stand."""
    kinds = {actor["name"]: actor["kind"] for actor in summary["actors"]}
    robots = [
        Group(robot["name"], tuple(body["name"] for body in robot["links"]))
        for robot in summary["robots"]
    ]
    obstacles = [body["name"] for body in summary["obstacles"]]
    titles = {"part": "carried", "obstacle": "moving", "": "standing"}
    others = [
        Group(title, tuple(name for name in obstacles if kinds.get(name, "") == kind))
        for kind, title in titles.items()
    ]
    return [*robots, *others]


def matrix(summary: dict[str, Any]) -> Markup:
    """The section; nothing if the pairs were not asked for."""
    if not summary["pairs"]:
        return Markup("")
    cells: dict[tuple[str, str], list[tuple[int, dict[str, Any]]]] = {}
    for i, pair in enumerate(summary["pairs"]):
        cells.setdefault((pair["link"], pair["obstacle"]), []).append((i, pair))
    fail = {rule["name"]: rule["fail"] for rule in summary["rules"]}
    groups = groups_of(summary)
    rows = _used(groups, (first for first, _ in cells))
    robots = len(summary["robots"])
    columns = _used([*groups[robots:], *groups[:robots]], (second for _, second in cells))
    body = element(
        "table",
        _head(columns),
        *[_body(group, columns, cells, fail, named=len(rows) > 1) for group in rows],
        class_="matrix",
    )
    return section(
        "Least clearance of every pair, mm",
        element("div", body, class_="scroll tall whole"),
        element("p", *_meaning(summary), class_="faint"),
    )


def _meaning(summary: dict[str, Any]) -> list[str]:
    shown = _PAIR_SHOWN[summary["need"] == "pairs"]
    proven = [pair["proven"] is not None for pair in summary["pairs"]]
    when = "Over the motion" if any(proven) else "At the steps"
    when += " (at the steps for pairs that stay far)" if any(proven) > all(proven) else ""
    told = [
        f"{when}, rounded down. A click moves the replay to where that pair comes closest, with its "
        f"line and {shown}; \N{EN DASH} marks a pair that was not measured."
    ]
    if summary["paddings"]:
        told.append(" Less padding.")
    if len(summary["rules"]) > 1:
        told.append(" Colours go by the rule that judges a pair.")
    return told


def _used(groups: Sequence[Group], names: Iterable[str]) -> list[Group]:
    """The groups with those of their bodies that are named; each body once, in the first group that has it."""
    left = set(names)
    found = []
    for group in groups:
        own = tuple(name for name in group.bodies if name in left)
        left -= set(own)
        if own:
            found.append(Group(group.name, own))
    return found


def _head(columns: Sequence[Group]) -> Markup:
    """The names of the columns, below those of their groups where there are several."""
    names = element(
        "tr",
        element("td", ""),
        *[
            element("th", element("span", _short(name, group)), scope="col", title=name)
            for group in columns
            for name in group.bodies
        ],
        class_="names",
    )
    if len(columns) == 1:
        return element("thead", names)
    over = [
        element(
            "th",
            element("b", group.name),
            scope="colgroup",
            colspan=len(group.bodies),
            title=group.name,
        )
        for group in columns
    ]
    return element("thead", element("tr", element("td", ""), *over, class_="groups"), names)


def _body(
    group: Group,
    columns: Sequence[Group],
    cells: dict[tuple[str, str], list[tuple[int, dict[str, Any]]]],
    fail: dict[str, float],
    *,
    named: bool,
) -> Markup:
    """The rows of one group, below its name."""
    others = [name for column in columns for name in column.bodies]
    rows = [
        element(
            "tr",
            element("th", _short(name, group) if named else name, scope="row", title=name),
            *[_cell(cells.get((name, other)), fail) for other in others],
        )
        for name in group.bodies
    ]
    if named:
        head = element("th", group.name, scope="rowgroup", class_="group")
        rows.insert(0, element("tr", head, element("td", "", colspan=len(others), class_="group")))
    return element("tbody", *rows)


def _short(name: str, group: Group) -> str:
    """A name without that of its group."""
    return name.removeprefix(f"{group.name}/")


def _cell(found: list[tuple[int, dict[str, Any]]] | None, fail: dict[str, float]) -> Markup:
    if found is None:
        return element("td", "\N{EN DASH}", class_="none")
    place, pair = min(found, key=lambda row: _standing(row[1], fail))
    return element(
        "td",
        mm(pair["clearance"]),
        class_=f"cell {_shade(pair)}",
        data_step=pair["step"],
        data_time=pair["time"] if pair["between"] else None,
        data_pair=place,
        tabindex=0,
        title="\n".join(_title(one) for _, one in found),
    )


def _standing(pair: dict[str, Any], fail: dict[str, float]) -> tuple[int, float]:
    """The worst first: by status, then by how far it is above the fail limit of its rule."""
    code = STATUSES.index(Status(pair["status"]))
    return -code, pair["clearance"] - fail[pair["rule"]]


def _title(pair: dict[str, Any]) -> str:
    by = "" if pair["rule"] == DEFAULT else f", rule {pair['rule']}: {pair['status']}"
    return (
        f"{pair['link']} - {pair['obstacle']}: {mm(pair['clearance'])} mm, "
        f"step {pair['step']}{'+' * pair['between']}, {seconds(pair['time'])}{by}"
    )


def _shade(pair: dict[str, Any]) -> str:
    if pair["status"] != "clear":
        return str(pair["status"])
    return next((f"far{i}" for i, bound in enumerate(_FAR) if pair["clearance"] < bound), "far5")
