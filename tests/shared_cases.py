"""The four real cases beside the repository: where they are, and what a test does without them."""

from __future__ import annotations

from pathlib import Path

import pytest

SHARED_CASES = Path(__file__).parents[2] / "shared" / "cases"

SHARED_NAMES = (
    "fetch_cage_planned",
    "kuka_iiwa_valve_wall",
    "lbr_puzzle_grinder",
    "panda_bookshelf_thin_planned",
)


def shared_case(name: str) -> Path:
    """The case file of one of them; the test that asks is skipped where it is not there."""
    path = SHARED_CASES / name / "case.yaml"
    if not path.is_file():
        pytest.skip("the shared cases are not beside this checkout")
    return path
