"""The centre line of a bent pipe: corners rounded by arcs, arcs replaced by tangents, sections swept along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.shapes.dimension import MOST_SECTIONS, positive


@dataclass(frozen=True, eq=False)
class CentreLine:
    """A line of straight pieces, mitred where they meet.

    Attributes:
        points: (k, 3) [m] ends and joints.
        bend_radius: [m] of the arcs that the pieces touch; 0 without bends.
        step: [rad] greatest angle between neighbouring pieces.
    """

    points: np.ndarray
    bend_radius: float
    step: float

    def extended(self, by: float) -> CentreLine:
        """The line made longer at both ends by `by` [m]."""
        points = self.points.copy()
        points[0] -= by * _unit(points[1] - points[0])
        points[-1] += by * _unit(points[-1] - points[-2])
        return CentreLine(points, self.bend_radius, self.step)

    def swept(self, section: np.ndarray) -> np.ndarray:
        """(k, n, 3) the section (n, 2) carried along the line without twist, cut at each mitre plane."""
        directions = _unit(np.diff(self.points, axis=0))
        mitres = np.concatenate(
            [directions[:1], _unit(directions[1:] + directions[:-1]), directions[-1:]]
        )
        across, up = _frame(directions[0])
        ring = self.points[0] + section[:, :1] * across + section[:, 1:] * up
        rings = [ring]
        for point, direction, mitre in zip(self.points[1:], directions, mitres[1:], strict=True):
            ring = ring + (((point - ring) @ mitre) / (direction @ mitre))[:, None] * direction
            rings.append(ring)
        return np.stack(rings)


def mitred(
    path: np.ndarray, bend_radius: float | None, outer_radius: float, tolerance: float
) -> CentreLine:
    """The mitred line of a path (n, 3) [m], its steps small enough for half the tolerance [m].

    Raises:
        BadDimension: the path is not two or more different points, or the bends do not fit.
    """
    points = _checked_path(path)
    directions = _unit(np.diff(points, axis=0))
    turns = 2.0 * np.arctan2(
        np.linalg.norm(directions[1:] - directions[:-1], axis=1),
        np.linalg.norm(directions[1:] + directions[:-1], axis=1),
    )
    if not (turns > 1e-12).any():
        return CentreLine(points[[0, -1]], 0.0, 0.0)
    radius = _checked_bend_radius(bend_radius, outer_radius)
    tangents = np.concatenate([[0.0], radius * np.tan(0.5 * turns), [0.0]])
    _check_fit(np.linalg.norm(np.diff(points, axis=0), axis=1), tangents, radius)
    # excess in bends is 2 (B + R) (1 / cos(step / 2) - 1) to first order; see NOTES.md
    allowed = (
        0.49 * min(tolerance, 4.0 * (radius - outer_radius)) / (2.0 * (radius + 2.0 * outer_radius))
    )
    most = 2.0 * np.arccos(1.0 / (1.0 + allowed))
    if turns.max() / most > MOST_SECTIONS:
        raise BadDimension(
            f"tolerance {tolerance:.9g} needs {turns.max() / most:.0f} pieces a bend",
            where="bend_radius",
            valid=f"at most {MOST_SECTIONS}; a coarser tolerance, or a bend radius well above outer_radius",
        )
    joints = [points[:1]]
    for i, turn in enumerate(turns):
        n_pieces = max(1, int(np.ceil(turn / most)))
        joints.append(_joints(points[i + 1], directions[i : i + 2], turn, radius, n_pieces))
    steps = turns / np.maximum(1, np.ceil(turns / most))
    return CentreLine(np.concatenate([*joints, points[-1:]]), radius, float(steps.max()))


def _joints(
    corner: np.ndarray, directions: np.ndarray, turn: float, radius: float, n_pieces: int
) -> np.ndarray:
    """(n_pieces, 3) where tangents of the arc at 0, step, …, turn meet their neighbours."""
    if n_pieces == 1:
        return corner[None]
    arriving, leaving = directions
    inward = _unit(leaving - (leaving @ arriving) * arriving)
    step = turn / n_pieces
    centre = corner - radius * np.tan(0.5 * turn) * arriving + radius * inward
    angles = (np.arange(n_pieces) + 0.5)[:, None] * step
    return centre + radius / np.cos(0.5 * step) * (
        np.sin(angles) * arriving - np.cos(angles) * inward
    )


def _checked_path(path: np.ndarray) -> np.ndarray:
    try:
        points = np.array(path, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.zeros(0)
    if points.ndim != 2 or points.shape[1:] != (3,) or len(points) < 2:
        raise BadDimension(
            f"path of shape {points.shape}",
            where="path",
            valid="two or more points of three numbers [m]",
        )
    if not np.isfinite(points).all():
        i_bad = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise BadDimension(
            f"point {i_bad} is {points[i_bad].tolist()}", where="path", valid="finite"
        )
    same = (points[1:] == points[:-1]).all(axis=1)
    if same.any():
        i_bad = int(np.argmax(same))
        raise BadDimension(
            f"points {i_bad} and {i_bad + 1} are equal",
            where="path",
            valid="each point once in a row",
        )
    return points


def _checked_bend_radius(bend_radius: float | None, outer_radius: float) -> float:
    if bend_radius is None:
        raise BadDimension(
            "the path has corners and bend_radius is missing",
            where="bend_radius",
            valid="a radius [m]",
        )
    radius = positive(bend_radius, "bend_radius")
    if radius <= outer_radius:
        raise BadDimension(
            f"bend_radius {radius:.9g} is not above outer_radius {outer_radius:.9g}",
            where="bend_radius",
            valid="more than outer_radius",
        )
    return radius


def _check_fit(lengths: np.ndarray, tangents: np.ndarray, radius: float) -> None:
    needed = tangents[:-1] + tangents[1:]
    tight = needed > lengths * (1.0 + 1e-12)
    if tight.any():
        i_bad = int(np.argmax(tight))
        raise BadDimension(
            f"bend_radius {radius:.9g} needs {needed[i_bad]:.6g} of the {lengths[i_bad]:.6g} between "
            f"points {i_bad} and {i_bad + 1}",
            where="path",
            valid="longer pieces or a smaller bend_radius",
        )


def _frame(direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across a direction, right-handed with it; x and y for the direction z."""
    guide = np.eye(3)[0 if abs(direction[0]) < 0.9 else 1]
    up = _unit(np.cross(direction, guide))
    return np.cross(up, direction), up


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
