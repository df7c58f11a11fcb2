"""Measures run time against error, for us and for everybody else, on the same input in one run.

    python scripts/bench/error_time.py [--csv FILE] [--picture FILE] [--polygons N] [--poses N] [--steps N]

Polygon pairs of every hostile family, pairs of bodies, and whole steps of the shared cases. Times are CPU a
query, posing included, forms and trees made before, least of three calls; errors are in parts of the size of
the two bodies, for steps in metres. A contact is false (missed) if the truth (the answer) exceeds
1e-12 of the size; the csv also counts them to the last bit. No answer (NaN, infinity) is counted apart.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from typing import NamedTuple

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from contenders import BoundingSpheres, ConvexHulls, Ours, Paper, SampledPoints, SampledScene
from harness import Row, least_time, tell, timed
from inputs import Scene, absent_inputs
from loops import AllPairs, OurSteps
from peers import PEERS, PairPeer, absent_peers, available, peer, silenced, versions
from questions import Question, body_questions, polygon_questions, step_sample, step_scenes

import clearance as cl
from clearance.errors import ClearanceError

ROUNDING = 1e-12
"""[-] Contact closer than this part of the size is no fault of a float64 library."""

MOST_FACE_PAIRS = 20_000_000
"""A step for the paper's method; scenes of more are left out, and named (minutes a step)."""


SHOWN = (
    "group", "method", "us_median", "us_10th", "us_90th", "error_median", "error_worst", "false_contacts",
    "missed_contacts", "no_answer", "asked",
)  # fmt: skip

SMALLEST = ["--polygons", "1", "--poses", "1", "--steps", "0", "--seconds", "0.02", "--points", "3"]


class Answer(NamedTuple):
    """One query: seconds, error and truth in parts of the size, and how contact came out."""

    seconds: float
    error: float
    relative: float
    over: float
    false_contact: bool
    missed_contact: bool
    gross: bool


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__,
        words,
        polygons=60,
        poses=8,
        steps=12,
        scenes=[],
        seconds=1.5,
        points=[3, 4, 5, 6],
        picture="",
    )
    tell(*absent_inputs(), *absent_peers())
    rows = measured_polygons(polygon_questions(asked.polygons), asked.seconds)
    rows += measured_bodies([*body_questions(asked.poses)], asked.seconds, asked.points)
    for scene in step_scenes(asked.scenes) if asked.steps else ():
        if face_pairs(scene) > MOST_FACE_PAIRS:
            tell(f"left out: paper on {scene.name}, {face_pairs(scene)} face pairs a step")
        rows += measured_steps(scene, step_sample(scene, asked.steps), asked.seconds)
    harness.show("run time against error (parts of the size; steps: metres)", totals(rows), SHOWN)
    tell(versions())
    harness.write_csv(rows, asked.csv)
    if asked.picture:
        from figures import draw_error_time

        draw_error_time(totals(rows), asked.picture)
    return rows


def other_libraries() -> Iterable[PairPeer]:
    """Every peer that is there."""
    for key in PEERS:
        if (found := peer(key)) is not None:
            yield found


def measured_polygons(questions: Sequence[Question], seconds: float) -> list[Row]:
    """One row a family and method."""
    rows = our_batches(questions)
    rows += asked_one_by_one(
        "polygons", "clearance", "clearance one a call", questions, seconds, _ours
    )
    rows += asked_one_by_one("polygons", "clearance paper", "paper", questions, seconds, _paper)
    methods = [*other_libraries(), *(SampledPoints(10**k) for k in (3, 4)), BoundingSpheres()]
    for by in methods:
        rows += asked_of("polygons", by, questions, seconds)
    return rows


def our_batches(questions: Sequence[Question]) -> list[Row]:
    """`polygon_distances`, a family a call, as one has it for many."""
    rows = []
    for family in dict.fromkeys(q.family for q in questions):
        chosen = [q for q in questions if q.family == family]
        ps = np.array([q.a.soup.vertices for q in chosen])
        qs = np.array([q.b.soup.vertices for q in chosen])
        cl.polygon_distances(ps, qs)
        spent, found = least_time(lambda ps=ps, qs=qs: cl.polygon_distances(ps, qs), 5)
        each = spent / len(chosen)
        judged = [judge(q, d, each) for q, d in zip(chosen, found, strict=True)]
        rows.append(row_of("polygons", family, "clearance", "clearance exact", judged, len(chosen)))
    return rows


def _ours(question: Question) -> Callable[[], float]:
    p, q = question.a.soup.vertices, question.b.soup.vertices
    return lambda: cl.polygon_distance(p, q).distance


def _paper(question: Question) -> Callable[[], float]:
    p, q = question.a.soup.vertices, question.b.soup.vertices
    return lambda: cl.polygon_distance(p, q, method="paper").distance


def measured_bodies(
    questions: Sequence[Question], seconds: float, powers: Sequence[int]
) -> list[Row]:
    """One row a family and method; `powers` of ten are how many points are sampled."""
    papers = [
        Paper(), Paper(1.0), Paper(0.1), Paper(0.01), Paper(0.1, rule_2=False), Paper(rule_2=False),
    ]  # fmt: skip
    points = [SampledPoints(10**k) for k in powers]
    methods: list[PairPeer] = [Ours(), *papers, *other_libraries(), *points, BoundingSpheres()]
    methods += [ConvexHulls()] if available("coal") else []
    return [row for by in methods for row in asked_of("bodies", by, questions, seconds)]


def asked_of(group: str, by: PairPeer, questions: Sequence[Question], seconds: float) -> list[Row]:
    """One row a family of what a contender answers."""

    def ready(question: Question) -> Callable[[], float]:
        with silenced():
            a, b = by.body(question.a), by.body(question.b)

        def ask() -> float:
            by.place(a, question.pose_a)
            by.place(b, question.pose_b)
            return by.distance(a, b)

        return ask

    rows = asked_one_by_one(group, library_of(by.name), by.name, questions, seconds, ready)
    if hasattr(by, "close"):
        by.close()
    return rows


def asked_one_by_one(
    group: str,
    library: str,
    method: str,
    questions: Sequence[Question],
    seconds: float,
    ready: Callable[[Question], Callable[[], float]],
) -> list[Row]:
    """One row a family; questions left when `seconds` of CPU are spent are not asked."""
    families = list(dict.fromkeys(question.family for question in questions))
    judged: dict[str, list[Answer]] = {family: [] for family in families}
    asked, spent = dict.fromkeys(families, 0), 0.0
    with suppress(ClearanceError, RuntimeError, ValueError):
        ready(questions[0])()  # compiles what is to be compiled, outside the clock
    for question in questions:
        if spent > seconds:
            break
        asked[question.family] += 1
        try:
            ask = ready(question)
            taken = [timed(ask)]
            taken += [timed(ask) for _ in range(2 if taken[0][0] < 0.1 else 0)]
        except (ClearanceError, RuntimeError, ValueError):
            continue  # refused: no answer
        spent += sum(t for t, _ in taken)
        answer = taken[-1][1]
        if np.isfinite(answer):
            judged[question.family].append(judge(question, answer, min(t for t, _ in taken)))
    return [row_of(group, f, library, method, judged[f], asked[f]) for f in families if asked[f]]


def judge(question: Question, answer: float, seconds: float) -> Answer:
    """An answer held against the truth."""
    error, truth = question.error(answer), question.truth
    return judgement(error, truth / question.size, answer / question.size, seconds)


def judgement(error: float, truth: float, answer: float, seconds: float) -> Answer:
    """The same from numbers in parts of the size."""
    false, missed = answer <= 0.0 < truth, truth == 0.0 < answer
    gross = (false and truth > ROUNDING) or (missed and answer > ROUNDING)
    relative = error / truth if truth >= 1e-6 else 0.0
    return Answer(seconds, error, relative, max(0.0, answer) - truth, false, missed, gross)


def measured_steps(scene: Scene, steps: np.ndarray, seconds: float) -> list[Row]:
    """One row a method on one shared case."""
    papers = [Paper(), Paper(rule_2=False)] if face_pairs(scene) <= MOST_FACE_PAIRS else []
    loops = [AllPairs(scene, by) for by in [*papers, *other_libraries(), BoundingSpheres()]]
    loops += [AllPairs(scene, ConvexHulls())] if available("coal") else []
    loops += [SampledScene(scene, 10**k) for k in (3, 4, 5, 6)]
    rows = [_our_steps(scene, steps)]
    for loop in loops:
        name = loop.name.removesuffix(": all pairs")
        judged, spent = [], 0.0
        for step in steps:
            if spent > seconds:
                break
            taken, answer = timed(lambda loop=loop, step=step: float(loop.run(np.array([step]))[0]))
            spent += taken
            if np.isfinite(answer):
                judged.append(judge_step(scene, step, answer, taken))
        rows.append(row_of("steps", scene.name, library_of(name), name, judged, len(judged)))
    return rows


def face_pairs(scene: Scene) -> int:
    """Pairs of faces that a method without a tree looks at in a step."""
    faces = np.array([body.shape.n_faces for body in scene.bodies])
    return int(faces[scene.index].prod(axis=1).sum())


def _our_steps(scene: Scene, steps: np.ndarray) -> Row:
    ours, everything = OurSteps(scene), np.arange(scene.n_steps)
    ours.run(everything)
    taken, found = least_time(lambda: ours.run(everything), 3)
    judged = [judge_step(scene, step, found[step], taken / scene.n_steps) for step in steps]
    return row_of("steps", scene.name, "clearance", "clearance exact", judged, len(judged))


def judge_step(scene: Scene, step: int, answer: float, seconds: float) -> Answer:
    """A step's clearance [m] held against the reference."""
    truth = float(scene.reference[0][step])
    return judgement(abs(max(0.0, answer) - truth), truth, answer, seconds)


def library_of(name: str) -> str:
    """The family of methods that shares a colour."""
    for start, library in (
        ("clearance", "clearance"), ("paper", "clearance paper"), ("FCL", "FCL"), ("Coal", "Coal"),
        ("Klampt", "Klampt"), ("PyBullet", "PyBullet"), ("points", "sampled points"),
    ):  # fmt: skip
        if name.startswith(start):
            return library
    return "approximations"


def row_of(
    group: str, family: str, library: str, method: str, judged: Sequence[Answer], asked: int
) -> Row:
    """What is known of a method on a family; NaN where it answered nothing."""
    none = [Answer(*[np.nan] * 4, False, False, False)]
    table = np.array([answer[:4] for answer in judged or none])
    low, median, high = np.percentile(table[:, 0], [10, 50, 90]) * 1e6
    return {
        "group": group,
        "family": family,
        "library": library,
        "method": method,
        "asked": asked,
        "no_answer": asked - len(judged),
        "us_median": median,
        "us_10th": low,
        "us_90th": high,
        "error_median": np.median(table[:, 1]),
        "error_worst": table[:, 1].max(),
        "error_to_distance_worst": table[:, 2].max(),
        "overstated_worst": max(0.0, table[:, 3].max()) if judged else np.nan,
        "false_contacts": sum(a.false_contact and a.gross for a in judged),
        "missed_contacts": sum(a.missed_contact and a.gross for a in judged),
        "false_contacts_any": sum(a.false_contact for a in judged),
        "missed_contacts_any": sum(a.missed_contact for a in judged),
    }


SUMMED = [
    "asked", "no_answer", "false_contacts", "missed_contacts", "false_contacts_any", "missed_contacts_any",
]  # fmt: skip


def totals(rows: Sequence[Row]) -> list[Row]:
    """One row a group and method: counts summed, worst of the worst, median of the medians."""
    found = []
    for key in dict.fromkeys((row["group"], row["library"], row["method"]) for row in rows):
        chosen = [row for row in rows if (row["group"], row["library"], row["method"]) == key]
        total = dict(zip(("group", "library", "method"), key, strict=True), family="all")
        total |= {name: sum(row[name] for row in chosen) for name in SUMMED}
        answered = [row for row in chosen if row["no_answer"] < row["asked"]]
        for name in ("us_median", "us_10th", "us_90th", "error_median"):
            total[name] = float(np.median([row[name] for row in answered])) if answered else np.nan
        for name in ("error_worst", "error_to_distance_worst", "overstated_worst"):
            total[name] = max((row[name] for row in answered), default=np.nan)
        found.append(total)
    return found


if __name__ == "__main__":
    main()
