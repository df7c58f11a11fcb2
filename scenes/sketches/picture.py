"""A sketch as an SVG picture: what is drawn in black, construction lines grey, distances of points blue."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clearance.sketch.entities import Arc, Circle, Line, Point, Segment


def svg_of(sketch, *, width: int = 800, title: str = "") -> str:
    """The text of an SVG picture, y upwards."""
    points = np.array(
        [e.position for e in sketch.entities.values() if isinstance(e, Point)] or [np.zeros(2)]
    )
    low, high = points.min(axis=0), points.max(axis=0)
    for e in sketch.entities.values():
        if type(e) is Circle:
            low, high = (
                np.minimum(low, e.center.position - e.radius),
                np.maximum(high, e.center.position + e.radius),
            )
    margin = 0.06 * max(float(np.max(high - low)), 1e-9)
    low, high = low - margin, high + margin
    scale = width / (high[0] - low[0])
    height = scale * (high[1] - low[1])
    body = "".join(_span(c, low, high, scale) for c in sketch.constraints.values())
    body += "".join(_drawn(e, low, high, scale) for e in sketch.entities.values())
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height:.0f}">'
    text = f'<text x="8" y="18" font-family="sans-serif" font-size="14">{title}</text>'
    return f'{head}<rect width="100%" height="100%" fill="white"/>{body}{text}</svg>\n'


def write_svg(sketch, path: Path, *, title: str = "") -> None:
    """Writes the picture of a sketch."""
    Path(path).write_text(svg_of(sketch, title=title), encoding="utf-8")


def _span(c, low, high, scale: float) -> str:
    """A distance of two points as a thin line; nothing for other constraints."""
    if c.kind != "distance" or not all(isinstance(e, Point) for e in c.entities):
        return ""
    ends = [(e.position - low) * scale for e in c.entities]
    height = (high[1] - low[1]) * scale
    d = " L".join(f"{x:.2f} {height - y:.2f}" for x, y in ends)
    return _path(f"M{d}", "#59d", 0.9)


def _drawn(e, low, high, scale: float) -> str:
    def at(p) -> str:
        return f"{(p[0] - low[0]) * scale:.2f} {(high[1] - p[1]) * scale:.2f}"

    if isinstance(e, Point):
        x, y = at(e.position).split()
        return f'<circle cx="{x}" cy="{y}" r="2" fill="#c33"/>'
    if isinstance(e, Segment):
        return _path(f"M{at(e.ends[0].position)} L{at(e.ends[1].position)}", "black", 1.6)
    if isinstance(e, Line):
        reach = 2.0 * float(np.max(high - low)) * e.direction
        middle = e.foot
        middle = middle + e.direction * float(e.direction @ (0.5 * (low + high) - middle))
        return _path(f"M{at(middle - reach)} L{at(middle + reach)}", "#bbb", 0.8)
    if isinstance(e, Arc):
        from clearance.sketch.outline import angles_of

        start, end = angles_of(e)
        r = e.radius * scale
        large = int(end - start > np.pi)
        return _path(
            f"M{at(e.start.position)} A{r:.2f} {r:.2f} 0 {large} 0 {at(e.end.position)}",
            "black",
            1.6,
        )
    x, y = at(e.center.position).split()
    style = 'fill="none" stroke="black" stroke-width="1.6"'
    return f'<circle cx="{x}" cy="{y}" r="{e.radius * scale:.2f}" {style}/>'


def _path(d: str, color: str, width: float) -> str:
    return f'<path d="{d}" fill="none" stroke="{color}" stroke-width="{width}"/>'
