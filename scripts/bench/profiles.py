"""Prints the times of swept profiles, fits and comparisons, with the plain way beside them.

    python scripts/bench/profiles.py [--case NAME] [--pieces N] [--modes MODE ...] [--csv FILE]

The peer is shapely alone: the union of all projected triangles at all the instants that a sweep to the same
tolerance inserts. It is run on two instants of each link and scaled by their number (favouring it: the union of
all instants' unions is left out), since the whole takes minutes. Least CPU time of several runs; ratios count.
"""

from __future__ import annotations

from dataclasses import replace

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
import shapely
from harness import Row, least_time, timed
from inputs import scenes

import clearance as cl
from clearance.profiles.chain import chain_of
from clearance.profiles.chords import knots_of
from clearance.profiles.compare import compare
from clearance.profiles.contour import Contour
from clearance.profiles.outline_file import DrawnOutline
from clearance.profiles.plane import Plane
from clearance.profiles.profile import Profile
from clearance.profiles.sweep import SHARE, TOLERANCE
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion

FREE = {0, 1, 3, 5}
"""Sides of the sketch whose lengths are free."""

MODES = ("nearest", "outside", "inside")

SMALLEST = ["--case", "box_box", "--modes"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__, words, case="kuka_iiwa_valve_wall", pieces=2000, modes=[*MODES]
    )
    case = next(scene.case for scene in scenes([asked.case]))
    rows = [*sweep_rows(case), *fit_rows(asked.pieces, asked.modes)]
    harness.show(asked.case, rows)
    harness.write_csv(rows, asked.csv)
    return rows


def sweep_rows(case: Case) -> list[Row]:
    """A sweep in plan view to 0.5 mm, the same of a longer motion, shapely alone, and two sweeps compared."""
    cl.swept_profile(case)  # compiled code is warm
    took, profile = least_time(lambda: cl.swept_profile(case), 2)
    plain, instants = plain_union(case, Plane.of("xy"), 2)
    longer, _ = timed(lambda: cl.swept_profile(lengthened(case, 4)))
    wider = [Contour(1.001 * one.vertices, one.bulges) for one in profile.contours]
    other = replace(profile, contours=tuple(wider))

    def compared() -> object:
        outlines = (
            DrawnOutline(name, one.curve, one)
            for name, one in zip("ab", (profile, other), strict=True)
        )
        return compare(*outlines, limit=1e-4)

    compared()
    return [
        row_of(
            "polygons of the robot", sum(b.shape.n_faces for b in case.robots[0].robot.bodies), ""
        ),
        row_of("steps", case.robots[0].trajectory.n_steps, ""),
        row_of("sweep", took, "s"),
        row_of("bound", 1000.0 * profile.bound, "mm"),
        row_of("lines and arcs", profile.n_pieces, ""),
        row_of("instants of all links", instants, ""),
        row_of("shapely alone (sampled, scaled)", plain, "s"),
        row_of("shapely over sweep", plain / took, "x"),
        row_of("sweep of 4 times the steps", longer, "s"),
        row_of("compare two sweeps", 1000.0 * least_time(compared, 5)[0], "ms"),
    ]


def fit_rows(n_pieces: int, modes: list[str]) -> list[Row]:
    """A sketch of 12 dimensions, 4 of them free, fitted to an outline of so many pieces."""
    outline, sketch = busy_outline(n_pieces), stepped_sketch()
    ring = outline.contours[0]  # larger, as a drawn room, for the largest plate inside
    room = Contour(3.0 * ring.vertices, ring.bulges).curve()
    rows = []
    for mode in modes:
        other = room if mode == "inside" else outline
        work = lambda mode=mode, other=other: cl.fit(sketch, other, mode)  # noqa: E731
        work()
        rows.append(row_of(f"fit, 4 free, {n_pieces} pieces, {mode}", least_time(work, 2)[0], "s"))
    return rows


def row_of(what: str, value: float, unit: str) -> Row:
    """One figure."""
    return {"what": what, "value": value, "unit": unit}


def plain_union(case: Case, plane: Plane, samples: int) -> tuple[float, int]:
    """CPU time [s] of shapely's union of all projected triangles at all inserted instants, and their number."""
    motion, robot = kinematic_motion(case.robots[0]), case.robots[0].robot
    took, instants = 0.0, 0
    for body in robot.bodies:
        chain = chain_of(case, (motion,), robot.link_names.index(body.name))
        knots = knots_of(chain, body.shape, plane, SHARE * TOLERANCE, solid=False)
        corners = body.shape.vertices[body.shape.triangles()]
        chosen = np.linspace(0, len(knots.instant) - 1, samples).astype(int)

        def union(poses=knots.poses[chosen], corners=corners) -> None:
            for pose in poses:
                seen = plane.coordinates(corners @ pose[:3, :3].T + pose[:3, 3])
                shapely.unary_union(shapely.polygons(seen))

        took += timed(union)[0] / samples * len(knots.instant)
        instants += len(knots.instant)
    return took, instants


def lengthened(case: Case, factor: int) -> Case:
    """The case with its path there and back, `factor` times as many steps."""
    placed = case.robots[0]
    asked = placed.trajectory
    positions = np.concatenate([asked.positions[:: 1 if k % 2 == 0 else -1] for k in range(factor)])
    again = replace(asked, times=np.arange(len(positions), dtype=float), positions=positions)
    return replace(case, robots=(replace(placed, trajectory=again),))


def busy_outline(n: int) -> Profile:
    """A wavy ring of `n` lines and arcs about the size of a robot's sweep."""
    turn = 2.0 * np.pi * np.arange(n) / n
    radius = 0.8 + 0.1 * np.sin(5.0 * turn) + 0.02 * np.sin(61.0 * turn)
    vertices = np.stack([1.3 * radius * np.cos(turn), 0.7 * radius * np.sin(turn)], axis=1)
    return Profile((Contour(vertices, np.where(np.arange(n) % 2, 0.02, 0.0)),), name="busy")


def stepped_sketch() -> cl.Sketch:
    """A closed outline of 12 dimensions, 4 of them free: a stepped plate of 14 sides, nothing else to say it."""
    s = cl.Sketch()
    xs = [0.0, 2.6, 2.6, 1.9, 1.9, 1.2, 1.2, 0.6, 0.6, 0.3, 0.3, 0.1, 0.1, 0.0]
    ys = [0.0, 0.0, 0.9, 0.9, 1.1, 1.1, 1.4, 1.4, 1.5, 1.5, 1.6, 1.6, 1.65, 1.65]
    p = [s.point(x, y, name=f"p{i}") for i, (x, y) in enumerate(zip(xs, ys, strict=True))]
    n = len(p)
    for i in range(n):
        side = s.segment(p[i], p[(i + 1) % n], name=f"s{i}")
        (s.horizontal if i % 2 == 0 else s.vertical)(side)
    for i in range(n - 2):
        length = float(np.hypot(*(p[i + 1].position - p[i].position)))
        s.distance(p[i], p[i + 1], length, name=f"d{i}", driven=i in FREE)
    return s


if __name__ == "__main__":
    main()
