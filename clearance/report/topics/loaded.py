"""Every body that was loaded, with its size and quality."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from clearance.geometry.point_cloud import PointCloud
from clearance.record.record import Record
from clearance.report.blocks import Cell, Row, Section, Table, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.topic import Topic
from clearance.report.topics.provenance import public_origin
from clearance.world.body import Body
from clearance.world.motion import Motion


def data(model: ReportModel) -> dict[str, Any]:
    """Robots and obstacles, body by body."""
    record = model.record
    obstacles = record.case.obstacles
    return {
        "robots": [_robot(record, motion) for motion in record.motions],
        "obstacles": [_body(record, obstacle.body, obstacle.name) for obstacle in obstacles],
    }


def _robot(record: Record, motion: Motion) -> dict[str, Any]:
    placed = motion.placed
    before = f"{placed.robot.name}/" if len(record.motions) > 1 else ""
    shaped = {body.name for body in placed.robot.bodies}
    return {
        "name": placed.robot.name,
        "excluded_links": list(placed.exclude_links),
        "links": [_body(record, body, f"{before}{body.name}") for body in placed.robot.bodies],
        "links_without_shape": sorted(set(placed.robot.link_names) - shaped),
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


def sections(content: PageContent) -> Iterator[Section]:
    """A table a robot, and one of obstacles."""
    summary = content.summary
    groups = [(f"Robot {robot['name']}", robot["links"]) for robot in summary["robots"]]
    groups.append(("Obstacles", summary["obstacles"]))
    heads = (
        "From", ">Triangles", ">Polygons", ">Size, mm", ">Volume, cm³", "Surface", ">Facets, mm"
    )  # fmt: skip
    tables = [Table((name, *heads), [*map(_row, bodies)], "bodies") for name, bodies in groups]
    yield Section("Loaded bodies", tables)


def _row(body: dict[str, Any]) -> Row:
    low, high = body["bounding_box"]
    times = " \N{MULTIPLICATION SIGN} "
    return Row(
        [
            body["name"],
            Cell(body["origin"], "faint"),
            number(f"{body['triangles']:,}"),
            number(f"{body['polygons']:,}"),
            number(times.join(f"{(b - a) * 1000:.4g}" for a, b in zip(low, high, strict=True))),
            number("" if body["volume"] is None else _rounded(body["volume"] * 1e6)),
            _quality(body),
            number("exact" if body["excess"] == 0.0 else f"{body['excess'] * 1000:.3g}"),
        ]
    )


def _quality(body: dict[str, Any]) -> str:
    """What kind of surface a body has; one that holds faces once for each side has no inside there."""
    if "points" in body:
        return f"{body['points']:,} balls of {body['ball_radius'] * 1000:.4g} mm"
    if not body["closed"]:
        return "open"
    if body["two_sided"]:
        return "two-sided"
    return "closed" if body["oriented"] else "closed, not oriented"


def _rounded(value: float) -> str:
    if abs(value) < 1e-6:  # a double wall: its sides cancel but for rounding
        return "0"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"


TOPIC: Topic = Topic(data, sections=sections)
