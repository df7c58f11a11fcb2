"""Random drawings as in CAD: outlines with rounded corners, chains of lines and arcs that touch, mirrored halves.

A drawing is plain data (`Drawing`): true places, entities by index, constraints with dimensions measured on
the truth; so that any solver can be given it. Every dimension is consistent; some are left out at random.
"""

from dataclasses import dataclass, field

import numpy as np

from clearance.sketch import Sketch


@dataclass
class Drawing:
    """Points (n, 2); segments (a, b), arcs (centre, start, end), circles (centre, radius) by point; constraints
    (kind, entities as ("p"|"s"|"a"|"c", index), value)."""

    points: list = field(default_factory=list)
    segments: list = field(default_factory=list)
    arcs: list = field(default_factory=list)
    circles: list = field(default_factory=list)
    constraints: list = field(default_factory=list)

    def point(self, p):
        self.points.append(np.asarray(p, float))
        return len(self.points) - 1

    def segment(self, a, b):
        self.segments.append((a, b))
        return len(self.segments) - 1

    def arc(self, center, start, end):
        self.arcs.append((center, start, end))
        return len(self.arcs) - 1

    def circle(self, center, radius):
        self.circles.append((center, radius))
        return len(self.circles) - 1

    def add(self, kind, *entities, value=None):
        self.constraints.append((kind, entities, value))

    def span(self, a, b):
        return float(np.linalg.norm(self.points[a] - self.points[b]))

    def shaken(self, off, seed):
        """The points (n, 2), moved by up to `off` of the extent."""
        random = np.random.default_rng(seed)
        points = np.array(self.points)
        reach = off * float(np.ptp(points, axis=0).max())
        return points + random.uniform(-reach, reach, points.shape)

    def sketch(self, points, shift=(0.0, 0.0)):
        """The drawing as a sketch, its points drawn at `points` + `shift`; (sketch, points, segments, arcs)."""
        s = Sketch()
        p = [s.point(*(q + np.asarray(shift))) for q in points]
        e = [s.segment(p[a], p[b]) for a, b in self.segments]
        a = [s.arc(p[c], p[i], p[j]) for c, i, j in self.arcs]
        c = [s.circle(p[k], r) for k, r in self.circles]
        of = {"p": p, "s": e, "a": a, "c": c}
        for kind, entities, value in self.constraints:
            s.add(kind, *(of[what][k] for what, k in entities), value=value)
        return s, p, e, a

    def equations(self, x):
        """The residuals of all constraints at points and circles' radii (flat), contacts as they are regular."""
        n = len(self.points)
        p, radii = x[: 2 * n].reshape(-1, 2), x[2 * n :]
        out = [_span(p, i, c) - _span(p, j, c) for c, i, j in self.arcs]
        for kind, entities, value in self.constraints:
            what, index = zip(*entities, strict=True)
            if kind == "distance":
                out.append(_span(p, *index) - value)
            elif kind == "radius":
                arc = what == ("a",)
                is_now = _span(p, *self.arcs[index[0]][:2]) if arc else radii[index[0]]
                out.append(is_now - value)
            elif kind == "symmetric":
                along, q = _along(p, self.segments[index[2]]), p[index[1]] - p[index[0]]
                foot = p[self.segments[index[2]][0]]
                out += [along @ q, _cross(along, 0.5 * (p[index[0]] + p[index[1]]) - foot)]
            else:
                out.append(self._touching(p, radii, what, index))
        return np.array(out)

    def _touching(self, p, radii, what, index):
        if what == ("a", "a"):
            (c, *e), (f, *g) = (self.arcs[k] for k in index)
            return _cross(_along(p, (c, f)), p[next(iter(set(e) & set(g)))] - p[c])
        segment, k = self.segments[index[0]], index[1]
        along = _along(p, segment)
        if what == ("s", "c") or what[0] == "a":
            if what[0] == "a":
                return self._touching(p, radii, what[::-1], index[::-1])
            return abs(_cross(along, p[self.circles[k][0]] - p[segment[0]])) - radii[k]
        c, *ends = self.arcs[k]
        return along @ (p[c] - p[next(iter(set(ends) & set(segment)))])

    def remaining_freedom(self, points, radii):
        """Degrees of freedom at solved points (n, 2) beyond placing the whole, by rank of differences."""
        x, h = np.concatenate([points.ravel(), radii]), 1e-6
        columns = [
            (self.equations(x + h * u) - self.equations(x - h * u)) / (2 * h)
            for u in np.eye(x.size)
        ]
        values = np.linalg.svd(np.array(columns).T, compute_uv=False)
        return x.size - int(np.sum(values > 1e-6)) - 3


def _span(p, i, j):
    return float(np.linalg.norm(p[i] - p[j]))


def _along(p, ends):
    return (p[ends[1]] - p[ends[0]]) / _span(p, *ends)


def _cross(u, v):
    return float(u[0] * v[1] - u[1] * v[0])


def _turned(v, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])


def rounded_outline(random):
    """A convex outline of 3 to 6 sides whose corners are arcs that touch both sides."""
    d, n = Drawing(), int(random.integers(3, 7))
    angles = 2.0 * np.pi * (np.arange(n) + random.uniform(-0.2, 0.2, n)) / n
    corners = random.uniform(3.0, 5.0) * np.column_stack([np.cos(angles), np.sin(angles)])
    corners *= np.array([random.uniform(0.8, 1.6), 1.0])
    arcs, ends = [], []
    for k in range(n):
        before, after = corners[k - 1] - corners[k], corners[(k + 1) % n] - corners[k]
        u, v = before / np.linalg.norm(before), after / np.linalg.norm(after)
        half = 0.5 * np.arccos(np.clip(u @ v, -1, 1))
        r = random.uniform(0.2, 0.6)
        center = corners[k] + (u + v) / np.linalg.norm(u + v) * r / np.sin(half)
        start, end = (corners[k] + r / np.tan(half) * w for w in (u, v))
        c, a, b = d.point(center), d.point(start), d.point(end)
        arcs.append(d.arc(c, a, b))
        ends.append((c, a, b, r))
    sides = [d.segment(ends[k - 1][2], ends[k][1]) for k in range(n)]
    for k in range(n):
        d.add("tangent", ("s", sides[k]), ("a", arcs[k]))
        d.add("tangent", ("s", sides[(k + 1) % n]), ("a", arcs[k]))
        if random.uniform() < 0.85:
            d.add("radius", ("a", arcs[k]), value=ends[k][3])
    chords = [(k, (k + 1) % n) for k in range(n)] + [(0, k) for k in range(2, n - 1)]
    for i, j in chords:
        if random.uniform() < 0.9:
            a, b = ends[i][0], ends[j][0]
            d.add("distance", ("p", a), ("p", b), value=d.span(a, b))
    if random.uniform() < 0.4:
        hole = d.circle(d.point(corners.mean(axis=0)), 0.3)
        d.add("radius", ("c", hole), value=0.25)
        for k in (0, 1):
            center = d.circles[hole][0]
            d.add("distance", ("p", center), ("p", ends[k][0]), value=d.span(center, ends[k][0]))
    return d


def touching_chain(random):
    """Lines and arcs end to end, each touching the one before; radii and spans given, some left out."""
    d, heading = Drawing(), random.uniform(0, 2 * np.pi)
    at = d.point(random.uniform(-1, 1, 2))
    last = None
    for k in range(int(random.integers(3, 7))):
        along = np.array([np.cos(heading), np.sin(heading)])
        if k % 2 == 0:
            if k and random.uniform() < 0.3 and last[0] == "a":
                last, at, heading = _next_arc(d, random, at, heading, last)
                continue
            end = d.point(d.points[at] + random.uniform(1.5, 3.0) * along)
            here = ("s", d.segment(at, end))
            if random.uniform() < 0.85:
                d.add("distance", ("p", at), ("p", end), value=d.span(at, end))
            if last is not None:
                d.add("tangent", here, last)
            last, at = here, end
        else:
            last, at, heading = _next_arc(d, random, at, heading, last)
    return d


def _next_arc(d, random, at, heading, last):
    side, r, sweep = random.choice([-1, 1]), random.uniform(0.6, 1.5), random.uniform(0.5, 2.0)
    along = np.array([np.cos(heading), np.sin(heading)])
    center = d.point(d.points[at] + side * r * _turned(along, 0.5 * np.pi))
    spoke = d.points[at] - d.points[center]
    end = d.point(d.points[center] + _turned(spoke, side * sweep))
    arc = d.arc(center, at, end) if side > 0 else d.arc(center, end, at)
    d.add("radius", ("a", arc), value=r)
    if random.uniform() < 0.85:
        d.add("distance", ("p", at), ("p", end), value=d.span(at, end))
    if last is not None:
        d.add("tangent", last, ("a", arc))
    return ("a", arc), end, heading + side * sweep


def mirrored_half(random):
    """A rounded profile and its mirror image in an axis; spans of one side given."""
    d, n = Drawing(), int(random.integers(2, 5))
    turn = random.uniform(0, np.pi)
    foot, top = (d.point(_turned(q, turn)) for q in ((0.0, 0.0), (0.0, 6.0)))
    axis = d.segment(foot, top)
    d.add("distance", ("p", foot), ("p", top), value=6.0)
    half = []
    for k in range(n):
        q = np.array([random.uniform(1.0, 3.0), 1.0 + 1.5 * k + random.uniform(-0.3, 0.3)])
        p, m = d.point(_turned(q, turn)), d.point(_turned(q * [-1, 1], turn))
        d.add("symmetric", ("p", p), ("p", m), ("s", axis))
        half.append(p)
        for other in (foot, top):
            if random.uniform() < 0.9:
                d.add("distance", ("p", p), ("p", other), value=d.span(p, other))
    for a, b in zip(half, half[1:], strict=False):
        one, _ = d.segment(a, b), d.segment(a + 1, b + 1)
        r = random.uniform(0.2, 0.5)
        along = d.points[b] - d.points[a]
        along /= np.linalg.norm(along)
        share = random.uniform(0.3, 0.7)
        touch = d.points[a] + share * (d.points[b] - d.points[a])
        center = d.point(touch + r * _turned(along, 0.5 * np.pi))
        hole = d.circle(center, r)
        d.add("tangent", ("s", one), ("c", hole))
        d.add("radius", ("c", hole), value=r)
        d.add("distance", ("p", center), ("p", a), value=d.span(center, a))
    return d


MAKERS = (rounded_outline, touching_chain, mirrored_half)


def drawing(seed):
    """One of three kinds of drawings, by its seed."""
    return MAKERS[seed % 3](np.random.default_rng(seed))


def tangencies(d, points):
    """[m] how far the ends that a line shares with an arc lie from where it touches, at solved points (n, 2)."""
    out = []
    for kind, entities, _ in d.constraints:
        what = dict(entities)
        if kind == "tangent" and set(what) == {"s", "a"}:
            a, b = d.segments[what["s"]]
            center, *ends = d.arcs[what["a"]]
            along = (points[b] - points[a]) / np.linalg.norm(points[b] - points[a])
            out += [abs(along @ (points[center] - points[k])) for k in ends if k in (a, b)]
        elif kind == "tangent" and set(what) == {"a"}:
            (c, *e), (f, *g) = (d.arcs[k] for _, k in entities)
            line = (points[f] - points[c]) / np.linalg.norm(points[f] - points[c])
            for k in set(e) & set(g):
                off = points[k] - points[c]
                out.append(abs(line[0] * off[1] - line[1] * off[0]))
    return out
