"""The least clearance of every pair, grouped by what is carried, moves or stands; and the pairs left out.

A cell has the colour of the rule that judges its pair; of several rules it shows the most critical status.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, NamedTuple

from clearance.findings.measurement_conditions import paddings_in
from clearance.findings.self_clearance import self_clearance_of
from clearance.record.record import PairMinimum, Record
from clearance.record.status import STATUSES, Status, status_of
from clearance.record.wording import at_least_mm, mm, near_mm, step_text
from clearance.report.blocks import At, Paragraph, Row, Section, Table, capital, faint
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import BODIES, at_moment, time_of
from clearance.report.topic import TerminalTable, Topic
from clearance.world.case import Limits
from clearance.world.phase import Phase
from clearance.world.rules import DEFAULT

_PAIR_SHOWN = {True: "its own curve", False: "its place beside the curve"}

_FAR = (0.05, 0.1, 0.2, 0.4, 0.8)
"""[m] Clearances at which the shade of a cell that is clear changes."""

MOST_SHOWN_AT_ONCE, MOST_LINES = 24, 5
"""Most rows of what was not measured that do not scroll, and pairs in a terminal or a notebook."""


@dataclass(frozen=True)
class PairJudge:
    """How the least clearance of a pair stands: the limits of each rule, the paddings [m] of the bodies that have
    one, by name, and what paths are off [m]; in `phases` with corner zones those of each. Moments know by
    themselves whether bodies touch."""

    limits: dict[str, Limits]
    paddings: dict[str, float]
    path_error: float
    phases: tuple[tuple[Phase, dict[str, float]], ...] = ()

    @staticmethod
    def of(record: Record) -> PairJudge:
        """That of a record."""
        limits = {answer.name: answer.limits for answer in record.rules}
        zones = (
            [(phase, paddings_in(phase.case)) for phase in record.timeline.phases]
            if any(one.trajectory and one.trajectory.corners for one in record.case.robots)
            else []
        )
        paddings = paddings_in(record.case)
        return PairJudge(limits, paddings, record.timeline.path_error, tuple(zones))

    def status_of(self, minimum: PairMinimum) -> str:
        """The status; what padding alone brings to 0 or below is violated, no contact."""
        names, step = (minimum.link, minimum.obstacle), minimum.step
        passed = [
            paddings
            for phase, paddings in self.phases
            if phase.first <= step <= phase.last - minimum.between
        ]
        padding = max(
            sum(one.get(name, 0.0) for name in names) for one in passed or [self.paddings]
        )
        lessened = (
            padding + self.path_error
        )  # one sum, as it was taken off: a distance of 0 stays 0
        touches = minimum.clearance <= -lessened
        return status_of(minimum.clearance, self.limits[minimum.rule], touches)


def data(model: ReportModel) -> dict[str, Any]:
    """The least clearance of each pair by each rule that judges it, with its status; pairs left out."""
    record, minima = model.record, model.session.motion_minima()
    judge = PairJudge.of(record)
    return {
        "sides": list(record.sides[:2]),
        "pairs": [asdict(one) | {"status": judge.status_of(one)} for one in minima],
        "unmeasured": [asdict(pair) for pair in record.unmeasured],
        "self_clearance": self_clearance_of(record),
    }


def lines(model: ReportModel) -> Iterator[TerminalTable]:
    """The closest pairs, as a table; nothing where pairs are not known."""
    record, nearest = model.record, model.session.motion_minima(MOST_LINES)
    if not nearest:
        return
    judge = PairJudge.of(record)
    first, second = BODIES[record.sides[0]]
    seen = " that was seen" if any(pair.between for pair in nearest) else " at the samples"
    at_samples = "" if all(pair.proven is not None for pair in nearest) else seen
    several = bool(record.case.limits.rules)
    heads = [f"closest{at_samples}: {first.lower()}", second.lower()]
    made = record.moves
    loose = any(is_loose(record, pair) for pair in nearest)
    heads += [">clearance mm", ">step", ">time s", *([">proven mm"] * loose)]
    heads += ["move"] * bool(made.robots) + ["rule"] * several
    rows = [
        [pair.link, pair.obstacle, *pair_figures(pair, judge)]
        + [mm(pair.proven) if pair.proven is not None else ""] * loose
        + [made.at(pair.time)] * bool(made.robots)
        + [pair.rule] * several
        for pair in nearest
    ]
    yield TerminalTable(heads, rows)


def is_loose(record: Record, pair: PairMinimum) -> bool:
    """True if a pair is proven, by more than the gap of the certificate below what was seen."""
    if record.certificate is None or pair.proven is None:
        return False
    return pair.clearance - pair.proven > record.certificate.gap


def pair_figures(pair: PairMinimum, judge: PairJudge) -> list[str]:
    """The least clearance of a pair [mm], its step, and its time [s]."""
    near = near_mm(pair.clearance, judge.status_of(pair))
    return [near, step_text(pair), f"{pair.time:.3f}"]


@dataclass(frozen=True)
class Group:
    """Bodies of one actor, or of one kind: its name and theirs."""

    name: str
    bodies: tuple[str, ...]

    def short(self, body: str) -> str:
        """A body's name without that of its group."""
        return body.removeprefix(f"{self.name}/")


class PairCell(NamedTuple):
    """A pair: its clearance, its look, the moment, its place among the pairs, and what it says when pointed at."""

    text: str
    shade: str
    at: At
    place: int
    title: str


@dataclass(frozen=True)
class Matrix:
    """The cells of pairs, by name."""

    template: ClassVar[str] = "matrix"
    rows: Sequence[Group]
    columns: Sequence[Group]
    cells: Mapping[tuple[str, str], PairCell]

    def cells_of(self, name: str) -> list[PairCell | None]:
        """A row; None for pairs that are not measured."""
        return [self.cells.get((name, other)) for column in self.columns for other in column.bodies]


def sections(content: PageContent) -> Iterator[Section]:
    """The matrix, if the pairs were asked for, and what was not measured."""
    if content.summary["pairs"]:
        content_of = [_matrix(content.summary), faint(_meaning(content.summary))]
        yield Section("Least clearance of every pair, mm", content_of)
    yield Section("Not measured", [*_unmeasured(content.summary)])


def _matrix(summary: dict[str, Any]) -> Matrix:
    found: dict[tuple[str, str], list[tuple[int, dict[str, Any]]]] = {}
    for i, pair in enumerate(summary["pairs"]):
        found.setdefault((pair["link"], pair["obstacle"]), []).append((i, pair))
    fail = {rule["name"]: rule["fail"] for rule in summary["rules"]}
    groups, n_robots = groups_of(summary), len(summary["robots"])
    rows = _used(groups, (first for first, _ in found))
    columns = _used([*groups[n_robots:], *groups[:n_robots]], (second for _, second in found))
    return Matrix(rows, columns, {names: _cell(of, fail) for names, of in found.items()})


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


def _used(groups: Sequence[Group], names: Iterable[str]) -> list[Group]:
    """The groups with those of their bodies that are named; each body once, in the first group that has it."""
    unused = set(names)
    found = []
    for group in groups:
        own = tuple(name for name in group.bodies if name in unused)
        unused -= set(own)
        if own:
            found.append(Group(group.name, own))
    return found


def _cell(found: list[tuple[int, dict[str, Any]]], fail: Mapping[str, float]) -> PairCell:
    place, pair = min(found, key=lambda row: _standing(row[1], fail))
    title = "\n".join(_title(one) for _, one in found)
    near = near_mm(pair["clearance"], pair["status"])
    return PairCell(near, _shade(pair), at_moment(pair), place, title)


def _standing(pair: dict[str, Any], fail: Mapping[str, float]) -> tuple[int, float]:
    """The worst first: by status, then by how far it is above the fail limit of its rule."""
    code = STATUSES.index(Status(pair["status"]))
    return -code, pair["clearance"] - fail[pair["rule"]]


def _title(pair: dict[str, Any]) -> str:
    by = "" if pair["rule"] == DEFAULT else f", rule {pair['rule']}: {pair['status']}"
    return (
        f"{pair['link']} - {pair['obstacle']}: {near_mm(pair['clearance'], pair['status'], ' mm')}, "
        f"step {pair['step']}{'+' * pair['between']}, {time_of(pair)}{by}"
    )


def _shade(pair: dict[str, Any]) -> str:
    if pair["status"] != "clear":
        return str(pair["status"])
    return next((f"far{i}" for i, bound in enumerate(_FAR) if pair["clearance"] < bound), "far5")


def _meaning(summary: dict[str, Any]) -> str:
    shown = _PAIR_SHOWN[summary["need"] == "pairs"]
    proven = [pair["proven"] is not None for pair in summary["pairs"]]
    text = (
        f"{_when(summary, proven)}, rounded down. A click moves the replay to where that pair comes closest, "
        f"with its line and {shown}; \N{EN DASH} marks a pair that was not measured."
    )
    if not any(proven) and summary["certified"] is not None:
        text += f" {may_come_nearer(summary['certified'])}"
    if any(proven):
        text += " Far pairs may come about 1 % nearer; summary.json has their proven bounds."
    text += " Less padding." if summary["paddings"] else ""
    return text + (
        " Colours go by the rule that judges a pair." if len(summary["rules"]) > 1 else ""
    )


def _when(summary: dict[str, Any], proven: Sequence[bool]) -> str:
    """The moments of which the figures are the least."""
    if any(proven):
        far = " (at the steps for pairs that stay far)" if not all(proven) else ""
        return f"Over the motion{far}"
    of_clocks = "" if summary["clock"]["kind"] == "common" else " of both clocks"
    seen = any(pair["between"] for pair in summary["pairs"])
    nearer = ", or between them where the proof saw a pair nearer" if seen else ""
    return f"At the steps{of_clocks}{nearer}"


def may_come_nearer(certified: Mapping[str, Any]) -> str:
    """The bound for what is known at the steps alone, in a sentence."""
    least = certified["lower_bound"]
    bound = f"; {at_least_mm(least)} is proven of all pairs" if least > 0.0 else ""
    return f"Between the steps a pair may come nearer{bound}."


def _unmeasured(summary: dict[str, Any]) -> Iterator[Paragraph | Table]:
    """Which links and pairs were left out, and why; how many for each reason, where there are many."""
    unmeasured, of_links = summary["unmeasured"], summary["sides"][0] == "link"
    unchecked = [f"{name} not checked" for name in summary["not_checked"]]
    if not unmeasured:
        unchecked.insert(0, "every link with a shape was measured against every obstacle")
    if unchecked:
        yield Paragraph(f"{capital('; '.join(unchecked))}.")
    if not unmeasured:
        return
    many = len(unmeasured) > MOST_SHOWN_AT_ONCE
    if many:
        reasons = Counter(pair["reason"] for pair in unmeasured)
        by_reason = ", ".join(f"{reason}: {number:,}" for reason, number in reasons.most_common())
        yield Paragraph(f"{by_reason}.")
    every = "every obstacle" if of_links else "everything"
    rows = [
        Row([one["link"], every if one["obstacle"] == "*" else one["obstacle"], one["reason"]])
        for one in unmeasured
    ]
    yield Table((*BODIES[summary["sides"][0]], "Why"), rows, "bodies", tall=many)


TOPIC: Topic = Topic(data, lines, sections)
