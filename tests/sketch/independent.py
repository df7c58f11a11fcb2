"""The constraints once more, as formulas of positions, directions and radii only; shares no code with the
package. A sketch is written out as named numbers; `remaining_freedom` counts by finite differences."""

import numpy as np


def _unit(theta):
    return np.array([np.cos(theta), np.sin(theta)])


def _gap(p, line):
    theta, d = line
    return float(np.array([-np.sin(theta), np.cos(theta)]) @ p - d)


def _wrapped(angle, period):
    return (angle + 0.5 * period) % period - 0.5 * period


def violation(kind, what, e, value, inside=False):
    """Residuals of one constraint between entities e, given as numbers; `what` are their kinds."""
    if kind in ("radius", "diameter"):
        return [e[0][2] - value * (1.0 if kind == "radius" else 0.5)]
    if kind == "equal_radius":
        return [e[0][2] - e[1][2]]
    if kind == "horizontal":
        return [np.sin(e[0][0])] if what == ("line",) else [e[0][1] - e[1][1]]
    if kind == "vertical":
        return [np.cos(e[0][0])] if what == ("line",) else [e[0][0] - e[1][0]]
    if kind == "parallel":
        return [np.sin(e[0][0] - e[1][0])]
    if kind == "perpendicular":
        return [np.cos(e[0][0] - e[1][0])]
    if kind == "angle":
        return [abs(_wrapped(e[0][0] - e[1][0], 2.0 * np.pi)) - value]
    if kind == "incident":
        if what[1] == "line":
            return [_gap(e[0], e[1])]
        return [np.linalg.norm(e[0] - e[1][:2]) - e[1][2]]
    if kind == "tangent":
        if what[0] == "line":
            return [abs(_gap(e[1][:2], e[0])) - e[1][2]]
        apart = np.linalg.norm(e[0][:2] - e[1][:2])
        return [apart - (abs(e[0][2] - e[1][2]) if inside else e[0][2] + e[1][2])]
    if kind == "midpoint":
        return list(e[0] - 0.5 * (e[1] + e[2]))
    if kind == "symmetric":
        middle, across = 0.5 * (e[0] + e[1]), e[1] - e[0]
        return [_gap(middle, e[2]), float(_unit(e[2][0]) @ across)]
    if kind == "distance" and what == ("point", "point"):
        return [np.linalg.norm(e[0] - e[1]) - value]
    if kind == "distance" and what == ("point", "line"):
        return [abs(_gap(*e)) - value]
    if kind == "distance" and what == ("point", "circle"):
        return [abs(np.linalg.norm(e[0] - e[1][:2]) - e[1][2]) - value]
    raise KeyError((kind, what))


class Numbers:
    """The numbers of a sketch's entities, by name: points (2,), lines (theta, d), circles (x, y, r)."""

    def __init__(self, sketch):
        self.free, self.place = [], {}
        for name, e in sketch.entities.items():
            if e.what == "point":
                self._add(name, e.position)
        for name, e in sketch.entities.items():
            if e.what in ("line", "segment"):
                self._add(name, [np.arctan2(*e.direction[::-1]), e.offset])
            elif e.what in ("circle", "arc"):
                self._add(name, [e.radius])
        self.sketch = sketch

    def _add(self, name, numbers):
        self.place[name] = slice(len(self.free), len(self.free) + len(numbers))
        self.free += [float(v) for v in numbers]

    def of(self, entity, x):
        if entity.what in ("circle", "arc"):
            return np.concatenate([x[self.place[entity.center.name]], x[self.place[entity.name]]])
        return np.asarray(x[self.place[entity.name]])

    def violations(self, x):
        """All residuals at x, fixes apart."""
        out = []
        for c in self.sketch.constraints.values():
            if c.driven or c.kind in ("fix", "same_side"):
                continue
            e = [self.of(entity, x) for entity in c.entities]
            what = tuple("line" if v.what == "segment" else v.what for v in c.entities)
            out += violation(c.kind, what, e, c.number, c.options.get("inside", False))
        return np.array(out, float)

    def remaining_freedom(self):
        """Degrees of freedom at the present place beyond a rigid motion of the whole, by rank."""
        x = np.array(self.free)
        h, columns = 1e-6, []
        for i in range(x.size):
            up, down = x.copy(), x.copy()
            up[i] += h
            down[i] -= h
            columns.append((self.violations(up) - self.violations(down)) / (2.0 * h))
        matrix = np.array(columns).T.reshape(-1, x.size)
        values = np.linalg.svd(matrix, compute_uv=False) if matrix.size else np.zeros(0)
        rank = int(np.sum(values > 1e-5))
        oriented = any(
            c.kind in ("horizontal", "vertical") for c in self.sketch.constraints.values()
        )
        return x.size - rank - (2 if oriented else 3), matrix.shape[0] - rank
