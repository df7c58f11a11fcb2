"""Times of swept profiles, fits and comparisons, with the plain way beside them; writes results/profiles.csv.

    python scripts/bench/profiles.py [--case CASE.yaml]

The peer is shapely alone: the union of all projected triangles at all the instants that a sweep to the same
tolerance inserts. It is run on a few instants spread over the motion and scaled by their number (favouring it: the
union of all instants' unions is left out), since the whole takes minutes. Least CPU time of several runs, so that
other work on the machine counts little; ratios count.
"""

from __future__ import annotations

import argparse
import csv
import resource
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from clock import timed

import clearance as cl
from clearance.profiles.chain import chain_of
from clearance.profiles.chords import knots_of
from clearance.profiles.compare import compare
from clearance.profiles.contour import Contour
from clearance.profiles.fit_shape import SketchShape
from clearance.profiles.outline_file import DrawnOutline
from clearance.profiles.plane import Plane
from clearance.profiles.profile import Profile
from clearance.profiles.sweep import SHARE, TOLERANCE
from clearance.world.motion import kinematic_motion

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
FREE = {0, 1, 3, 5}
"""Sides of the bench's sketch whose lengths are free."""

DEFAULT = ROOT.parent / "shared" / "cases" / "kuka_iiwa_valve_wall" / "case.yaml"


def least(action, times: int) -> tuple[float, object]:
    """Least CPU time of several runs [s], after one that warms up, and its result."""
    action()
    return min((timed(action) for _ in range(times)), key=lambda row: row[0])


def plain_union(case, plane: Plane, samples: int) -> tuple[float, int]:
    """CPU time [s] of shapely's union of all projected triangles at all inserted instants, and their number."""
    motion = kinematic_motion(case.robots[0])
    took, instants = 0.0, 0
    links = case.robots[0].robot.link_names
    for body in case.robots[0].robot.bodies:
        chain = chain_of(case, (motion,), links.index(body.name))
        knots = knots_of(chain, body.shape, plane, SHARE * TOLERANCE, solid=False)
        corners = body.shape.vertices[body.shape.triangles()]
        chosen = np.linspace(0, len(knots.instant) - 1, samples).astype(int)
        before = time.process_time()
        for pose in knots.poses[chosen]:
            seen = plane.coordinates(corners @ pose[:3, :3].T + pose[:3, 3])
            shapely.unary_union(shapely.polygons(seen))
        took += (time.process_time() - before) / samples * len(knots.instant)
        instants += len(knots.instant)
    return took, instants


def lengthened(case, factor: int):
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


def main() -> None:
    """Measures and writes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", type=Path, default=DEFAULT)
    path = parser.parse_args().case
    case = cl.load_case(path)
    polygons = sum(body.shape.n_faces for body in case.robots[0].robot.bodies)
    rows = []

    def tell(what: str, value: float, unit: str) -> None:
        rows.append((path.parent.name, what, f"{value:.6g}", unit))
        print(f"{what:<46} {value:12.6g} {unit}", flush=True)

    tell("polygons of the robot", polygons, "")
    tell("steps", case.robots[0].trajectory.n_steps, "")
    took, profile = least(lambda: cl.swept_profile(case), 2)
    tell("sweep, plan view, 0.5 mm", took, "s")
    tell("bound", 1000.0 * profile.bound, "mm")
    tell("lines and arcs", profile.n_pieces, "")
    plain, instants = plain_union(case, Plane.of("xy"), 2)
    tell("instants of all links", instants, "")
    tell("shapely alone (sampled, scaled)", plain, "s")
    tell("ratio", plain / took, "x")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    took, _ = least(lambda: cl.swept_profile(lengthened(case, 4)), 1)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    tell("sweep of 4 times the steps", took, "s")
    tell("more memory at the most for it", (after - before) / 1024.0, "MiB")
    outline, sketch = busy_outline(2000), stepped_sketch()
    shape = SketchShape(sketch, None)
    tell("dimensions of the sketch", len(shape.free) + len(shape.fixed), "")
    tell("of these free", len(shape.free), "")
    ring = outline.contours[0]  # larger, as a drawn room, for the largest plate inside
    room = Contour(3.0 * ring.vertices, ring.bulges).curve()
    for mode, other in (("nearest", outline), ("outside", outline), ("inside", room)):
        took, _ = least(lambda mode=mode, other=other: cl.fit(sketch, other, mode), 2)
        tell(f"fit, 4 free, 2000 pieces, {mode}", took, "s")
    other = replace(
        profile, contours=tuple(Contour(1.001 * c.vertices, c.bulges) for c in profile.contours)
    )
    pair = DrawnOutline("a", profile.curve, profile), DrawnOutline("b", other.curve, other)
    took, _ = least(
        lambda: compare(*(DrawnOutline(d.name, d.curve, d.profile) for d in pair), limit=1e-4), 5
    )
    tell("compare two sweeps", 1000.0 * took, "ms")
    with open(HERE / "results" / "profiles.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([("case", "what", "value", "unit"), *rows])


if __name__ == "__main__":
    main()
