"""How sure the figures are: the method, facets, the proof between the samples, the cross-check, notes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from clearance.findings.verdict import Verdict
from clearance.record.certificate import Certificate
from clearance.record.names import LINK_AND_OBSTACLE
from clearance.record.record import CrossCheck, Disagreement, Record
from clearance.record.wording import certified_text, count, limit_mm, mm, scientific_mm, seconds
from clearance.report.blocks import At, Bullets, Content, Paragraph, Row, Section, Table, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import step_link
from clearance.report.topic import Line, Topic, labelled
from clearance.world.case import Case
from clearance.world.plausible_recordings import not_measured, not_proven

MOST_ROWS = 200
"""Most steps of a failed cross-check printed on the page; all are in `summary.json`."""

MOST_NOTES, MOST_LINES = 8, 5
"""Most notes, and steps of a failed cross-check, in a terminal."""


def data(model: ReportModel) -> dict[str, Any]:
    """What was asked of the run, what is proven, what a peer says, notes."""
    record = model.record
    times, certificate, check = (
        record.rows.numbers("time"),
        record.certificate,
        record.cross_check,
    )
    return {
        "method": record.method,
        "paper_tolerance": record.paper_tolerance,
        "motion": record.motion_kind,
        "need": record.need,
        "n_steps": record.rows.n_rows,
        "start": float(times[0]),
        "end": float(times[-1]),
        "certified": None if certificate is None else certified_of(record, certificate),
        "cross_check": None if check is None else asdict(check) | {"agrees": check.agrees},
        "tracking_error": _tracking_error(record),
        "tessellation_bound": tessellation_bound(record),
        "notes": notes_of(record, model.session.hints),
    }


def certified_of(record: Record, certificate: Certificate) -> dict[str, Any]:
    """The least proven bound [m], the interval it holds for, and the least distance seen there, if one was."""
    step = certificate.worst_interval
    times = record.rows.numbers("time")
    cubic = any(motion.velocities is not None for motion in record.motions)
    asked = [motion.placed.trajectory for motion in record.motions if motion.velocities is not None]
    is_program = any(one is not None and one.moves for one in asked)
    has_zones = any(one is not None and one.corners for one in asked)
    return {
        "joints": "program with zones"
        if has_zones
        else "program"
        if is_program
        else "quintic"
        if record.timeline.path_error
        else "cubic"
        if cubic
        else "linear",
        "lower_bound": float(certificate.lower_bound[step]),
        "upper_bound": record.rows.row(step)["upper_bound"],
        "step": step,
        "start": float(times[step]),
        "end": float(times[min(step + 1, len(times) - 1)]),
        "allowed_gap": certificate.gap,
        "greatest_gap": _greatest_gap(certificate),
        "not_measured": [[*span] for span in not_measured(record.case)],
        "not_proven": [[*span] for span in not_proven(record.case)],
        "is_pose": record.basis == "pose",
        "touches": record.nearest.touches,
        "tally": dict(certificate.tally),
    }


def _greatest_gap(certificate: Certificate) -> float:
    """[m] how far the two bounds are apart anywhere; intervals in which nothing is measured have none."""
    bounded = np.isfinite(certificate.lower_bound)
    return float((certificate.upper_bound[bounded] - certificate.lower_bound[bounded]).max())


def _tracking_error(record: Record) -> dict[str, Any] | None:
    """The greatest tracking error [rad or m] and its step; None in kinematic motion."""
    if "tracking_error" not in record.rows:
        return None
    error = record.rows.numbers("tracking_error")
    step = int(np.argmax(error))
    return {"greatest": float(error[step]), "step": step}


def tessellation_bound(record: Record) -> float:
    """[m] by how much the facets of round shapes can make a clearance too small: both excesses of a
    pair."""
    links = [body.shape.excess for motion in record.motions for body in motion.placed.robot.bodies]
    obstacles = [obstacle.body.shape.excess for obstacle in record.case.obstacles]
    among_links = any(placed.self_clearance for placed in record.case.robots)
    if record.sides[:2] == LINK_AND_OBSTACLE and not among_links:
        return max(links, default=0.0) + max(obstacles, default=0.0)
    return sum(sorted([*links, *obstacles])[-2:])


def notes_of(record: Record, hints: Sequence[str]) -> list[str]:
    """All notes of a run, each once."""
    robots = [note for motion in record.motions for note in motion.placed.robot.notes]
    of_run = [*record.notes, *record.contact_notes, *_waivers_of_others(record.case)]
    return list(dict.fromkeys([*hints, *record.case.notes, *robots, *of_run]))


def _waivers_of_others(case: Case) -> list[str]:
    """That some waivers are of other cases, and say nothing here."""
    others = sum(not waiver.is_of_case(case.name) for waiver in case.waivers)
    return [f"waivers of other cases, not used here: {count(others, 'waiver')}"] if others else []


def lines(model: ReportModel) -> Iterator[Line]:
    """What is proven, what facets may hide, what a peer says, notes."""
    record = model.record
    yield from _certified_lines(record, model.verdict)
    if model.may_lack:
        yield "incomplete", f"other pairs may break their limits too: {model.may_lack}"
    bound = tessellation_bound(record)
    if bound > 0.01 * record.worst.clearance and bound != 0.0:
        shapes = f"round shapes are faceted from outside, by up to {bound * 1000:.3g} mm for a pair"
        yield "facets", f"{shapes}: a clearance can be too small by that much, never too large"
    if record.cross_check is not None:
        yield from labelled("cross-check", _check_lines(record.cross_check))
    notes = _folded(notes_of(record, model.session.hints))
    yield from (("note", note) for note in notes[:MOST_NOTES])
    if len(notes) > MOST_NOTES:
        yield "", f"and {count(len(notes) - MOST_NOTES, 'more note')}, see --json"


def _folded(notes: Sequence[str]) -> list[str]:
    """The notes; of three or more that begin alike, as those of corner after corner do, the first and a count."""
    begun = [tuple(word for word in note.split() if word.isalpha())[:3] for note in notes]
    times, found = Counter(begun), dict[tuple[str, ...], str]()
    for words, note in zip(begun, notes, strict=True):
        n_more = times[words] - 1
        if n_more < 2:
            found[note,] = note
        else:
            found.setdefault(words, f"{note}; and {n_more} more notes like it, see --json")
    return [*found.values()]


def _certified_lines(record: Record, verdict: Verdict) -> Iterator[Line]:
    if record.certificate is None:
        yield "certified", "no: the motion between the samples is not checked"
        return
    proven = certified_of(record, record.certificate)
    yield "certified", certified_text(record.moves.named(proven))
    sample = verdict.worst_sample
    if verdict.worst.between:
        at = seconds(sample.time, record.moves.at(sample.time))
        near = f"{mm(sample.clearance)} mm at step {sample.step}, {at}"
        yield "samples", f"{near}: {sample.link} - {sample.obstacle}"


def _check_lines(check: CrossCheck) -> Iterator[str]:
    figures = (
        f"greatest difference {check.greatest_difference:.2e} m, witness points within "
        f"{check.worst_witness_error:.2e} m, tolerance {check.tolerance:.2e} m"
    )
    if check.n_settled:
        figures += (
            f"; it is off by up to {check.greatest_settled:.2e} m at {count(check.n_settled, 'step')}, "
            "where exact arithmetic settles it for us"
        )
    if check.agrees:
        of_all = count(check.n_steps, "step")
        agreeing = f"{check.n_steps - check.n_settled} of" if check.n_settled else "all"
        yield f"{check.peer} agrees at {agreeing} {of_all}: {figures}"
        return
    n_bad = len({row.step for row in check.disagreements})
    yield f"{check.peer} DISAGREES at {count(n_bad, 'step')}: {figures}"
    yield from map(_disagreement, check.disagreements[:MOST_LINES])


def _disagreement(row: Disagreement) -> str:
    ours = f"{row.clearance:.9g} m ({row.link} - {row.obstacle})"
    peers = f"{row.peer_clearance:.9g} m ({row.peer_link} - {row.peer_obstacle})"
    return f"step {row.step}: {ours}, peer {peers}: {row.reason}"


def sections(content: PageContent) -> Iterator[Section]:
    """How exact the figures are, and what the cross-check found."""
    summary = content.summary
    notes = summary["notes"]
    yield Section(
        "How sure",
        [
            Paragraph(_exactness(summary["method"], summary["paper_tolerance"])),
            Paragraph(_tessellation(summary["tessellation_bound"])),
            Paragraph(_sampling(summary)),
            *map(Paragraph, _moving(summary)),
            *_cross_check(summary["cross_check"]),
            *([Bullets(notes)] if notes else []),
        ],
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
        "or samples; the only error is the rounding of float64."
    )


def _tessellation(bound: float) -> str:
    if bound == 0.0:
        return "All shapes are measured as given; none is faceted."
    return (
        f"Round shapes are faceted from outside, by up to {bound * 1000:.3g} mm for a pair: "
        "a clearance can be too small by that much and never too large."
    )


def _moving(summary: dict[str, Any]) -> Iterator[str]:
    """What is assumed of what moves by a table of poses, of paddings, and of clocks."""
    others = (one for one in summary["actors"] if one["kind"] != "robot")
    tables = [one["name"] for one in others if one["between_samples"]]
    if tables:
        yield (
            f"Bodies that move by a table of poses ({', '.join(tables)}) go straight from one row to the next, "
            "and turn about one axis at constant speed."
        )
    if summary["paddings"]:
        paddings = [f"{name} {limit_mm(value)} mm" for name, value in summary["paddings"].items()]
        yield f"Clearances are less the padding of both bodies: {', '.join(paddings)}."
    clocks = {
        "slack": "may be up to {slack:g} s apart either way",
        "unsynchronised": "are not tied",
    }
    kind = summary["clock"]["kind"]
    if kind in clocks:
        how = clocks[kind].format(slack=summary["clock"]["slack"])
        covered = "covers" if summary["certified"] is not None else "would cover"
        yield (
            f"The clocks of the actors {how}: the proof between the steps {covered} every pair of times that this "
            "allows. Chart, replay and tables show pairs of steps."
        )


_MEASURED = {
    "steps": "measured at",
    "pairs": "measured for every pair at",
    "limit": "measured where it is below the warn limit, and at its least, of",
    "minimum": "measured only as far as it takes to find the least of",
}


def _sampling(summary: dict[str, Any]) -> Content:
    steps = f"Clearance is {_MEASURED[summary['need']]} {count(summary['n_steps'], 'step')}; "
    proven = "the motion between two steps is not checked."
    if summary["certified"] is not None:
        proven = f"proven is {certified_text(summary['certified'])}."
    error = summary["tracking_error"]
    if error is None:
        return steps + proven
    greatest = f"{error['greatest']:.4g} rad or m"
    error_text = f" The simulated joints leave the trajectory by at most {greatest}, at "
    return [steps, proven, error_text, step_link(error["step"]), "."]


def _cross_check(check: dict[str, Any] | None) -> Iterator[Paragraph | Table]:
    if check is None:
        yield Paragraph("No cross-check was asked for.")
        return
    figures = (
        f"{check['peer']} measured {count(check['n_steps'], 'step')} too: the greatest difference "
        f"is {scientific_mm(check['greatest_difference'])} mm, at step {check['worst_step']:,}; "
        f"witness points are off by at most {scientific_mm(check['worst_witness_error'])} mm; "
        f"{scientific_mm(check['tolerance'])} mm counts as agreement."
    )
    if check["n_settled"]:
        figures += (
            f" It is off by up to {scientific_mm(check['greatest_settled'])} mm at "
            f"{count(check['n_settled'], 'step')}. There exact arithmetic on the faces that it names, "
            "and on those under our witness points, confirms ours."
        )
    yield Paragraph(figures)
    if not check["agrees"]:
        heads = (">Step", ">Ours, mm", f">{check['peer']}, mm", "Ours", check["peer"], "Why")
        rows = [_disagreeing(item) for item in check["disagreements"][:MOST_ROWS]]
        yield Table(heads, rows, "clickable")


def _disagreeing(item: dict[str, Any]) -> Row:
    cells = [
        number(f"{item['step']:,}"),
        number(f"{item['clearance'] * 1000:.12g}"),
        number(f"{item['peer_clearance'] * 1000:.12g}"),
        f"{item['link']} - {item['obstacle']}",
        f"{item['peer_link']} - {item['peer_obstacle']}",
        item["reason"],
    ]
    return Row(cells, At(item["step"]))


TOPIC: Topic = Topic(data, lines, sections)
