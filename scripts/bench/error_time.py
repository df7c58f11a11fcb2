"""Measures run time against error, for us and for everybody else, on the same input in one run.

    python scripts/bench/error_time.py [--out FOLDER] [--polygons N] [--poses N] [--steps N] [--seconds S]

Polygon pairs of every family of tests/strategies.py, pairs of bodies, and whole steps of the shared cases.
Writes error_time.csv, error_time.svg and polygon_families.svg into --out, and prints the totals. Times are
CPU a query, posing included, forms and trees made before, least of three calls; errors are in parts of the
size of the two bodies, for steps in metres. A contact is false (missed) if the truth (the answer) exceeds
1e-12 of the size; the csv also counts them to the last bit. No answer (NaN, infinity) is counted apart.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from clock import timed
from contenders import BoundingSpheres, ConvexHulls, Ours, Paper, SampledPoints, SampledScene
from inputs import Scene
from loops import AllPairs, OurSteps
from peers import PEERS, PairPeer, absent_peers, available, peer, silenced, versions
from questions import Question, body_questions, polygon_questions, step_sample, step_scenes
from rich.console import Console
from rich.table import Table

import clearance as cl
from clearance.errors import ClearanceError

ROUNDING = 1e-12
"""[-] Contact closer than this part of the size is no fault of a float64 library."""

MOST_FACE_PAIRS = 20_000_000
"""A step for the paper's method; scenes of more are left out, and named (minutes a step)."""


class Answer(NamedTuple):
    """One query: seconds, error and truth in parts of the size, and how contact came out."""

    seconds: float
    error: float
    relative: float
    over: float
    false_contact: bool
    missed_contact: bool
    gross: bool


def main() -> None:
    """Runs what the command line asks for."""
    asked = arguments()
    console = Console(width=None if sys.stdout.isatty() else 160)
    for line in [*inputs.absent_inputs(), *absent_peers()]:
        console.print(line, style="yellow", highlight=False)
    rows: list[dict] = []
    if asked.polygons:
        rows += measured_polygons(polygon_questions(asked.polygons), asked.seconds)
    if asked.poses:
        rows += measured_bodies(body_questions(asked.poses), asked.seconds)
    if asked.steps:
        for scene in step_scenes(asked.scenes):
            if face_pairs(scene) > MOST_FACE_PAIRS:
                console.print(
                    f"left out: paper on {scene.name}, {face_pairs(scene)} face pairs a step"
                )
            rows += measured_steps(scene, step_sample(scene, asked.steps), asked.seconds)
    console.print(table_of(totals(rows)))
    console.print(versions(), highlight=False)
    if asked.out:
        write(rows, asked.out)
        if available("matplotlib"):
            from figures import draw_error_time, draw_families

            draw_error_time(totals(rows), asked.out / "error_time.svg")
            draw_families(rows, asked.out / "polygon_families.svg")
        else:
            console.print("absent: matplotlib (pip install .[bench]); no pictures")


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, help="folder for the csv and the pictures")
    parser.add_argument("--polygons", type=int, default=60, help="pairs a family")
    parser.add_argument("--poses", type=int, default=8, help="poses a family of bodies")
    parser.add_argument("--steps", type=int, default=12, help="steps a shared case")
    parser.add_argument("--scenes", nargs="*", default=None, help="shared cases; all if not given")
    parser.add_argument("--seconds", type=float, default=1.5, help="CPU a method and group")
    return parser.parse_args()


def other_libraries() -> Iterable[PairPeer]:
    """Every peer that is there."""
    for key in PEERS:
        if (found := peer(key)) is not None:
            yield found


def measured_polygons(questions: Sequence[Question], seconds: float) -> list[dict]:
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


def our_batches(questions: Sequence[Question]) -> list[dict]:
    """`polygon_distances`, a family a call, as one has it for many."""
    rows = []
    for family in dict.fromkeys(q.family for q in questions):
        chosen = [q for q in questions if q.family == family]
        ps = np.array([q.a.soup.vertices for q in chosen])
        qs = np.array([q.b.soup.vertices for q in chosen])
        cl.polygon_distances(ps, qs)
        passes = [timed(lambda ps=ps, qs=qs: cl.polygon_distances(ps, qs)) for _ in range(5)]
        each = min(spent for spent, _ in passes) / len(chosen)
        judged = [judge(q, d, each) for q, d in zip(chosen, passes[-1][1], strict=True)]
        rows.append(row_of("polygons", family, "clearance", "clearance exact", judged, len(chosen)))
    return rows


def _ours(question: Question) -> Callable[[], float]:
    p, q = question.a.soup.vertices, question.b.soup.vertices
    return lambda: cl.polygon_distance(p, q).distance


def _paper(question: Question) -> Callable[[], float]:
    p, q = question.a.soup.vertices, question.b.soup.vertices
    return lambda: cl.polygon_distance(p, q, method="paper").distance


def measured_bodies(questions: Sequence[Question], seconds: float) -> list[dict]:
    """One row a family and method."""
    papers = [
        Paper(), Paper(1.0), Paper(0.1), Paper(0.01), Paper(0.1, rule_2=False), Paper(rule_2=False),
    ]  # fmt: skip
    points = [SampledPoints(10**k) for k in (3, 4, 5, 6)]
    methods: list[PairPeer] = [Ours(), *papers, *other_libraries(), *points, BoundingSpheres()]
    methods += [ConvexHulls()] if available("coal") else []
    return [row for by in methods for row in asked_of("bodies", by, questions, seconds)]


def asked_of(group: str, by: PairPeer, questions: Sequence[Question], seconds: float) -> list[dict]:
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
) -> list[dict]:
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


def measured_steps(scene: Scene, steps: np.ndarray, seconds: float) -> list[dict]:
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
    faces = [[body.shape.n_faces for body in side] for side in (scene.links, scene.obstacles)]
    return int(sum(faces[0][i] * faces[1][j] for i, j in scene.index))


def _our_steps(scene: Scene, steps: np.ndarray) -> dict:
    ours, everything = OurSteps(scene), np.arange(scene.n_steps)
    ours.run(everything)
    taken = min(timed(lambda: ours.run(everything))[0] for _ in range(3)) / scene.n_steps
    found = ours.run(everything)
    judged = [judge_step(scene, step, found[step], taken) for step in steps]
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
) -> dict:
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


def totals(rows: Sequence[dict]) -> list[dict]:
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


def table_of(rows: Sequence[dict]) -> Table:
    """Time, errors and contact faults of every method in every group."""
    table = Table(title="run time against error (errors in parts of the size; steps: metres)")
    table.add_column("group", no_wrap=True)
    table.add_column("method", no_wrap=True)
    names = (
        "us",
        "10th-90th",
        "median",
        "worst",
        "of distance",
        "false",
        "missed",
        "none",
        "asked",
    )
    for name in names:
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            row["group"], row["method"], f"{row['us_median']:.3g}",
            f"{row['us_10th']:.3g}-{row['us_90th']:.3g}", f"{row['error_median']:.1e}",
            f"{row['error_worst']:.1e}", f"{row['error_to_distance_worst']:.1e}",
            str(row["false_contacts"]), str(row["missed_contacts"]), str(row["no_answer"]), str(row["asked"]),
        )  # fmt: skip
    return table


def write(rows: Sequence[dict], folder: Path) -> None:
    """Every row as error_time.csv, numbers to six digits."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "error_time.csv").open("w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


if __name__ == "__main__":
    main()
