"""SolveSpace's library on the same sketches. The adapter of `python_solvespace`."""

from __future__ import annotations

import numpy as np

from scripts.bench.sketches.table import clocked

ARC_LINE_TANGENT, CURVE_CURVE_TANGENT = 100027, 100032
"""SolveSpace's numbers of these constraints, which its library for Python does not name."""


def slvs_solve(points: np.ndarray, drawn: np.ndarray, edges):
    """([ms], whether solved, points) of SolveSpace's library on the same distances."""
    from python_solvespace import ResultFlag, SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    for a, b in edges:
        system.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])), plane)
    taken, flag = clocked(system.solve)
    x = np.array([system.params(q.params) for q in p])
    return taken, flag == ResultFlag.OKAY, x


def slvs_drawing(d, drawn: np.ndarray) -> tuple[float, bool]:
    """([ms], whether solved to 1e-6 of size) of SolveSpace's library on a random drawing."""
    from python_solvespace import ResultFlag, SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    normal = system.add_normal_3d(1.0, 0.0, 0.0, 0.0)
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    e = [system.add_line_2d(p[a], p[b], plane) for a, b in d.segments]
    arcs = [system.add_arc(normal, p[c], p[i], p[j], plane) for c, i, j in d.arcs]
    sizes = [system.add_distance(r, plane) for _, r in d.circles]
    rounds = [
        system.add_circle(normal, p[k], r, plane)
        for (k, _), r in zip(d.circles, sizes, strict=True)
    ]
    of = {"p": p, "s": e, "a": arcs, "c": rounds}
    for kind, entities, value in d.constraints:
        what = [w for w, _ in entities]
        found = [of[w][k] for w, k in entities]
        if kind == "distance":
            system.distance(*found, value, plane)
        elif kind == "radius":
            system.diameter(found[0], 2.0 * value)
        elif kind == "symmetric":
            system.symmetric(*found, plane)
        elif what == ["s", "c"]:  # the library has no such contact: its distance from the centre
            center = d.circles[entities[1][1]][0]
            radius = next(v for k, on, v in d.constraints if k == "radius" and on == (entities[1],))
            system.distance(p[center], found[0], radius, plane)
        else:
            _slvs_tangent(system, d, what, [k for _, k in entities], found, plane)
    taken, flag = clocked(system.solve)
    x = np.array([system.params(q.params) for q in p])
    radii = [system.params(r.params)[0] for r in sizes]
    error = np.abs(d.equations(np.concatenate([x.ravel(), radii]))).max()
    size = float(np.ptp(x, axis=0).max())
    return taken, flag == ResultFlag.OKAY and error <= 1e-6 * size + 1e-9 * np.abs(x).max()


def _slvs_tangent(system, d, what: list[str], index: list[int], found: list, plane) -> None:
    """A contact of SolveSpace's library at the end that two parts share: it wants to know which end."""
    from python_solvespace import Entity

    if what == ["s", "a"]:
        what, index, found = what[::-1], index[::-1], found[::-1]
    _, start, end = d.arcs[index[0]]
    ends = d.segments[index[1]] if what[1] == "s" else d.arcs[index[1]][1:]
    kind, at_end = ARC_LINE_TANGENT, False
    if what[1] == "a":
        kind = CURVE_CURVE_TANGENT
        at_end = ends[1] in (start, end)
    none = Entity.NONE
    system.add_constraint(
        kind, plane, 0.0, none, none, *found, none, none, int(end in ends), int(at_end)
    )
