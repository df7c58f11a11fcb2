"""Records made by hand: one body on a rail past fixed bodies, with answers known on paper."""

from __future__ import annotations

import numpy as np

from clearance.crosscheck.compare import compared
from clearance.geometry import shapes
from clearance.geometry.polyhedron import Polyhedron
from clearance.record.record import CrossCheck, Samples
from clearance.record.table import Table
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, Omission
from clearance.world.motion import Motion
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.robot import JointKind
from tests.made_cases import at, driven
from tests.report.records import rows_of


def pairs_of(record: Samples) -> list[Pair]:
    """The pairs of a record."""
    case, omitted = record.case, {(one.link, one.obstacle) for one in record.unmeasured}
    pairs = measured_pairs(case)[0]
    return [pair for pair in pairs if (pair.a.name_in(case), pair.b.name_in(case)) not in omitted]


def cross_check(record: Samples, progress=None) -> CrossCheck:
    """The comparison of a record with FCL."""
    return compared(record, pairs_of(record), progress)[0]


def box(*size: float) -> Polyhedron:
    """A box about the origin: six outward quadrilaterals."""
    return shapes.box(size)


def rail_record(
    link: Polyhedron,
    obstacles: dict[str, tuple[Polyhedron, tuple[float, float, float]]],
    positions: list[float],
    rows: list[tuple[float, str, tuple[float, float, float], tuple[float, float, float]]],
    unmeasured: tuple[Omission, ...] = (),
) -> Samples:
    """A record of `link` sliding along x; a row is (clearance, obstacle, link point, obstacle
    point).
    """
    times = np.arange(len(positions), dtype=float)
    rail = driven(link, JointKind.PRISMATIC, positions, axis=(1, 0, 0), name="cart", link="slider")
    standing = tuple(
        Obstacle(Body(name, shape), at(*place)) for name, (shape, place) in obstacles.items()
    )
    motion = Motion(rail, times, rail.trajectory.positions, np.zeros(len(times)))
    case = Case("rail", (rail,), standing)
    return Samples(case, (motion,), _steps(times, rows), unmeasured)


def _steps(times: np.ndarray, rows: list) -> Table:
    columns = {
        "step": np.arange(len(times)),
        "time": times,
        "clearance": [row[0] for row in rows],
        "link": ["slider"] * len(rows),
        "obstacle": [row[1] for row in rows],
    }
    for side, i_row in (("link", 2), ("obstacle", 3)):
        for i_axis, axis in enumerate("xyz"):
            columns[f"{side}_{axis}"] = [float(row[i_row][i_axis]) for row in rows]
    return rows_of(columns)
