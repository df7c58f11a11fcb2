"""The pictures of the benchmarks: trajectories by scene, growth, error against time.

matplotlib, from the rows that also go into the csv files; nothing is computed here that is not in them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {
    "clearance": "#c1121f",
    "clearance paper": "#f4a261",
    "FCL": "#1d4e89",
    "FCL shapes": "#7d9cc0",
    "Coal": "#2a7f62",
    "Coal shapes": "#8fc1ad",
    "Klampt": "#6a4c93",
    "PyBullet": "#8d6e63",
    "sampled points": "#7a7a7a",
    "approximations": "#b0a030",
}
FLOOR = 1e-18
"""Where an error of zero is drawn."""

STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "clearance",
    "svg.fonttype": "path",
}


def draw_trajectory(rows: Sequence[dict], path: str) -> None:
    """Milliseconds a step of every loop, a row a scene; lines carry the ratio to ours."""
    names = list(dict.fromkeys(row["scene"] for row in rows))
    shown = [row for row in rows if not row["method"].endswith("pair minima")]
    methods = list(dict.fromkeys(row["method"] for row in shown))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(9.5, 0.72 * len(names) + 2.2), layout="constrained")
        for i_method, method in enumerate(methods):
            chosen = [row for row in shown if row["method"] == method]
            heights = [names.index(row["scene"]) for row in chosen]
            axes.scatter(
                [row["ms_per_step"] for row in chosen],
                heights,
                s=95 if chosen[0]["library"] == "clearance" else 46,
                marker="D" if chosen[0]["library"] == "clearance" else "osv^P"[i_method % 5],
                color=COLOURS[chosen[0]["library"]],
                edgecolor="white",
                linewidth=0.7,
                label=method,
                zorder=3,
            )
        for i, name in enumerate(names):
            _span_of(axes, i, [row for row in shown if row["scene"] == name])
        axes.set(
            xscale="log", xlabel="milliseconds of CPU a step (one thread)", yticks=range(len(names))
        )
        axes.set_yticklabels(names)
        axes.set_ylim(len(names) - 0.5, -0.6)
        axes.grid(axis="x", color="#e4e4e4")
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8)
        axes.set_title(
            "The clearance of every step: ours and the peers' loops on the same meshes", loc="left"
        )
        _save(figure, path)


def _span_of(axes, height: int, rows: Sequence[dict]) -> None:
    ours = next(row["ms_per_step"] for row in rows if row["library"] == "clearance")
    peers = [row["ms_per_step"] for row in rows if row["library"] != "clearance"]
    if peers:
        axes.plot([min([ours, *peers]), max(peers)], [height, height], color="#cccccc", zorder=1)
        note = f"{min(peers) / ours:.1f} to {max(peers) / ours:.0f} times ours"
        axes.annotate(
            note, (ours, height), (0, 9), textcoords="offset points", fontsize=7.5, color="#555555"
        )


def draw_growth(rows: Sequence[dict], path: str) -> None:
    """Two panels: milliseconds a step against triangles, and against steps of one motion."""
    panels = {"triangles": "triangles in the scene", "steps": "steps of one motion"}
    with plt.rc_context(STYLE):
        figure, both = plt.subplots(1, 2, figsize=(9.5, 3.4), layout="constrained", sharey=True)
        for axes, (what, label) in zip(both, panels.items(), strict=True):
            chosen = [row for row in rows if row["what"] == what]
            sizes, spent = [row[what] for row in chosen], [row["ms_per_step"] for row in chosen]
            axes.plot(sizes, spent, "D-", color=COLOURS["clearance"], label="ours")
            if what == "triangles":
                steepest = [
                    spent[0] * 2.5 ** (math.log(size / sizes[0]) / math.log(16)) for size in sizes
                ]
                axes.plot(
                    sizes,
                    steepest,
                    "--",
                    color="#7a7a7a",
                    label="2.5 times for 16 times the triangles",
                )
            axes.set(xscale="log", yscale="log", xlabel=label)
            axes.grid(color="#ececec")
            axes.legend(frameon=False, fontsize=8)
        both[0].set_ylabel("milliseconds of CPU a step")
        figure.suptitle(
            "How our time grows: seven links among 20 obstacles", x=0.01, ha="left", fontsize=10
        )
        _save(figure, path)


def draw_error_time(rows: Sequence[dict], path: str) -> None:
    """A panel a group: worst error against median time, a line down to the median error."""
    groups = [g for g in ("polygons", "bodies", "steps") if any(row["group"] == g for row in rows)]
    titles = {
        "polygons": "polygon pairs",
        "bodies": "body pairs",
        "steps": "whole steps, shared cases",
    }
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(
            len(groups), 1, figsize=(9.5, 5.0 * len(groups)), layout="constrained", squeeze=False
        )
        for axes, group in zip(panels[:, 0], groups, strict=True):
            chosen = [r for r in rows if r["group"] == group and math.isfinite(r["us_median"])]
            for row in chosen:
                _draw_method(axes, row)
            unit = "[m]" if group == "steps" else "in parts of the size"
            axes.set(
                xscale="log",
                yscale="log",
                xlabel=f"error {unit}: line from the median to the worst",
            )
            axes.set_ylabel("time a query [µs]")
            axes.set_xlim(FLOOR / 3, 1e3)
            axes.grid(color="#ececec")
            axes.set_title(f"{titles[group]} (down and left is better)", loc="left")
            figure.draw_without_rendering()
            _label(figure, axes, chosen)
        axes.plot([], [], "x", color="black", label="false contacts, number in brackets")
        axes.plot(
            [],
            [],
            "o",
            mfc="none",
            color="black",
            ms=10,
            label="missed contacts, number in brackets",
        )
        axes.legend(loc="upper left", frameon=False, fontsize=8)
        _save(figure, path)


def _draw_method(axes, row: dict) -> None:
    colour = COLOURS[row["library"]]
    worst, median = max(row["error_worst"], FLOOR), max(row["error_median"], FLOOR)
    axes.plot([median, worst], [row["us_median"]] * 2, color=colour, alpha=0.45, linewidth=1.3)
    ours = row["library"] == "clearance"
    axes.plot(worst, row["us_median"], "D" if ours else "o", color=colour, ms=9 if ours else 6)
    if row["false_contacts"]:
        axes.plot(worst, row["us_median"], "x", color="black", ms=6, mew=1.3)
    if row["missed_contacts"]:
        axes.plot(worst, row["us_median"], "o", mfc="none", color="black", ms=11, mew=1.1)


def _label(figure, axes, rows: Sequence[dict]) -> None:
    """Names beside the marks, each at the first place where it hides no other name or mark."""
    renderer = figure.canvas.get_renderer()
    taken = []
    for row in rows:
        x, y = axes.transData.transform((max(row["error_worst"], FLOOR), row["us_median"]))
        start = axes.transData.transform((max(row["error_median"], FLOOR), row["us_median"]))[0]
        taken += [(x - 6, y - 6, x + 6, y + 6), (start, y - 1, x, y + 1)]
    for row in sorted(rows, key=lambda r: r["us_median"]):
        at = (max(row["error_worst"], FLOOR), row["us_median"])
        best = None
        for dx, dy in _places():
            note = axes.annotate(
                _name_of(row), at, (dx, dy), textcoords="offset points", fontsize=7.5, va="center",
                ha="left" if dx >= 0 else "right", color=COLOURS[row["library"]],
                arrowprops={"arrowstyle": "-", "color": "#bbbbbb", "lw": 0.6} if abs(dy) > 9 else None,
            )  # fmt: skip
            note.update_positions(renderer)
            box = matplotlib.text.Text.get_window_extent(note, renderer)
            spot = (box.x0, box.y0 - 1, box.x1, box.y1 + 1)
            frame = axes.bbox
            inside = (
                frame.x0 < spot[0]
                and spot[2] < frame.x1
                and frame.y0 < spot[1]
                and spot[3] < frame.y1
            )
            if inside and not any(_overlap(spot, other) for other in taken):
                best = spot
                break
            note.remove()
        if best is not None:
            taken.append(best)


def _places():
    for reach in (0, 11, 22, 33, 46, 60, 80, 100):
        for sign in (1, -1) if reach else (1,):
            yield from (((11 + reach / 3), sign * reach), (-(11 + reach / 3), sign * reach))


def _name_of(row: dict) -> str:
    faults = [
        f"{row[key]} {kind}"
        for key, kind in (
            ("false_contacts", "false"),
            ("missed_contacts", "missed"),
            ("no_answer", "unanswered"),
        )
        if row[key]
    ]
    return f"{row['method']} ({', '.join(faults)})" if faults else row["method"]


def _overlap(a, b) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _save(figure, path: str) -> None:
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None} if path.endswith(".svg") else None, dpi=110)
    plt.close(figure)
