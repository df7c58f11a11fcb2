"""The plane that a profile lies in: its name or its point and normal, and its two axes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadInput

_AXES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
VALID = 'xy, xz, yz or "px py pz nx ny nz" (a point and a normal)'


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane with its own coordinates.

    Attributes:
        name: as it was given.
        origin: (3,) [m] world point at the coordinates (0, 0).
        axes: (2, 3) unit world directions of the two coordinates.
        normal: (3,) unit.
    """

    name: str
    origin: np.ndarray
    axes: np.ndarray
    normal: np.ndarray

    @classmethod
    def of(cls, text: str, section: float | None = None) -> Plane:
        """The plane of a name, or of a point and a normal as six numbers.

        xy, xz and yz have the world's own coordinates. In a plane of a point and a normal n the first axis
        is horizontal (z x n; x where n is vertical), the second n x the first.

        Args:
            section: [m] moves the plane along its normal: the height at which it cuts.

        Raises:
            BadInput: neither a name nor six finite numbers with a normal that is not zero.
        """
        if text in _AXES:
            first, second = _AXES[text]
            axes, normal = np.eye(3)[[first, second]], np.eye(3)[3 - first - second]
            origin = np.zeros(3)
        else:
            origin, normal = _numbers(text)
            axes = _axes_of(normal)
        shift = 0.0 if section is None else float(section)
        if not math.isfinite(shift):
            raise BadInput(f"{section!r}", where="section", valid="a finite height [m]")
        return cls(text, origin + shift * normal, axes, normal)

    def coordinates(self, points: np.ndarray) -> np.ndarray:
        """(..., 2) [m] of world points (..., 3)."""
        return (points - self.origin) @ self.axes.T

    @property
    def height(self) -> float:
        """[m] of the origin along the normal, from the world's origin."""
        return float(self.origin @ self.normal)


def _numbers(text: str) -> tuple[np.ndarray, np.ndarray]:
    try:
        numbers = np.array([float(word) for word in str(text).replace(",", " ").split()])
    except ValueError:
        numbers = np.zeros(0)
    if numbers.shape != (6,) or not np.isfinite(numbers).all():
        raise BadInput(f"{text!r:.60}", where="plane", valid=VALID)
    length = float(np.linalg.norm(numbers[3:]))
    if not length > 0.0:
        raise BadInput(f"a normal of zero length in {text!r:.60}", where="plane", valid=VALID)
    return numbers[:3], numbers[3:] / length


def _axes_of(normal: np.ndarray) -> np.ndarray:
    level = np.cross([0.0, 0.0, 1.0], normal)
    length = float(np.linalg.norm(level))
    first = level / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])
