"""The steps of a construction plan, as those who run or read a plan need them. Not for: making them (`plan`)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

PEELED, IN_BODY, IN_CORE = 0, 1, 2
"""The origin of a step: peeled off, inside a body, a cluster of the core."""


@dataclass(frozen=True)
class PlanStep:
    """Vertices that are placed at once, and the equations that place them.

    A closed step places one vertex, with a partner perhaps: a direction and its offset, a centre and its radius.
    A numeric one is a cluster, a body's members together.
    """

    vertices: tuple[int, ...]
    rows: tuple[int, ...]
    origin: int
    numeric: bool = False

    @property
    def vertex(self) -> int:
        """The first vertex."""
        return self.vertices[0]

    @property
    def partner(self) -> int:
        """The vertex that a closed step places with its own; -1 for none."""
        return -1 if self.numeric or len(self.vertices) == 1 else self.vertices[1]


@dataclass(frozen=True, eq=False)
class ConstructionPlan:
    """A construction plan: its steps in the order of placing, and what is known of the graph.

    Attributes:
        body_of: (v,) the body of every vertex, -1 outside bodies.
        fixed: (b,) marks the initial clusters.
        dependent: (k,) the edges that others imply.
        circuits: the edges of the circuit of each.
    """

    steps: tuple[PlanStep, ...]
    body_of: np.ndarray
    fixed: np.ndarray
    dependent: np.ndarray
    circuits: list[list[int]]

    def after(self, k: int) -> ConstructionPlan:
        """The plan of the steps that follow step k."""
        return replace(self, steps=self.steps[k + 1 :])
