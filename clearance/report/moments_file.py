"""`worst_moments.yaml`: the worst moments of a run for programs that speak MoveIt. Not for: what is in it
(`moveit_moments`).
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from clearance.report.model import ReportModel
from clearance.report.moveit_moments import moments_of

FILE_NAME = "worst_moments.yaml"

_HEAD = """\
# The worst moments of a run: metres, radians, seconds, points in the world of the case; bodies and states as
# MoveIt names them. First what stands worst, then each pair and rule that comes near or below a limit, as many
# as a file holds: n_left_out are not listed.
"""


def moments_text(model: ReportModel) -> str:
    """The file's text; the same data give the same."""
    return _HEAD + "\n".join(_lines(moments_of(model))) + "\n"


def _lines(given: dict[str, Any]) -> Iterator[str]:
    """The lines of a mapping: what is flat in one line, lists of mappings item by item."""
    for key, value in given.items():
        if not (isinstance(value, list) and value and isinstance(value[0], dict)) or _is_points(
            value
        ):
            yield f"{key}: {_flow(value)}"
            continue
        yield f"{key}:"
        for one in value:
            for i, line in enumerate(_lines(one)):
                yield f"{'  ' if i else '- '}{line}"


def _is_points(value: list[dict[str, Any]]) -> bool:
    return set(value[0]) == set("xyz")


def _flow(value: Any) -> str:
    """A value as YAML on one line, which YAML 1.1 and 1.2 read alike; doubles come back bit for bit."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, float):
        text = repr(value)
        return text if "." in text else text.replace("e", ".0e")
    return json.dumps(value, ensure_ascii=False)
