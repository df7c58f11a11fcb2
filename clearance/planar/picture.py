"""Pictures of a comparison, like Figs. 8, 17 and 18 of the paper: the one door to matplotlib.

Curve a and b, what trimming left of each (bold), the line of the distance, and on request the distance map
of b with a colour for each nearest arc. Not for: reports' other figures.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clearance.errors import BadInput, Unavailable, Unwritable
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff
from clearance.planar.trimming import distance_field, kept_intervals

COLOR_A, COLOR_B, COLOR_LINE = "#c99700", "#1f5fbf", "#d62728"


def draw_comparison(
    a: Curve, b: Curve, found: Hausdorff, path: str, *, field: bool = False
) -> None:
    """Writes the picture of `found` into `path`, an .svg or .png file; the same input gives the same bytes.

    Raises: BadInput (another suffix), Unavailable (no matplotlib), Unwritable.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".svg", ".png"):
        raise BadInput(
            f"a picture {suffix or 'without suffix'}", where=str(path), valid=".svg or .png"
        )
    try:
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise Unavailable("matplotlib is not installed", valid="pip install matplotlib") from None
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    _fill(figure.add_subplot(), a, b, found, field)
    metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": "clearance", "svg.fonttype": "path"}):
        try:
            figure.savefig(path, dpi=150, metadata=metadata)
        except OSError as error:
            raise Unwritable(f"cannot write ({error.strerror})", where=str(path)) from None


def _fill(axes, a: Curve, b: Curve, found: Hausdorff, field: bool) -> None:
    low, high = np.minimum(a.box[0], b.box[0]), np.maximum(a.box[1], b.box[1])
    edge = 0.05 * float(np.hypot(*(high - low)))
    low, high = low - edge, high + edge
    if field:
        xs, ys = np.linspace(low[0], high[0], 480), np.linspace(low[1], high[1], 480)
        depth, which = distance_field(b, xs, ys)
        extent = (low[0], high[0], low[1], high[1])
        axes.imshow(which * 7 % 20, origin="lower", extent=extent, cmap="tab20", alpha=0.35)
        axes.contour(xs, ys, depth, 12, colors="black", linewidths=0.3, alpha=0.5)
    pairs = ((a, b, COLOR_A, "a"), (b, a, COLOR_B, "b"))
    for (one, two, color, name), directed in zip(pairs, found.directed.values(), strict=True):
        for line in _lines(one):
            axes.plot(*line.T, color=color, linewidth=1.0, label=name)
            name = None
        for start, end in kept_intervals(one, two, max(0.0, directed.lower)):
            part = one.point(np.linspace(start, end, 24))
            axes.plot(*part.T, color=color, linewidth=3.5, solid_capstyle="round")
    ends = np.stack([found.point_a, found.point_b])
    axes.plot(
        *ends.T, "o-", color=COLOR_LINE, linewidth=1.4, markersize=4, label="Hausdorff distance"
    )
    axes.set_title(
        f"{found.distance:.9g} ± {found.error_bound:.1e}  ({found.direction}, {found.kind})"
    )
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.legend(loc="best", fontsize="small")


def _lines(curve: Curve) -> list[np.ndarray]:
    """Each contour as points dense enough for a picture."""
    rows, owner = curve.leaves.arcs, curve.leaves.piece
    count = 2 if curve.highest_degree == 1 else 12
    local = rows[:, :1] + (rows[:, 1:2] - rows[:, :1]) * np.linspace(0.0, 1.0, count)
    points = curve._jets(np.repeat(owner, count), local.ravel())[:, :2] + curve.origin
    cuts = np.flatnonzero(np.diff(np.repeat(curve.contour[owner], count))) + 1
    return np.split(points, cuts)
