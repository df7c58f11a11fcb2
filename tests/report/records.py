"""A small record made without any file: an arm of three boxes and a gripper that swings past a post
and dips into a table. Clearances are the true distances from the corners of the links to the boxes
of the scene, so witness points and clearances fit together, and no engine is needed. Budgets made by hand say what
tolerances would leave of it."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.record.budget import ErrorSource, RuleBudget
from clearance.record.names import LINK_AND_OBSTACLE, SIDES, columns_of, pair_names
from clearance.record.record import CrossCheck, Disagreement, PairMinimum, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import STATUSES
from clearance.record.table import Names, Table
from clearance.simulate.answers.rule_pairs import SampleMoments, measured_rule
from clearance.simulate.measure.measured import MeasuredSteps
from clearance.world.body import Body, Obstacle
from clearance.world.budget import Budget
from clearance.world.case import Case, Limits, Omission, Source
from clearance.world.motion import Motion
from clearance.world.pairs import measured_pairs
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.rules import DEFAULT
from clearance.world.timeline import timeline_of
from clearance.world.trajectory import Trajectory
from tests.made_cases import at

LIMITS = Limits(fail=0.01, warn=0.06)


def box(low, high, excess=0.0) -> Polyhedron:
    """An axis-parallel box of six outward quadrilaterals."""
    corners = [
        [(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]]
        for i in (0, 1)
        for j in (0, 1)
        for k in (0, 1)
    ]
    return Polyhedron(
        np.array(corners),
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
        excess,
    )


def arm(name="arm") -> Robot:
    """Base, two turning links and a sliding gripper."""
    turning, sliding = JointKind.REVOLUTE, JointKind.PRISMATIC
    joints = (
        Joint("pan", turning, "base", "upper", at(z=0.3), np.array([0.0, 0, 1]), -3.0, 3.0),
        Joint("lift", turning, "upper", "fore", at(x=0.4, z=0.2), np.array([0.0, 1, 0]), -2.0, 2.0),
        Joint("slide", sliding, "fore", "gripper", at(x=0.4), np.array([1.0, 0, 0]), 0.0, 0.2),
    )
    bodies = (
        Body("base", box((-0.1, -0.1, 0), (0.1, 0.1, 0.3)), "base.stl"),
        Body("upper", box((-0.05, -0.06, 0), (0.45, 0.06, 0.2)), "upper.stl"),
        Body("fore", box((-0.05, -0.04, -0.04), (0.4, 0.04, 0.04)), "fore.stl"),
        Body("gripper", box((0, -0.03, -0.03), (0.12, 0.03, 0.03)), "<b>gripper</b>.stl"),
    )
    return Robot(
        name,
        ("base", "upper", "fore", "gripper"),
        joints,
        bodies,
        ("upper: 2 zero-area triangles left out",),
    )


def scene() -> tuple[Obstacle, ...]:
    """A post, a table and a far wall, none of them turned."""
    return (
        Obstacle(
            Body("post", box((-0.03, -0.03, 0), (0.03, 0.03, 1.2), excess=1e-4), "cylinder"),
            at(0.75, 0.55),
        ),
        Obstacle(Body("table", box((-0.3, -0.3, 0), (0.3, 0.3, 0.16)), "box"), at(0.75, -0.35)),
        Obstacle(Body("wall </script>", box((-0.02, -1, 0), (0.02, 1, 1.4)), "box"), at(-0.7)),
    )


def motion(n_steps=240, robot: Robot | None = None, base: np.ndarray | None = None) -> Motion:
    """A swing from the post to the table over 6 s."""
    times = np.linspace(0.0, 6.0, n_steps)
    share = times / 6.0
    positions = np.column_stack(
        [
            0.75 - 1.35 * share,
            0.35 * np.sin(np.pi * np.clip(2 * share - 0.9, 0, 1)) ** 2 - 0.1,
            0.15 * share,
        ]
    )
    trajectory = Trajectory(times, ("pan", "lift", "slide"), positions)
    placed = PlacedRobot(
        robot or arm(), trajectory, np.eye(4) if base is None else base, exclude_links=("base",)
    )
    return Motion(placed, times, positions, np.zeros(n_steps))


def record(n_steps=240, limits=LIMITS, n_robots=1, **changes) -> Record:
    """The measured swing; `changes` replace fields of the record."""
    motions = tuple(motion(n_steps, arm(f"arm_{i}"), at(z=0.001 * i)) for i in range(n_robots))
    sources = (
        Source("/home/someone/cell/case.yaml", "ab" * 32, 1234),
        Source("/home/someone/robots/arm.urdf", "cd" * 32, 9876),
    )
    case = Case(
        "swing & <dip>",
        tuple(m.placed for m in motions),
        scene(),
        limits,
        sources=sources,
        notes=("joint slide: no limit given for velocity",),
    )
    steps = table(measure(motions, case)[0], limits)
    rules = rules_of(case, motions, steps)
    made = Record(
        case,
        motions,
        steps,
        (Omission("base", "*", "excluded: bolted"),),
        {"pairs": 9 * n_steps, "polygon_tests": 36 * n_steps},
        rules=rules,
        timeline=timeline_of(case, motions),
        pairs=measured_pairs(case)[0],
        worst_sample=rules[0].worst_sample,
        worst=rules[0].worst,
    )
    return dataclasses.replace(made, **changes)


def with_steps(made: Record, steps: Table) -> Record:
    """The record with other rows of steps, of as many of its steps, and what follows from them."""
    n_steps = steps.n_rows
    motions = tuple(
        dataclasses.replace(
            one,
            times=one.times[:n_steps],
            positions=one.positions[:n_steps],
            tracking_error=one.tracking_error[:n_steps],
        )
        for one in made.motions
    )
    rules, timeline = rules_of(made.case, motions, steps), timeline_of(made.case, motions)
    return dataclasses.replace(
        made,
        table=steps,
        motions=motions,
        rules=rules,
        timeline=timeline,
        worst_sample=rules[0].worst_sample,
        worst=rules[0].worst,
    )


def rules_of(case, motions, steps: Table) -> tuple[RuleAnswer, ...]:
    """The one rule of a case without rules, with what the rows of its steps say."""
    pairs = measured_pairs(case)[0]
    names = pair_names(case, pairs)
    places = {named: i for i, named in enumerate(zip(*names, strict=True))}
    who = zip(*(steps.names(side).tolist() for side in LINK_AND_OBSTACLE), strict=True)
    clearances = steps.numbers("clearance")
    points = np.stack([steps.numbers(name) for name in columns_of(LINK_AND_OBSTACLE)[2:]], 1)
    found = MeasuredSteps(
        clearances,
        clearances,
        np.array([places[pair] for pair in who]),
        points.reshape(-1, 2, 3),
        {},
        measure_pair_minima=None,
    )
    moment_at = partial(SampleMoments(names, motions).at, found, DEFAULT)
    return (measured_rule(DEFAULT, case.limits, found, None, moment_at).answer,)


def with_contacts(made: Record, work_out: str = "every") -> Record:
    """The record with the overlaps of its steps at 0, as a run finds them."""
    from clearance.simulate.answers.contact.contacts import overlap_finder
    from clearance.simulate.answers.contact.rows import ContactPart, joined_contacts

    pairs = measured_pairs(made.case)[0]
    named = list(zip(*pair_names(made.case, pairs), strict=True))
    links, obstacles = (made.rows.names(name).tolist() for name in ("link", "obstacle"))
    nearest = [named.index(pair) for pair in zip(links, obstacles, strict=True)]
    asked = made.case, made.motions, pairs, made.clearances, np.array(nearest)
    part = ContactPart.of(overlap_finder(*asked, work_out), 0, np.arange(len(pairs)))
    contacts = joined_contacts([part], named, made.motions[0].times)
    return dataclasses.replace(made, contacts=contacts.rows)


def measure(motions, case):
    """Per step and per pair the least distance from a link's corners to the boxes of the scene."""
    rows, minima = [], {}
    for one in motions:
        poses = one.poses()
        for k, body in enumerate(one.placed.robot.bodies):
            if body.name in one.placed.exclude_links:
                continue
            corners = (
                np.einsum("nij,kj->nki", poses[:, k, :3, :3], body.shape.vertices)
                + poses[:, k, None, :3, 3]
            )
            label = f"{one.placed.robot.name}/{body.name}" if len(motions) > 1 else body.name
            for obstacle in case.obstacles:
                low, high = obstacle.body.shape.bounds + obstacle.world_from_body[:3, 3]
                nearest = np.clip(corners, low, high)
                gaps = np.linalg.norm(corners - nearest, axis=2)
                best = gaps.argmin(axis=1)
                at = np.arange(len(gaps))
                found = list(
                    zip(
                        gaps[at, best].tolist(),
                        corners[at, best].tolist(),
                        nearest[at, best].tolist(),
                        strict=True,
                    )
                )
                rows.append([(gap, label, obstacle.name, *p, *q) for gap, p, q in found])
                step = int(gaps.min(axis=1).argmin())
                gap, p, q = found[step]
                minima[label, obstacle.name] = PairMinimum(
                    label, obstacle.name, gap, step, float(one.times[step]), tuple(p), tuple(q)
                )
    least = [min(choices, key=lambda row: row[0]) for choices in zip(*rows, strict=True)]
    return [
        (i, float(t), *row) for i, (t, row) in enumerate(zip(motions[0].times, least, strict=True))
    ], tuple(sorted(minima.values(), key=lambda minimum: minimum.clearance))


def table(rows, limits: Limits) -> Table:
    """The steps table with its status column."""
    names = ("step", "time", "clearance", *columns_of(LINK_AND_OBSTACLE))
    columns = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
    gaps = np.array(columns["clearance"])
    codes = np.select([gaps <= 0, gaps < limits.fail, gaps < limits.warn], [3, 2, 1], default=0)
    columns["status"] = [str(STATUSES[code]) for code in codes]
    general = zip(columns_of(LINK_AND_OBSTACLE), columns_of(SIDES), strict=True)
    columns |= {name: columns[own] for own, name in general}
    return rows_of(columns | {"rule": [DEFAULT] * len(gaps)})


def disagreeing() -> CrossCheck:
    """A cross-check with one step that differs."""
    wrong = Disagreement(17, 0.125, 0.1249, "fore", "post", "gripper", "post", "clearance differs")
    return CrossCheck("python-fcl", 240, 1e-4, 17, 1e-9, 2e-13, (wrong,))


def rows_of(columns: dict[str, list]) -> Table:
    """The table with these columns, of numbers or of names."""
    return Table({name: _column(values) for name, values in columns.items()})


def _column(values: list) -> np.ndarray | Names:
    if not isinstance(values[0], str):
        return np.array(values)
    names = list(dict.fromkeys(values))
    return Names(np.array([names.index(value) for value in values]), names)


SOURCES = (
    ErrorSource("arm_0", "position", "lift", ((0.001, "rad"),), 0.0012, 0.0004, (0.0021,)),
    ErrorSource("arm_0", "base", "", ((0.002, "m"), (0.001, "rad")), 0.0008, 0.0003, (0.0035, None)),
    ErrorSource("post", "surface", "", ((0.0005, "m"),), 0.0005, 0.0001, (0.00123456,)),
)  # fmt: skip
"""What takes most first: 2.5 mm together."""


def with_budget(
    made: Record, taken: float = 0.0025, *, between: bool = False, ok: bool = False, **changes
) -> Record:
    """The record with tolerances that take so much [m] of each step's clearance, and a third of it as expected.

    Args:
        between: the motion is certified. ok: a limit that is not proven may pass.
        changes: replace fields of the `RuleBudget`s.
    """
    budget = Budget(unproven_ok=ok, sources=("preset typical: read somewhere",))
    case = dataclasses.replace(made.case, tolerance=budget)
    budgets = tuple(_of_rule(made, rule, taken, between, changes) for rule in made.rules)
    left = {name: getattr(budgets[0], name) for name in ("proven", "expected")}
    steps = made.rows.with_columns(
        {name: np.where(np.isfinite(values), values, np.nan) for name, values in left.items()}
    )
    return dataclasses.replace(made, case=case, budget=budgets, table=steps)


def _of_rule(made, rule, taken, between, changes) -> RuleBudget:
    nominal = rule.measurement.clearance
    proven = nominal - taken
    budget = RuleBudget(
        rule.name,
        rule.limits,
        proven,
        nominal - taken / 3,
        proven - 0.0001 if between else None,
    )
    return dataclasses.replace(budget, **changes)
