"""A sketch fitted to an outline: nearest to it, least around it, or largest that stays clear of it.

All constraints of the sketch hold throughout, since every shape tried is a solved sketch. The search linearises
many distances and solves linear programs in a trust region, from several starts in a fixed order; the answer's
distance and containment are certified by `clearance.planar` whatever the search did. Local optima: the best of the
starts wins, no claim is made beyond. Not for: sketches without closed outlines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from clearance.errors import BadDimension, BadInput, BadShape
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, hausdorff
from clearance.profiles.fit_bounded import BoundedFit
from clearance.profiles.fit_nearest import NearestFit
from clearance.profiles.fit_report import rates_of_fixed, sensitivities, touching
from clearance.profiles.fit_shape import SketchShape
from clearance.profiles.fit_target import FitCandidate, FitTarget
from clearance.profiles.outline_file import DrawnOutline, require_closed
from clearance.profiles.profile import Profile
from clearance.sketch import Sketch

MODES = ("nearest", "outside", "inside")


class NoFit(BadShape):
    """No start of the search led to a sketch that meets the request."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A sketch fitted to an outline.

    Attributes:
        mode: "nearest", "outside" or "inside".
        sketch: solved; the free dimensions have their fitted values.
        dimensions: the free dimensions [m] or [rad].
        shift: (2,) [m] and turn [rad]: how the sketch was placed, unless it was fixed.
        distance: the Hausdorff distance to the outline, certified, with its witnesses.
        area: [m^2] of the sketch.
        margin: [m] that was given.
        clearance: [m] proven lower bound of the gap between sketch and outline (outside, inside); the sketch
            then contains the outline, or stays clear of it. None for nearest.
        active: fixed dimensions that stop it from being better, strongest first: how much the objective (distance
            [m], area [m^2]) changes for each unit of the dimension.
        sensitivity: for each free dimension how the distance (nearest) or the clearance changes when it grows
            and when it shrinks, per unit.
        ends: (2, 2) [m] where it is attained what counts: the Hausdorff distance (nearest) or the least gap, on
            the outline and on the sketch.
        touching: (k, 2) points at which the fit touches.
        n_starts: how many starts were tried. n_agreeing: how many of them came to this sketch's distance or area.
    """

    mode: str
    sketch: Sketch
    dimensions: dict[str, float]
    shift: np.ndarray
    turn: float
    distance: Hausdorff
    area: float
    margin: float
    clearance: float | None
    active: dict[str, float]
    sensitivity: dict[str, tuple[float, float]]
    ends: np.ndarray
    touching: np.ndarray
    n_starts: int
    n_agreeing: int
    curve: Curve = field(repr=False)

    def unit_of(self, name: str) -> tuple[str, float]:
        """The unit in which a dimension is printed, and how many of it 1 m or 1 rad is."""
        drawn = self.sketch.constraints.get(name)
        return ("rad", 1.0) if drawn is not None and drawn.kind == "angle" else ("mm", 1000.0)

    @property
    def title(self) -> str:
        """One line for a picture: the mode and the dimensions in mm where they are lengths."""
        shown = ((name, value, *self.unit_of(name)) for name, value in self.dimensions.items())
        parts = ", ".join(
            f"{name} {scale * value:.6g} {unit}" for name, value, unit, scale in shown
        )
        return f"{self.mode}: {parts}"


def fit(
    sketch: Sketch,
    profile: Profile | DrawnOutline | Curve,
    mode: str = "nearest",
    *,
    free: Sequence[str] | None = None,
    margin: float = 0.0,
    starts: int = 8,
) -> Fit:
    """The sketch whose free dimensions, and place unless it is fixed, suit an outline best.

    Args:
        sketch: stays as it is; it draws closed contours. Free are its driven dimensions.
        profile: a swept profile, or any closed outline.
        mode: "nearest": least Hausdorff distance. "outside": least area that contains the outline. "inside":
            largest area that stays clear of it: in a hole, or outside it, or inside a drawn outline (not a sweep)
            about the sketch.
        free: names of dimensions or parameters instead.
        margin: [m] least gap for outside and inside.
        starts: how many starting shapes are tried.

    Exactness: `distance` and `clearance` are certified; that no better sketch exists is not.
    Raises:
        BadInput: an unknown mode or dimension. NoFreeDimension. BadShape: a contradictory sketch, an open contour,
        contours that overlap, freedoms without a dimension. NoFit: nothing found that contains the outline, or
        stays clear of it.
    """
    if mode not in MODES:
        raise BadInput(f"unknown mode {mode!r}", where="mode", valid=f"one of {', '.join(MODES)}")
    if not 0.0 <= margin < np.inf:
        raise BadDimension(f"{margin} m", where="margin", valid="0 or more")
    outline = _drawn(profile)
    require_closed(outline.curve, outline.name)
    shape = SketchShape(sketch, free)
    drawn = shape.at(shape.start)
    if drawn is None:
        raise BadShape("the sketch cannot be drawn", where="sketch")
    if drawn.crosses_itself:
        raise BadShape(
            "the sketch crosses itself", where="sketch", valid="contours that enclose an area each"
        )
    target = FitTarget(outline, shape, drawn, mode, margin)
    search = (NearestFit if mode == "nearest" else BoundedFit)(shape, target, drawn)
    best, scores = _best(search, starts_of(shape, outline, mode, starts))
    if best is None:
        raise _no_fit(search, mode, margin, len(scores))
    return _answer(sketch, shape, search, best, scores)


def _no_fit(search: NearestFit | BoundedFit, mode: str, margin: float, tried: int) -> NoFit:
    if getattr(search, "endless", False):
        return NoFit(
            "the sketch grows beside the outline without end",
            where="fit",
            valid="a sketch drawn in a hole of the outline, or dimensions that hold it",
        )
    what = "contains the outline" if mode == "outside" else "stays clear of the outline"
    return NoFit(
        f"no sketch was found that {what} by {margin:g} m ({tried} starts)",
        where="fit",
        valid="a sketch drawn nearer to the answer, or more free dimensions"
        + (", or a smaller margin" if margin else ""),
    )


def _drawn(profile: Profile | DrawnOutline | Curve) -> DrawnOutline:
    if isinstance(profile, DrawnOutline):
        return profile
    if isinstance(profile, Curve):
        return DrawnOutline("outline", profile)
    return DrawnOutline(profile.name or "profile", profile.curve, profile)


def _best(
    search: NearestFit | BoundedFit, starts: list[np.ndarray]
) -> tuple[FitCandidate | None, list[float]]:
    """The best candidate, and the score of every start that was tried: infinite where it led to none as good as
    those before."""
    best, scores = None, list[float]()
    for start in starts:
        found = search.run(start, np.inf if best is None else best.score)
        scores.append(np.inf if found is None else found.score)
        if found is None:
            continue
        if best is None or search.target.better(found, best):
            best = found
        if search.target.mode == "nearest" and best.score <= 1e-10 * search.shape.size:
            break  # nothing is nearer than this
    return best, scores


def _answer(
    sketch: Sketch,
    shape: SketchShape,
    search: NearestFit | BoundedFit,
    best: FitCandidate,
    scores: list[float],
) -> Fit:
    here, target = best.placed, search.target
    if target.mode != "nearest":
        here.require_apart("the fitted sketch")
    n = len(shape.free)
    alike = 1e-6 * (shape.size if target.mode == "nearest" else abs(best.score))
    place = here.numbers[n:]
    distance = hausdorff(here.curve, target.outline.curve)
    seen = distance if target.mode == "nearest" else target.clearance(here)[1]
    return Fit(
        mode=target.mode,
        sketch=shape.placed_sketch(here.numbers, sketch),
        dimensions=dict(zip(shape.free, here.numbers[:n].tolist(), strict=True)),
        shift=place[:2].copy() if shape.slides else np.zeros(2),
        turn=float(place[2]) if shape.turns else 0.0,
        distance=distance,
        area=here.area,
        margin=target.margin,
        clearance=best.clearance,
        active=rates_of_fixed(shape, target, best),
        sensitivity=sensitivities(shape, target, best),
        ends=np.stack([seen.point_b, seen.point_a]),
        touching=touching(shape, target, best),
        n_starts=len(scores),
        n_agreeing=int(np.sum(np.array(scores) <= best.score + alike)),
        curve=here.curve,
    )


def starts_of(shape: SketchShape, outline: DrawnOutline, mode: str, count: int) -> list[np.ndarray]:
    """As drawn; scaled and shifted to the outline's box; then the same shaken, always alike."""
    first = shape.start
    found = [first]
    here = shape.at(first)
    if here is None:
        return found
    own, other = here.curve.box, outline.curve.box
    scale = float(np.min((other[1] - other[0]) / (own[1] - own[0]))) if mode != "inside" else 1.0
    moved = first.copy()
    for i, kind in enumerate(shape.kinds):
        if kind not in ("angle", "ratio", "parameter"):
            moved[i] = first[i] * scale
    moved = _centred(shape, moved, other) if mode != "inside" else moved
    if mode != "inside":
        found.append(moved)
    rng = np.random.default_rng(0)
    while len(found) < count:
        source = found[0] if len(found) % 2 or mode == "inside" else moved
        shaken = source.copy()
        n = len(shape.free)
        shaken[:n] *= rng.uniform(0.6, 1.4, n)
        if shape.slides:
            shaken[n : n + 2] += 0.1 * shape.size * rng.uniform(-1.0, 1.0, 2)
        if shape.turns:
            shaken[-1] += 0.5 * np.pi * rng.integers(0, 4) + rng.uniform(-0.3, 0.3)
        found.append(shaken)
    return found[: max(1, count)]


def _centred(shape: SketchShape, numbers: np.ndarray, box: np.ndarray) -> np.ndarray:
    """The numbers with the shape's box centred on another, where it may slide."""
    here = shape.at(numbers) if shape.slides else None
    if here is None:
        return numbers
    n = len(shape.free)
    moved = numbers.copy()
    moved[n : n + 2] += box.mean(axis=0) - here.curve.box.mean(axis=0)
    return moved
