"""Pictures of two outlines: what one gained and lost against the other, the distance, and the worst place near.

SVG and PNG through matplotlib, the same bytes for the same input.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from clearance.errors import BadInput
from clearance.extras import importing
from clearance.files import write_file
from clearance.profiles.outline_file import DrawnOutline, rings_of_curve
from clearance.profiles.region import Region, difference, rings_of

COLORS = {"a": "#c99700", "b": "#1f5fbf", "gained": "#2ca25f", "lost": "#d62728", "line": "#111111"}


def draw_outlines(
    a: DrawnOutline,
    b: DrawnOutline,
    ends: np.ndarray,
    title: str,
    path: str | Path,
    *,
    shade: tuple[str, str] = ("only in b", "only in a"),
) -> None:
    """Writes the picture of two outlines and a distance line into a .svg or .png file.

    Args:
        ends: (2, 2) the ends of the line.
        shade: names of the areas that only b and only a have.

    Raises: BadInput (another suffix), Unavailable (no matplotlib), Unwritable.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".svg", ".png"):
        given = suffix or "without suffix"
        raise BadInput(f"a picture {given}", where=str(path), valid=".svg or .png")
    write_file(path, picture_bytes(a, b, ends, title, suffix, shade=shade))


def picture_bytes(
    a: DrawnOutline,
    b: DrawnOutline,
    ends: np.ndarray,
    title: str,
    suffix: str,
    *,
    shade: tuple[str, str] = ("only in b", "only in a"),
) -> bytes:
    """The picture as the content of an .svg or .png file.

    Raises: Unavailable (no matplotlib).
    """
    low, high = (
        np.minimum(a.curve.box[0], b.curve.box[0]),
        np.maximum(a.curve.box[1], b.curve.box[1]),
    )
    margin = 0.05 * float(np.hypot(*(high - low)))
    low, high = low - margin, high + margin
    width, height = high - low
    scale = min(6.6 / width, 5.4 / height)
    size = (width * scale + 4.2, max(height * scale, 3.0) + 1.2)
    figure = _new_figure(size)
    whole, near = figure.subplots(1, 2, width_ratios=[max(width * scale, 2.0), 3.2])
    fill = not (a.region_fault or b.region_fault)
    for axes in (whole, near):
        _fill(axes, a, b, ends, shade if fill else None)
    whole.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    _zoom(whole, near, ends, float(max(width, height)))
    figure.suptitle(title, fontsize="medium")
    handles, names = whole.get_legend_handles_labels()
    figure.legend(
        handles, names, loc="outside lower center", ncols=5, fontsize="small", frameon=False
    )
    return _figure_bytes(figure, suffix)


def _zoom(whole, near, ends: np.ndarray, page: float) -> None:
    """Frames the distance line on the right, and shows its place on the left."""
    reach = max(1.6 * float(np.hypot(*(ends[1] - ends[0]))), 0.004 * page)
    middle = ends.mean(axis=0)
    near.set(
        xlim=(middle[0] - reach, middle[0] + reach),
        ylim=(middle[1] - reach, middle[1] + reach),
        aspect="equal",
        title="where it is attained",
    )
    near.title.set_fontsize("small")
    if reach < 0.4 * page:
        box = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * max(reach, 0.01 * page)
        whole.plot(*(box + middle).T, color="#666666", linewidth=0.8, zorder=6)
    for axes in (whole, near):
        axes.spines[["top", "right"]].set_visible(False)
        axes.spines[["left", "bottom"]].set_color("#999999")
        axes.tick_params(colors="#555555", labelsize="x-small")


def _fill(
    axes, a: DrawnOutline, b: DrawnOutline, ends: np.ndarray, shade: tuple[str, str] | None
) -> None:
    if shade is not None:
        _shade(axes, difference(b.region, a.region), COLORS["gained"], shade[0])
        _shade(axes, difference(a.region, b.region), COLORS["lost"], shade[1])
    for drawn, color in ((a, COLORS["a"]), (b, COLORS["b"])):
        label: str | None = drawn.name
        for ring in rings_of_curve(drawn.curve):
            closed = np.concatenate([ring, ring[:1]]) if drawn.curve.is_closed else ring
            axes.plot(*closed.T, color=color, linewidth=1.3, label=label, zorder=3)
            label = None
    style = {"linewidth": 1.5, "markersize": 4, "zorder": 5, "color": COLORS["line"]}
    axes.plot(*ends.T, "o-", label="distance", **style)


def _shade(axes, region: Region, color: str, label: str) -> None:
    """A region with its holes as one filled path."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Lines

    if region.is_empty:
        return
    vertices, codes = [], []
    for ring, _ in rings_of(region):
        vertices += [*ring, ring[0]]
        codes += [Lines.MOVETO] + [Lines.LINETO] * (len(ring) - 1) + [Lines.CLOSEPOLY]
    patch = PathPatch(
        Lines(np.array(vertices), codes), facecolor=color, alpha=0.35, linewidth=0, label=label
    )
    axes.add_patch(patch)


def _new_figure(size: tuple[float, float]):
    """A figure of matplotlib of a size [inch].

    Raises: Unavailable (no matplotlib).
    """
    with importing("report", "a picture"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _figure_bytes(figure, suffix: str) -> bytes:
    """A figure as the content of an .svg or .png file, always the same."""
    import matplotlib

    out = io.BytesIO()
    metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": "clearance", "svg.fonttype": "path"}):
        figure.savefig(out, format=suffix[1:], dpi=130, metadata=metadata)
    return out.getvalue()
