"""Sketches whose truth is known: points are placed first, dimensions measured, then the drawing is shaken."""

import numpy as np

from clearance.sketch import Sketch


def truth(n, seed, missing=0, off=0.03):
    """A sketch of n points: a triangulated strip, with some edges missing; (sketch, its points, truth, edges)."""
    random = np.random.default_rng(seed)
    points = np.array([(0.5 * k, 0.9 * (k % 2)) for k in range(n)]) + random.uniform(
        -0.1, 0.1, (n, 2)
    )
    edges = [(0, 1)] + [(k - j, k) for k in range(2, n) for j in (1, 2)]
    chosen = list(random.permutation(len(edges)))
    edges = [edges[k] for k in sorted(chosen[missing:])]
    drawn = points + random.uniform(-off, off, points.shape)
    return *distances(points, drawn, edges), points, edges


def again(s, without=(), driven=(), changes=None):
    """The sketch once more: some constraints left out, some only measured, some with other values."""
    t = Sketch()
    for name, e in s.entities.items():
        if e.what == "point":
            t.point(*e.position, name=name)
    for name, e in s.entities.items():
        if e.what in ("line", "segment"):
            foot = e.offset * np.array([-e.direction[1], e.direction[0]])
            t.line(foot, foot + e.direction, name=name)
            t.entity(name).ends = tuple(t.entity(p.name) for p in e.ends) if e.ends else None
        elif e.what in ("circle", "arc"):
            t.circle(t.entity(e.center.name), e.radius, name=name)
    for name, c in s.constraints.items():
        if name not in without and not c.driven:
            value = (changes or {}).get(name, c.number) if c.given is not None else None
            own = c.options | {"driven": True} if name in driven else c.options
            t.add(c.kind, *(e.name for e in c.entities), value=value, name=name, **own)
    return t


def distances(points, drawn, edges):
    """A sketch of the distances measured on `points`, drawn at `drawn`; (sketch, its points)."""
    s = Sketch()
    p = [s.point(*q) for q in drawn]
    for a, b in edges:
        s.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])))
    return s, p
