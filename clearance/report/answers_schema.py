"""The JSON Schemas of answers that are no run: `workspace.json`, `comparison.json`, and `srdf audit --json`.

Not for: `summary.json` and `findings.json` (`results_schema`), nor `gain.json` (`gains.figures`).
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, TypeAdapter

from clearance.profiles import compare
from clearance.record.audit import PairFinding
from clearance.record.workspace import SharedLinks
from clearance.report import srdf, workspace
from clearance.report.results_rows import Keys, Point
from clearance.report.results_schema import closed_schema

Flat = tuple[float, float]
Side = Literal["a", "b"]


class Workspace(Keys):
    """`workspace.json`: the region that robots share [m, m³]; null: none."""

    named: Literal[workspace.SCHEMA] = Field(alias="$schema")  # type: ignore[valid-type]
    robots: list[str]
    volume: float
    volume_is: Literal["upper bound"]
    centroid: Point | None
    bounding_box: tuple[Point, Point] | None
    links: list[SharedLinks]
    n_pieces: list[int]
    within: float
    leaves: float
    excluded: list[str]
    without: str
    not_counted: list[tuple[str, str]]
    triangles: int


class Audit(Keys):
    """The output of `clearance srdf audit --json`."""

    named: Literal[srdf.SCHEMA] = Field(alias="$schema")  # type: ignore[valid-type]
    never_refuted: int
    never_unproven: int
    adjacent_refuted: int
    narrowed: list[str]
    pairs: list[PairFinding]


class Hausdorff(Keys):
    """The Hausdorff distance, with its proven error and witnesses."""

    distance: float
    error_bound: float
    direction: Literal["a_to_b", "b_to_a"]
    point_a: Flat
    point_b: Flat


class Directed(Keys):
    """The greatest distance from one outline to the other, with its bounds."""

    distance: float
    upper: float
    lower: float
    point_a: Flat
    point_b: Flat


class Maker(Keys):
    """The link and the step that swept a point."""

    link: str
    step: int


class Exceedance(Keys):
    """A stretch of an outline that is beyond the limit."""

    outline: Side
    start: Flat
    end: Flat
    length: float
    distance: float
    point: Flat


class Comparison(Keys):
    """`comparison.json` of `clearance profile compare`, in the outlines' unit; null: none."""

    named: Literal[compare.SCHEMA] = Field(alias="$schema")  # type: ignore[valid-type]
    a: str
    b: str
    hausdorff: Hausdorff
    directed: dict[Literal["a_to_b", "b_to_a"], Directed]
    deviation: dict[Literal["a_to_b", "b_to_a"], dict[str, float]]
    area_gained: float | None
    area_lost: float | None
    limit: float | None
    within_limit: bool
    verdict: Literal["within", "beyond", "undecided"]
    beyond: list[Exceedance]
    worst_made_by: dict[Side, Maker]
    bounds: dict[Side, float | None]


def workspace_schema() -> dict[str, Any]:
    """The JSON Schema of `workspace.json`."""
    return closed_schema(workspace.SCHEMA, TypeAdapter(Workspace).json_schema())


def audit_schema() -> dict[str, Any]:
    """The JSON Schema of an audit."""
    return closed_schema(srdf.SCHEMA, TypeAdapter(Audit).json_schema())


def comparison_schema() -> dict[str, Any]:
    """The JSON Schema of `comparison.json`."""
    return closed_schema(compare.SCHEMA, TypeAdapter(Comparison).json_schema())
