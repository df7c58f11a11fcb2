"""What is hot stays hot: a warm question makes as many calls of Python as the table beside this file says.

Calls are those of functions of the package, and those that it makes of numpy; a clock says something else on each
machine. Comprehensions are left out, which Python calls up to 3.11 only. A commit that changes the calls
on purpose writes the table anew: `python -m tests.simulate.measure.test_counted_calls`.
"""

from __future__ import annotations

import gc
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import FrameType

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.pose import inverse
from clearance.world.case import Case
from clearance.world.robot import JointKind
from tests.made_cases import arm, at, ball, faces_of, resampled

TABLE = Path(__file__).with_name("counted_calls.json")

N_STEPS = 1024
"""Steps of the shorter of two runs; their difference is the work of as many further steps."""

ONE_THREAD = cl.Resources(jobs=1)


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


def scene() -> Case:
    """An arm of three links that have limits, each in the next, among boxes."""
    posts = [(cl.box((0.1, 0.1, 1.0)), at(x, y)) for x, y in ((0.9, 0.2), (-0.5, 0.6))]
    positions = np.linspace([0.0, 0.1, 0.2], [1.0, -0.4, 0.3], 200)
    case = arm("arm", [cl.box((0.3, 0.1, 0.1))] * 3, posts, positions)
    (one,) = case.robots
    joints = tuple(
        replace(joint, kind=JointKind.REVOLUTE, lower=-3.0, upper=3.0) for joint in one.robot.joints
    )
    return replace(case, robots=(replace(one, robot=replace(one.robot, joints=joints)),))


def _of_its_links() -> Case:
    """The arm alone: links of one robot come nearest."""
    case = scene()
    own = replace(case.robots[0], self_clearance=cl.SelfClearance())
    return replace(case, robots=(own,), obstacles=())


def _lacks_a_face() -> Case:
    """The scene with a ball in it that has a hole, far from what moves."""
    whole = ball(0.5, 1)
    holed = cl.Polyhedron(whole.vertices, faces_of(whole)[1:])
    case = scene()
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
    "Checker.distance": lambda: _of_checker(scene()),
    "Checker.distance, links of one robot": lambda: _of_checker(_of_its_links()),
    "Checker.distance, a mesh with a hole": lambda: _of_checker(_lacks_a_face()),
    "distance": lambda: lambda: cl.distance(*BOXES, pose_b=AWAY),
    "Query.distance": _of_query,
}
"""Each makes ready, and gives the question."""


def calls_of_further_steps(certify: bool) -> dict[str, int]:
    """The calls of `N_STEPS` further steps of `check`."""
    case = scene()
    trajectory = case.robots[0].trajectory
    found = []
    for n in (N_STEPS, 2 * N_STEPS):
        times = np.linspace(trajectory.times[0], trajectory.times[-1], n)
        longer = resampled(case, times)
        found.append(calls_of(lambda case=longer: checked(case, certify)))
    return {whose: found[1][whose] - n for whose, n in found[0].items()}


def checked(case: Case, certify: bool) -> cl.Run:
    return cl.check(case, resources=ONE_THREAD, certify=certify, contact="none")


CERTIFY = {"further steps": False, "further steps, certified": True}


def counted() -> dict[str, dict[str, int]]:
    """The calls of all questions."""
    found = {name: calls_of(make()) for name, make in QUESTIONS.items()}
    return found | {name: calls_of_further_steps(certify) for name, certify in CERTIFY.items()}


def table() -> dict[str, dict[str, int]]:
    return json.loads(TABLE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_warm_question_makes_as_many_calls_as_the_table_says(question: str) -> None:
    assert calls_of(QUESTIONS[question]()) == table()[question]


@pytest.mark.parametrize("name", CERTIFY)
@pytest.mark.slow
def test_further_steps_make_as_many_calls_as_the_table_says(name: str) -> None:
    assert calls_of_further_steps(CERTIFY[name]) == table()[name]


def test_calls_are_counted_by_whose_they_are() -> None:
    """`inverse` calls asarray, zeros_like, swapaxes and einsum; a comprehension is no call."""
    pose = np.eye(4)
    assert calls_of(lambda: inverse(pose)) == {"package": 1, "numpy": 4}
    assert calls_of(lambda: [0 for _ in range(3)]) == {"package": 0, "numpy": 0}


if __name__ == "__main__":
    TABLE.write_text(json.dumps(counted(), indent=1) + "\n", encoding="utf-8")
