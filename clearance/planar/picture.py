"""Pictures of a comparison, like Figs. 8, 17 and 18 of the paper: the adapter of matplotlib.

Curve a and b, the rest of each after trimming (bold), the line of the distance, and the distance map
of b with a colour for each nearest arc. Not for: reports' other figures.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from clearance.errors import BadInput
from clearance.extras import importing
from clearance.files import write_file
from clearance.kernels.hausdorff.trim import candidate_arcs, field
from clearance.planar.curve import Curve
from clearance.planar.directed import placed
from clearance.planar.hausdorff import Hausdorff

COLOR_A, COLOR_B, COLOR_LINE = "#c99700", "#1f5fbf", "#d62728"


def draw_comparison(a: Curve, b: Curve, found: Hausdorff, path: str | Path) -> None:
    """Writes the picture of `found` into `path`, an .svg or .png file; the same input gives the same bytes.

    Raises: BadInput (another suffix), Unavailable (no matplotlib), Unwritable.
    """
    write_picture(path, partial(_comparison, a, b, found))


def write_picture(path: str | Path, drawn: Callable[[str], bytes]) -> None:
    """Writes what `drawn` gives for the suffix of a file, .svg or .png.

    Raises: BadInput (another suffix), Unwritable, and what `drawn` raises.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".svg", ".png"):
        given = suffix or "without suffix"
        raise BadInput(f"a picture {given}", where=str(path), valid=".svg or .png")
    write_file(path, drawn(suffix))


def new_figure(size: tuple[float, float]):
    """A figure of matplotlib of a size [inch].

    Raises: Unavailable (no matplotlib).
    """
    with importing("report", "a picture"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def figure_bytes(figure, suffix: str, dpi: int) -> bytes:
    """A figure as the content of an .svg or .png file, always the same."""
    import matplotlib

    out = io.BytesIO()
    metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": "clearance", "svg.fonttype": "path"}):
        figure.savefig(out, format=suffix[1:], dpi=dpi, metadata=metadata)
    return out.getvalue()


def page_of(a: Curve, b: Curve, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of a page: both curves with a margin, a share of its diagonal."""
    low, high = np.minimum(a.box[0], b.box[0]), np.maximum(a.box[1], b.box[1])
    margin *= float(np.hypot(*(high - low)))
    return low - margin, high + margin


def bare_axes(axes, labelsize: str) -> None:
    """Takes frame lines off that say nothing, and greys the others."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color("#999999")
    axes.tick_params(colors="#555555", labelsize=labelsize)


def _size_of(low: np.ndarray, high: np.ndarray) -> tuple[float, float]:
    """Width and height of the figure [inch] that leave no empty bands around the page."""
    width, height = high - low
    scale = min(9.0 / width, 7.0 / height)
    return max(5.0, width * scale + 0.6), max(2.2, height * scale) + 1.3


def _comparison(a: Curve, b: Curve, found: Hausdorff, suffix: str) -> bytes:
    low, high = page_of(a, b, 0.06)
    figure = new_figure(_size_of(low, high))
    axes = figure.add_subplot()
    _draw_field(axes, b, low, high)
    pairs = ((a, b, COLOR_A, "a"), (b, a, COLOR_B, "b"))
    for (one, two, color, name), directed in zip(pairs, found.directed.values(), strict=True):
        _draw_curve(axes, one, two, directed.lower, color, name)
    _draw_distance(axes, found)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    bare_axes(axes, "small")
    direction = found.direction.replace("_", " ")
    kind = found.kind.replace("_", " ")
    axes.set_title(
        f"Hausdorff distance {found.distance:.9g} ± {found.error_bound:.1e}\n{direction}, {kind}",
        fontsize="medium",
    )
    figure.legend(loc="outside lower center", ncols=5, fontsize="small", frameon=False)
    return figure_bytes(figure, suffix, 150)


def _draw_field(axes, b: Curve, low: np.ndarray, high: np.ndarray) -> None:
    """The page in a pale colour for each nearest arc of b, with lines of equal distance."""
    step = float((high - low).max()) / 700.0
    n_x, n_y = (int(n) for n in np.maximum(2, np.ceil((high - low) / step)))
    xs, ys = np.linspace(low[0], high[0], n_x), np.linspace(low[1], high[1], n_y)
    depth, which = distance_field(b, xs, ys)
    extent = (low[0], high[0], low[1], high[1])
    shade = which * 7 % 20
    axes.imshow(
        shade, origin="lower", extent=extent, cmap="tab20", vmin=0, vmax=19, alpha=0.28, zorder=0
    )
    axes.contour(xs, ys, depth, 10, colors="#444444", linewidths=0.35, alpha=0.45, zorder=1)


def _draw_curve(axes, one: Curve, two: Curve, bound: float, color: str, name: str) -> None:
    """The whole curve thin, and bold the rest after trimming at the proven lower bound."""
    label = f"{name}, trimmed away"
    axes.plot(*_line(one).T, color=color, linewidth=1.1, label=label, zorder=3)
    remaining = _points(one, *remaining_parts(one, two, max(0.0, bound)))
    width = 5.0 if name == "a" else 3.0  # where both are bold, one shows next to the other
    label = f"{name}, left to solve"
    axes.plot(
        *remaining.T, color=color, linewidth=width, solid_capstyle="round", label=label, zorder=4
    )


def _draw_distance(axes, found: Hausdorff) -> None:
    ends = np.stack([found.point_a, found.point_b])
    style = {"linewidth": 1.5, "markersize": 5, "markeredgecolor": "white", "markeredgewidth": 0.8}
    axes.plot(*ends.T, "o-", color=COLOR_LINE, label="distance", zorder=5, **style)


def _line(curve: Curve) -> np.ndarray:
    """The whole curve as points dense enough for a picture, broken (nan) between contours."""
    rows, owner = curve.leaves.arcs, curve.leaves.piece
    points = _points(curve, owner, rows[:, :2])
    breaks = np.isnan(points[:, 0])
    breaks[breaks] = np.diff(curve.contour[owner], append=-1) == 0
    return points[~breaks]


def _points(curve: Curve, piece: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Points along parts of pieces, given by local parameters (n, 2), with a nan after each part."""
    count = 2 if curve.highest_degree == 1 else 24
    inner = local[:, :1] + (local[:, 1:] - local[:, :1]) * np.linspace(0.0, 1.0, count)
    points = curve._jets(np.repeat(piece, count), inner.ravel())[:, :2] + curve.origin
    points = points.reshape(len(piece), count, 2)
    return np.pad(points, ((0, 0), (0, 1), (0, 0)), constant_values=np.nan).reshape(-1, 2)


def remaining_parts(a: Curve, b: Curve, lower_bound: float) -> tuple[np.ndarray, np.ndarray]:
    """The arcs of `a` that may be farther from `b` than a bound: piece (n,) and local parameters (n, 2).

    Every point of a outside them is proven to be nearer. Equations (3) to (10) of Kim, Oh, Kim (2010).
    """
    shift, _ = placed(a, b)
    rows, owner = a.leaves.arcs, a.leaves.piece
    pixel = a.length / max(64, 2 * len(rows))
    remaining = candidate_arcs(a.pieces, a.leaves, b.leaves, shift[0], shift[1], lower_bound, pixel)
    return owner[remaining], rows[remaining, :2]


def distance_field(curve: Curve, xs: np.ndarray, ys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance to the arcs of `curve` and the nearest arc's index, (len(ys), len(xs)) each: a page of the map."""
    depth = np.empty((len(ys), len(xs)))
    which = np.empty(depth.shape, np.int64)
    x = np.ascontiguousarray(xs - curve.origin[0])
    y = np.ascontiguousarray(ys - curve.origin[1])
    field(curve.leaves, x, y, depth, which)
    return depth, which
