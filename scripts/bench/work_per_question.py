"""Writes the table of work per question anew, and says what has changed in it.

    python scripts/bench/work_per_question.py

The numbers are counts, not times: calls of warm questions, and what kernels count themselves
(`tests/simulate/counted_work.py`). `tests/simulate/test_work_per_question.py` holds the tree to them. Rows of the
shared cases stay as they are where these are not there.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import clearance as cl
from tests.shared_cases import SHARED_CASES, SHARED_NAMES
from tests.simulate import counted_work


def main() -> None:
    """Writes the table."""
    before = counted_work.table() if counted_work.TABLE.exists() else {}
    now = _table(before)
    for change in _changes("", before, now):
        print(change)
    counted_work.TABLE.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")


def _table(before: dict) -> dict:
    questions = counted_work.QUESTIONS.items()
    calls = {name: counted_work.calls_of(make()) for name, make in questions}
    calls["further steps"] = counted_work.calls_of_further_steps(certify=False)
    calls["further steps, certified"] = counted_work.calls_of_further_steps(certify=True)
    runs = {
        name: counted_work.counters_of_run(counted_work.scene(name)) for name in counted_work.SCENES
    }
    for name in SHARED_NAMES:
        path = SHARED_CASES / name / "case.yaml"
        known = before.get("runs", {}).get(name)
        runs[name] = counted_work.counters_of_run(cl.load_case(path)) if path.is_file() else known
    pairs = {name: counted_work.counters_of_pair(name) for name in counted_work.PAIRS}
    return {"calls": calls, "runs": runs, "pairs": pairs}


def _changes(where: str, before: object, now: object) -> Iterator[str]:
    """A line for each number that has changed."""
    if isinstance(now, dict):
        known = before if isinstance(before, dict) else {}
        for key in {**known, **now}:
            yield from _changes(f"{where}{key}: ", known.get(key), now.get(key))
    elif before != now:
        yield f"{where}{before} -> {now}"


if __name__ == "__main__":
    main()
