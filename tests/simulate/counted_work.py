"""The work of warm questions, counted: calls of Python, and what kernels count themselves.

    python -m tests.simulate.counted_work

writes the table anew, and says what has changed in it; rows of the shared cases stay as they are where these are
not there. A clock says something else on each machine; these numbers are the same on all. Calls are those of
functions of the package, and those that it makes of numpy. Comprehensions are left out, which Python calls up to
3.11 only.
"""

from __future__ import annotations

import gc
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import FrameType

import numpy as np

import clearance as cl
from clearance.simulate.measure.resources import Resources
from clearance.world.case import Case
from tests.made_cases import at, ball, faces_of, torus
from tests.shared_cases import SHARED_CASES, SHARED_NAMES

ROOT = Path(__file__).parents[2]
SCENES = tuple(path.parent.name for path in sorted((ROOT / "scenes").glob("*/case.yaml")))
TABLE = Path(__file__).with_name("work_per_question.json")

N_STEPS = 1024
"""Steps of the shorter of two runs; their difference is the work of as many further steps."""

ONE_THREAD = Resources(jobs=1)


def table() -> dict[str, dict]:
    """The numbers that are held to: calls by question, counters of kernels by scene and by question."""
    return json.loads(TABLE.read_text(encoding="utf-8"))


class _Calls:
    """Counts the calls that it hears of: `n`, by whose they are."""

    def __init__(self) -> None:
        self.n = {"package": 0, "numpy": 0}

    def __call__(self, frame: FrameType, event: str, callee: object) -> None:
        if event == "call" and not frame.f_code.co_name.endswith(("comp>", "_dispatcher")):
            if _is_ours(frame):
                self.n["package"] += 1
            elif _module(frame).startswith("numpy") and _is_ours(frame.f_back):
                self.n["numpy"] += 1
        elif event == "c_call" and _is_ours(frame) and _is_of_numpy(callee):
            self.n["numpy"] += 1


def _module(frame: FrameType | None) -> str:
    return "" if frame is None else frame.f_globals.get("__name__", "")


def _is_ours(frame: FrameType | None) -> bool:
    return _module(frame).startswith("clearance.")


def _is_of_numpy(callee: object) -> bool:
    owner = getattr(callee, "__self__", None)
    modules = getattr(callee, "__module__", None), getattr(owner, "__name__", None)
    return isinstance(owner, np.ndarray) or any(str(name).startswith("numpy") for name in modules)


def calls_of(ask: Callable[[], object]) -> dict[str, int]:
    """The calls of a question that was asked twice before; no garbage is collected meanwhile."""
    ask(), ask()
    calls, before = _Calls(), sys.getprofile()
    gc.collect()
    gc.disable()
    sys.setprofile(calls)
    try:
        ask()
    finally:
        sys.setprofile(before)
        gc.enable()
    return calls.n


def scene(name: str) -> Case:
    """A case of `scenes`."""
    return cl.load_case(ROOT / "scenes" / name / "case.yaml")


def _lacks_a_face() -> Case:
    """The Panda's scene with a ball in it that has a hole, far from what moves."""
    whole = ball(0.05, 1)
    holed = cl.Polyhedron(whole.vertices, faces_of(whole)[1:])
    case = scene("panda_shelf")
    far = cl.Obstacle(cl.Body("holed", holed), at(-3.0))
    return replace(case, obstacles=(*case.obstacles, far))


def _of_checker(case: Case) -> Callable[[], object]:
    checker = cl.Checker(case)
    positions = [row for placed in case.robots for row in placed.trajectory.positions[3]]
    return lambda: checker.distance(np.array(positions))


def _of_query() -> Callable[[], object]:
    query = cl.Query(*BOXES)
    return lambda: query.distance(world_from_b=AWAY)


BOXES = cl.box((1.0, 1.0, 1.0)), cl.box((0.5, 0.5, 0.5))
AWAY = at(2.0, 0.1, 0.3)


QUESTIONS: dict[str, Callable[[], Callable[[], object]]] = {
    "Checker.distance": lambda: _of_checker(scene("panda_shelf")),
    "Checker.distance, links of one robot": lambda: _of_checker(scene("dual_arm_handover")),
    "Checker.distance, a mesh with a hole": lambda: _of_checker(_lacks_a_face()),
    "distance": lambda: lambda: cl.distance(*BOXES, pose_b=AWAY),
    "Query.distance": _of_query,
}
"""Each makes ready, and gives the question."""


def calls_of_further_steps(certify: bool) -> dict[str, int]:
    """The calls of `N_STEPS` further steps of `check`."""
    case = scene("panda_shelf")
    trajectory = case.robots[0].trajectory
    found = []
    for n in (N_STEPS, 2 * N_STEPS):
        times = np.linspace(trajectory.times[0], trajectory.times[-1], n)
        columns = [np.interp(times, trajectory.times, column) for column in trajectory.positions.T]
        longer = case.with_trajectory(times, np.stack(columns, axis=1))
        found.append(calls_of(lambda case=longer: checked(case, certify)))
    return {whose: found[1][whose] - n for whose, n in found[0].items()}


def checked(case: Case, certify: bool) -> cl.Run:
    return cl.check(case, resources=ONE_THREAD, certify=certify, contact="none")


def counters_of_run(case: Case) -> dict[str, dict[str, int]]:
    """What the kernels of a certified run counted: at the steps, and for the proofs of all rules."""
    record = checked(case, certify=True).record
    proofs = [rule.certificate.tally for rule in record.rules]
    names = sorted({name for tally in proofs for name in tally})
    proven = {name: sum(tally.get(name, 0) for tally in proofs) for name in names}
    return {"steps": dict(record.tally), "proof": proven}


PAIRS = {
    "boxes apart": (*BOXES, AWAY),
    "boxes that touch": (*BOXES, at(0.75)),
    "balls that nearly touch": (ball(1.0, 3), ball(1.0, 3), at(2.0 + 1e-9)),
    "rings through each other": (torus(1.0, 0.2, 32, 16), torus(1.0, 0.2, 32, 16), at(1.0, 0.0, 0.1)),
    "a ball in a ball": (ball(1.0, 3), ball(0.2, 2), at(0.1, 0.2, 0.3)),
}  # fmt: skip


def counters_of_pair(name: str) -> dict[str, dict[str, int]]:
    """What the search counted for a pair: asked once, and by a query along 50 poses that end there."""
    a, b, end = PAIRS[name]
    query, total = cl.Query(a, b), dict.fromkeys(("nodes", "polygons", "exact_decisions"), 0)
    for share in np.linspace(1.5, 1.0, 50):
        near = query.distance(world_from_b=at(*(share * end[:3, 3])))
        total = {counter: n + near.tally[counter] for counter, n in total.items()}
    return {"once": cl.distance(a, b, pose_b=end).tally, "50 poses": total}


def counted_anew(before: dict) -> dict:
    """The table as the tree has it; shared cases that are not there as they were `before`."""
    calls = {name: calls_of(make()) for name, make in QUESTIONS.items()}
    calls["further steps"] = calls_of_further_steps(certify=False)
    calls["further steps, certified"] = calls_of_further_steps(certify=True)
    runs = {name: counters_of_run(scene(name)) for name in SCENES}
    for name in SHARED_NAMES:
        path = SHARED_CASES / name / "case.yaml"
        known = before.get("runs", {}).get(name)
        runs[name] = counters_of_run(cl.load_case(path)) if path.is_file() else known
    return {"calls": calls, "runs": runs, "pairs": {name: counters_of_pair(name) for name in PAIRS}}


def changes(where: str, before: object, now: object) -> Iterator[str]:
    """A line for each number that has changed."""
    if isinstance(now, dict):
        known = before if isinstance(before, dict) else {}
        for key in {**known, **now}:
            yield from changes(f"{where}{key}: ", known.get(key), now.get(key))
    elif before != now:
        yield f"{where}{before} -> {now}"


def main() -> None:
    """Writes the table."""
    before = table() if TABLE.exists() else {}
    now = counted_anew(before)
    for change in changes("", before, now):
        print(change)
    TABLE.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
