"""The summary of a record as plain data: what `summary.json` holds and what the page prints.

Lengths are in metres, times in seconds, angles in radians, all under names that say so in the
guide (`scripts/docs/results.md`). Not for: wording and rounding, which belong to the page.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from clearance.findings.self_clearance import self_clearance_of
from clearance.findings.verdict import Verdict
from clearance.geometry.point_cloud import PointCloud
from clearance.record.certificate import Certificate
from clearance.record.details import RunDetails
from clearance.record.moment import Moment
from clearance.record.names import LINK_AND_OBSTACLE
from clearance.record.record import CrossCheck, PairMinimum, ProfileAnswer, Record
from clearance.record.row_status import status_counts
from clearance.record.wording import count
from clearance.report.actors import actors_of, carried_of, clock_of, paddings_of
from clearance.report.body_gaps import body_gaps_of
from clearance.report.contact import contact_of
from clearance.report.pair_judge import PairJudge
from clearance.report.provenance import inputs, public_origin, versions
from clearance.report.recordings import recordings_of
from clearance.report.report_data import ReportData
from clearance.report.rules import rules_of, told_moment
from clearance.report.sensitivity import sensitivity_data
from clearance.report.tolerances import tolerances_of
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.plausible_recordings import not_measured

FORMAT = 3
"""Which keys there are: `scripts/docs/results.md`."""


def summary_of(data: ReportData) -> dict[str, Any]:
    """Everything about a record that fits on a page, as JSON-ready values; a limit that does not
    exist is None. Keys `tolerances`, `recordings` and `body_gaps` are there where a case has them."""
    record, details, verdict = data.record, data.details, data.verdict
    case, certificate = record.case, record.certificate
    times = record.steps["time"].to_numpy()
    return {
        "format": FORMAT,
        "name": case.name,
        **_verdict(verdict),
        "limits": {name: getattr(case.limits, name) for name in ("fail", "warn", "joints")},
        "rules": rules_of(record, details),
        "actors": actors_of(record),
        "carries": carried_of(record),
        "clock": clock_of(record),
        "not_measured": [[*span] for span in not_measured(record.case)],
        "paddings": paddings_of(record),
        "sides": list(record.sides[:2]),
        "method": record.method,
        "paper_tolerance": record.paper_tolerance,
        "motion": record.motion_kind,
        "need": record.need,
        "n_steps": record.steps.num_rows,
        "start": float(times[0]),
        "end": float(times[-1]),
        "worst": _worst(record, record.worst),
        "worst_sample": _worst(record, record.worst_sample),
        "nearest": told_moment(record, record.nearest),
        "sensitivity": sensitivity_data(details.sensitivity),
        "status_counts": status_counts(record),
        "intervals": {
            level: [asdict(i) for i in found] for level, found in details.intervals.items()
        },
        "events": [asdict(event) for event in details.events],
        "not_listed": details.not_listed,
        "pairs": _pairs(record, details.minima),
        "unmeasured": [asdict(pair) for pair in record.unmeasured],
        "self_clearance": self_clearance_of(record),
        "contact": contact_of(record),
        "certified": None if certificate is None else certified_of(record, certificate),
        "cross_check": _cross_check(record.cross_check),
        "tracking_error": _tracking_error(record),
        "robots": [_robot(record, motion) for motion in record.motions],
        "obstacles": [_body(record, obstacle.body, obstacle.name) for obstacle in case.obstacles],
        "tessellation_bound": tessellation_bound(record),
        "profiles": [_profile(answer) for answer in record.profiles],
        "tally": dict(record.tally),
        "sign_off": None if case.sign_off is None else asdict(case.sign_off),
        "notes": notes_of(record, details.hints),
        "inputs": inputs(case),
        "versions": versions(),
    } | _where_given(record, details, verdict)


def _where_given(record: Record, details: RunDetails, verdict: Verdict) -> dict[str, Any]:
    """What only cases with tolerances, a recorded run or body gaps have."""
    tolerances, recordings = tolerances_of(record, details.left), recordings_of(record)
    told: dict[str, Any] = (
        {} if tolerances is None else {"tolerances": tolerances | {"verdict": verdict.tolerances}}
    )
    told |= {} if recordings is None else {"recordings": recordings}
    if record.body_gaps:
        told["body_gaps"] = body_gaps_of(details.minima, details.standing)
    return told


def _verdict(verdict: Verdict) -> dict[str, Any]:
    """The verdict: its status, whether it is passed, what it rests on, and why."""
    return {
        "verdict": verdict.status,
        "verdict_text": verdict.text(),
        "measured": verdict.measured,
        "passed": verdict.passed,
        "exit_code": verdict.exit_code,
        "basis": verdict.basis,
        "reasons": list(verdict.reasons),
        "unproven": verdict.unproven,
        "broken": list(verdict.broken),
        "warnings": list(verdict.warnings),
        "suspects": [{"kind": one.kind, "text": one.text} for one in verdict.suspects],
        "disputed_by": verdict.disputed_by,
        "not_checked": list(verdict.not_checked),
        "nearer": verdict.nearest,
        "clocks": verdict.clocks,
        "waived": list(verdict.waived),
        "n_waivers": verdict.n_waivers,
        "stale": list(verdict.stale),
        "at_level": verdict.at_level,
    }


def _pairs(record: Record, minima: Sequence[PairMinimum]) -> list[dict[str, Any]]:
    """The least clearance of each pair by each rule that judges it, with its status."""
    judge = PairJudge.of(record)
    return [asdict(one) | {"status": judge.status_of(one)} for one in minima]


def _worst(record: Record, worst: Moment) -> dict[str, Any]:
    joints = [
        joint
        for motion, positions in zip(record.motions, worst.positions, strict=True)
        for joint in _joints(motion, positions)
    ]
    return told_moment(record, worst) | {"joints": joints}


def _joints(motion: Motion, positions: np.ndarray) -> list[dict[str, Any]]:
    """Name, kind, position and limits [rad] or [m] of every moving joint at one moment."""
    return [
        {
            "robot": motion.placed.robot.name,
            "name": joint.name,
            "kind": str(joint.kind),
            "position": float(position),
            "lower": _finite(joint.lower),
            "upper": _finite(joint.upper),
        }
        for joint, position in zip(motion.placed.robot.moving_joints, positions, strict=True)
    ]


def _robot(record: Record, motion: Motion) -> dict[str, Any]:
    placed = motion.placed
    before = f"{placed.robot.name}/" if len(record.motions) > 1 else ""
    return {
        "name": placed.robot.name,
        "excluded_links": list(placed.exclude_links),
        "links": [_body(record, body, f"{before}{body.name}") for body in placed.robot.bodies],
        "links_without_shape": sorted(
            set(placed.robot.link_names) - {body.name for body in placed.robot.bodies}
        ),
    }


def _body(record: Record, body: Body, label: str) -> dict[str, Any]:
    shape = body.shape
    cloud = {}
    if isinstance(shape, PointCloud):
        cloud = {"points": shape.n_points, "ball_radius": shape.ball_radius}
    return cloud | {
        "name": label,
        "origin": public_origin(record.case, body.origin),
        "triangles": shape.n_triangles,
        "polygons": 0 if cloud else shape.n_faces,
        "bounding_box": shape.bounds.tolist(),
        "excess": shape.excess,
        "closed": shape.closed,
        "oriented": shape.oriented,
        "two_sided": bool(shape.component_two_sided.any()),
        "volume": shape.volume,
    }


def certified_of(record: Record, certificate: Certificate) -> dict[str, Any]:
    """The least proven bound [m], the interval it holds for, and the least distance seen there, if one was."""
    step = certificate.worst_interval
    times = record.steps["time"].to_numpy()
    cubic = any(motion.velocities is not None for motion in record.motions)
    return {
        "joints": "quintic" if record.timeline.path_error else "cubic" if cubic else "linear",
        "lower_bound": float(certificate.lower_bound[step]),
        "upper_bound": record.steps["upper_bound"][step].as_py(),
        "step": step,
        "start": float(times[step]),
        "end": float(times[min(step + 1, len(times) - 1)]),
        "allowed_gap": certificate.gap,
        "greatest_gap": _greatest_gap(certificate),
        "not_measured": [[*span] for span in not_measured(record.case)],
        "is_pose": record.basis == "pose",
        "tally": dict(certificate.tally),
    }


def _greatest_gap(certificate: Certificate) -> float:
    """[m] how far the two bounds are apart anywhere; intervals in which nothing is measured have none."""
    bounded = np.isfinite(certificate.lower_bound)
    return float((certificate.upper_bound[bounded] - certificate.lower_bound[bounded]).max())


def _profile(answer: ProfileAnswer) -> dict[str, Any]:
    """A profile's answer without its picture."""
    names = (field.name for field in fields(answer) if field.name != "picture")
    return {name: getattr(answer, name) for name in names}


def _cross_check(check: CrossCheck | None) -> dict[str, Any] | None:
    return None if check is None else asdict(check) | {"agrees": check.agrees}


def _tracking_error(record: Record) -> dict[str, Any] | None:
    """The greatest tracking error [rad or m] and its step; None in kinematic motion."""
    if "tracking_error" not in record.steps.column_names:
        return None
    error = record.steps["tracking_error"].to_numpy()
    step = int(np.argmax(error))
    return {"greatest": float(error[step]), "step": step}


def tessellation_bound(record: Record) -> float:
    """[m] by how much the facets of round shapes can make a clearance too small: both excesses of a
    pair."""
    links = [body.shape.excess for motion in record.motions for body in motion.placed.robot.bodies]
    obstacles = [obstacle.body.shape.excess for obstacle in record.case.obstacles]
    if record.sides[:2] == LINK_AND_OBSTACLE and not _of_one_robot(record):
        return max(links, default=0.0) + max(obstacles, default=0.0)
    return sum(sorted([*links, *obstacles])[-2:])


def _of_one_robot(record: Record) -> bool:
    """True if links are measured against one another."""
    return any(placed.self_clearance for placed in record.case.robots)


def notes_of(record: Record, hints: Sequence[str]) -> list[str]:
    robots = [note for motion in record.motions for note in motion.placed.robot.notes]
    told = [
        *hints,
        *record.case.notes,
        *robots,
        *record.notes,
        *record.contact_notes,
        *_waivers_of_others(record.case),
    ]
    return list(dict.fromkeys(told))


def _waivers_of_others(case: Case) -> list[str]:
    """That some waivers are of other cases, and say nothing here."""
    others = sum(not waiver.is_of_case(case.name) for waiver in case.waivers)
    return [f"of other cases, and not looked at: {count(others, 'waiver')}"] if others else []


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
