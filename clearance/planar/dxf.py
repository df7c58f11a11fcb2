"""The adapter of ezdxf: a DXF drawing's entities as one curve.

LINE, ARC, CIRCLE, LWPOLYLINE and 2-d POLYLINE with bulges, and SPLINE of the model space, in metres where the
header names a unit ($INSUNITS), else as the numbers stand. All lie in one plane z = const. Entities that meet end
to end become one contour. Not for: blocks, writing.
"""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput, BadSyntax, ClearanceError, MissingFile, at
from clearance.extras import importing
from clearance.planar.curve import Curve
from clearance.planar.entries import BadCurve
from clearance.tolerance import MEETING, PARAMETER

KINDS = "LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE, SPLINE"


_METRES = {
    0: 1.0, 1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 2.54e-8, 9: 2.54e-5,
    10: 0.9144, 11: 1e-10, 12: 1e-9, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0,
    21: 1200 / 3937, 22: 100 / 3937, 23: 3600 / 3937, 24: 5280 * 1200 / 3937,
}  # fmt: skip
"""[m] the units of $INSUNITS in the DXF reference; 0 names none."""

OWN_TAG, SWEPT = "clearance", "SWEPT"
"""The custom property of drawings of ours: first what the outline promises, then its notes; and the layer of the
whole outline, beside which links may have layers of their own."""

_MOST_DEGREES = 36_000.0
"""An angle of an arc beyond a hundred turns has few digits, and is damage."""

_FRAME = 16
"""The flag of vertices that control the spline of a POLYLINE, whose curve has vertices of its own."""


class Drawing(NamedTuple):
    """A curve; whether the drawing names a unit, so that it is in metres; and notes on what the curve holds."""

    curve: Curve
    in_metres: bool
    notes: tuple[str, ...] = ()


def read_dxf(path: str | PathLike[str]) -> Curve:
    """The curve of `read_drawing`."""
    return read_drawing(path).curve


def read_drawing(path: str | PathLike[str]) -> Drawing:
    """The curve of all entities in the model space of the DXF file at `path`; other kinds are refused.

    Raises: MissingFile, BadSyntax (not DXF, an unknown unit, or none of its entities is a curve), BadCurve (an
        entity of another kind, one that is hidden, a polyline with a width, or one that lies outside the plane
        z = const), Unavailable (no ezdxf).
    """
    with importing("dxf", "a DXF drawing"):
        import ezdxf

    file = Path(path)
    if not file.is_file():
        raise MissingFile("no such file", where=str(path), valid="a DXF file")
    with at(str(path)):
        try:
            return _in_metres(ezdxf.readfile(str(file)))
        except ClearanceError:
            raise
        except (
            Exception
        ) as error:  # ezdxf raises whatever its parsing hits, also when an entity is read
            raise BadSyntax(f"not a DXF drawing ({error!s:.120})", valid="a DXF file") from None


def _in_metres(drawing) -> Drawing:
    unit = drawing.header.get("$INSUNITS", 0)
    if unit not in _METRES:
        raise BadSyntax(f"$INSUNITS is {unit!r:.40}", valid="0 to 16, 21 to 24")
    own = [text for tag, text in drawing.header.custom_vars if tag == OWN_TAG]
    own = own if drawing.layers.has_entry(SWEPT) else []  # another program may use the word
    entities, note = _of_layers(list(drawing.modelspace()), bool(own))
    for entity in entities:
        _require_visible(entity, drawing.layers)
    parts = [_curve_of(entity) for entity in entities]
    if not parts:
        raise BadSyntax("a model space without entities", valid=f"at least one of {KINDS}")
    curve = Curve.contours(_chained(parts))
    _require_one_height(entities, MEETING * curve.size)
    metres = _METRES[unit]
    if metres != 1.0:
        curve = curve.transformed(np.diag([metres, metres, 1.0]))
    return Drawing(curve, unit != 0, (*own[1:], *note))


def _of_layers(entities: list, is_own: bool) -> tuple[list, list[str]]:
    """The entities that are taken: in a drawing of ours those on the layer of the sweep; and a note on several."""
    layers = list(dict.fromkeys(entity.dxf.layer for entity in entities))
    if len(layers) < 2:
        return entities, []
    names = ", ".join(map(repr, layers[:6])) + (", …" if len(layers) > 6 else "")
    if is_own and SWEPT in layers:
        taken = [entity for entity in entities if entity.dxf.layer == SWEPT]
        return taken, [f"of the layers {names} only {SWEPT!r} is taken"]
    return entities, [f"the layers {names} are taken as one outline"]


def _require_visible(entity, layers) -> None:
    """Nothing, if an entity is seen in the drawing: whether one that is not belongs to the outline is open."""
    name = entity.dxf.layer
    why = "is invisible" if entity.dxf.invisible else ""
    if layers.has_entry(name):
        layer = layers.get(name)
        why = f"is on layer {name!r}, which is frozen" if layer.is_frozen() else why
        why = f"is on layer {name!r}, which is off" if layer.is_off() else why
    if why:
        problem = f"an entity {entity.dxftype()} (handle {entity.dxf.handle}) {why}"
        raise BadCurve(problem, valid="a drawing of the outline alone, all of it visible")


def _require_one_height(entities, tolerance: float) -> None:
    """Nothing, if all entities lie at one height z: the plane of a drawing is xy, and z is not read."""
    first = None
    for entity in entities:
        for height in _heights(entity):
            first = height if first is None else first
            if not abs(height - first) <= tolerance:
                kind, handle = entity.dxftype(), entity.dxf.handle
                problem = f"z is {height:.6g} in {kind} (handle {handle}) and {first:.6g} elsewhere"
                raise BadCurve(
                    problem, valid="a drawing in one plane z = const, as its view along z"
                )


def _heights(entity) -> list[float]:
    kind, dxf = entity.dxftype(), entity.dxf
    if kind == "LWPOLYLINE":
        return [dxf.elevation]
    if kind == "POLYLINE":
        return [dxf.elevation[2]]
    if kind == "SPLINE":
        return [point[2] for point in entity.control_points]
    points = (dxf.start, dxf.end) if kind == "LINE" else (dxf.center,)
    return [tuple(point)[2] for point in points]


def _curve_of(entity) -> Curve:
    readers = {
        "LINE": _line,
        "ARC": _arc,
        "CIRCLE": _circle,
        "LWPOLYLINE": _light_polyline,
        "POLYLINE": _polyline,
        "SPLINE": _spline,
    }
    kind = entity.dxftype()
    if kind not in readers:
        raise BadCurve(f"an entity {kind} (handle {entity.dxf.handle})", valid=f"only {KINDS}")
    normal = entity.dxf.get("extrusion", (0.0, 0.0, 1.0))
    if not np.allclose(tuple(normal), (0.0, 0.0, 1.0), atol=PARAMETER):
        problem = f"entity {kind} (handle {entity.dxf.handle}) with extrusion {tuple(normal)}"
        raise BadCurve(problem, valid="entities in the plane, extrusion (0, 0, 1)")
    with at(f"{kind} (handle {entity.dxf.handle})"):
        return readers[kind](entity)


def _line(entity) -> Curve:
    return Curve.line(tuple(entity.dxf.start)[:2], tuple(entity.dxf.end)[:2])


def _arc(entity) -> Curve:
    angles = (entity.dxf.start_angle, entity.dxf.end_angle)
    if not max(map(abs, angles)) <= _MOST_DEGREES:
        raise BadCurve(f"an arc from {angles[0]:g} to {angles[1]:g} degrees", valid="-360 to 360")
    start, end = map(math.radians, angles)
    while end <= start:
        end += 2.0 * math.pi
    return Curve.arc(tuple(entity.dxf.center)[:2], entity.dxf.radius, start, end)


def _circle(entity) -> Curve:
    return Curve.circle(tuple(entity.dxf.center)[:2], entity.dxf.radius)


def _light_polyline(entity) -> Curve:
    ends = [width for pair in entity.get_points("se") for width in pair]
    _require_no_width(entity, [entity.dxf.const_width, *ends])
    return _bulged([(x, y, bulge) for x, y, bulge in entity.get_points("xyb")], entity.closed)


def _polyline(entity) -> Curve:
    if not entity.is_2d_polyline:
        raise BadCurve("a polyline in space, a mesh or a polyface", valid="a polyline in the plane")
    drawn = [vertex.dxf for vertex in entity.vertices if not vertex.dxf.flags & _FRAME]
    ends = [width for dxf in drawn for width in (dxf.start_width, dxf.end_width)]
    _require_no_width(entity, [entity.dxf.default_start_width, entity.dxf.default_end_width, *ends])
    return _bulged([(*tuple(dxf.location)[:2], dxf.bulge) for dxf in drawn], entity.is_closed)


def _require_no_width(entity, widths: list[float]) -> None:
    """Nothing, if a polyline is drawn as its line: a wide one is a band, whose edges no contour here follows."""
    widest = max(widths, key=abs)
    if widest != 0.0:
        problem = f"a polyline of width {widest:g} on layer {entity.dxf.layer!r}"
        raise BadCurve(problem, valid="polylines of width 0, along the outline itself")


def _spline(entity) -> Curve:
    control = np.array([tuple(p)[:2] for p in entity.control_points], float)
    if len(control) == 0:
        raise BadCurve("a spline of fit points alone", valid="a spline with control points")
    weights = np.array(entity.weights, float) if len(entity.weights) else None
    return Curve.bspline(control, entity.dxf.degree, np.array(entity.knots, float), weights)


def _bulged(rows: list[tuple[float, float, float]], closed: bool) -> Curve:
    """The chain of segments and arcs of vertices (x, y, bulge); bulge = tan(sweep / 4), positive to the left."""
    if closed:
        rows = [*rows, *rows[:1]]
    parts = []
    for (x0, y0, bulge), (x1, y1, _) in zip(rows[:-1], rows[1:], strict=True):
        if (x0, y0) == (x1, y1):
            continue
        parts.append(_bulge_arc(x0, y0, x1, y1, bulge) if bulge else Curve.line((x0, y0), (x1, y1)))
    if not parts:
        valid = "at least two points that differ, beside the frame of a spline"
        raise BadCurve("a polyline of zero length", valid=valid)
    return Curve.chain(parts)


def _bulge_arc(x0: float, y0: float, x1: float, y1: float, bulge: float) -> Curve:
    """The arc as rational quadratics whose ends are the vertices to the last bit."""
    sweep = 4.0 * math.atan(bulge)
    n = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - PARAMETER))
    start, end = np.array([x0, y0]), np.array([x1, y1])
    left = np.array([y0 - y1, x1 - x0])
    center = 0.5 * (start + end) + left * (1.0 - bulge * bulge) / (4.0 * bulge)
    half = 0.5 * sweep / n
    arm, points = start - center, []
    for k in range(2 * n + 1):
        c, s = math.cos(k * half), math.sin(k * half)
        reach = 1.0 / math.cos(half) if k % 2 else 1.0
        points.append(center + reach * np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]))
    points[0], points[-1] = start, end
    weights = [1.0, math.cos(half), 1.0]
    return Curve.chain([Curve.bezier(points[2 * k : 2 * k + 3], weights) for k in range(n)])


def _chained(parts: list[Curve]) -> list[Curve]:
    """Parts that meet end to end, in any order and sense, joined into contours."""
    size = float(
        np.hypot(*(np.max([p.box[1] for p in parts], 0) - np.min([p.box[0] for p in parts], 0)))
    )
    waiting, contours = list(parts), []
    while waiting:
        chain = [waiting.pop(0)]
        while not _same(_end(chain[-1]), _start(chain[0]), size):
            k = _next(chain[-1], waiting, size)
            if k is None:
                break
            part = waiting.pop(k)
            chain.append(part if _same(_start(part), _end(chain[-1]), size) else part.reversed())
        contours.append(_as_one(chain))
    return contours


def _as_one(chain: list[Curve]) -> Curve:
    try:
        return Curve.chain(chain)
    except BadInput:  # meets within the drawing's size but not within the part's own
        return Curve.contours(chain)


def _next(last: Curve, waiting: list[Curve], size: float) -> int | None:
    for k, part in enumerate(waiting):
        if _same(_start(part), _end(last), size) or _same(_end(part), _end(last), size):
            return k
    return None


def _start(curve: Curve) -> np.ndarray:
    return curve.point(curve.limits[0, 0])


def _end(curve: Curve) -> np.ndarray:
    return curve.point(curve.limits[-1, 1])


def _same(one: np.ndarray, two: np.ndarray, size: float) -> bool:
    return bool(np.hypot(*(one - two)) <= MEETING * size)
