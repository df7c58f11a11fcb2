"""The summary of a run as plain data: what `summary.json` holds and what the page prints.

Lengths are in metres, times in seconds, angles in radians, all under names that say so in the
guide (`scripts/docs/results.md`). Not for: the keys of each topic (`topics`), wording and rounding.
"""

from __future__ import annotations

import json
from typing import Any

from clearance.report.model import ReportModel
from clearance.report.topics import EVERY

FORMAT = 4
"""Which keys there are: `scripts/docs/results.md`."""

SCHEMA = f"urn:clearance:summary:{FORMAT}"
"""The name of the JSON Schema, which `clearance schema --results` prints."""


def summary_of(model: ReportModel) -> dict[str, Any]:
    """Everything about a run that fits on a page, as JSON-ready values; a limit that does not
    exist is None. Keys `tolerances`, `recordings` and `body_gaps` are there where a case has them."""
    content: dict[str, Any] = {"$schema": SCHEMA, "format": FORMAT, "name": model.record.case.name}
    for topic in EVERY:
        if topic.data is not None:
            named = model.record.moves.named
            content |= {key: named(value) for key, value in topic.data(model).items()}
    return content


def json_text(summary: dict[str, Any]) -> str:
    """The summary as `summary.json` holds it: sorted keys, floats that read back the same, no
    NaN."""
    return json.dumps(summary, indent=2, sort_keys=True, allow_nan=False, ensure_ascii=False) + "\n"
