"""The construction plan: which vertices are placed from which equations, in which order.

Peeled vertices come last; before them the core: rigid bodies in their own frame, then the clusters
in the order of placing. A step is closed (one vertex, a line or a circle) or numeric (a cluster).
Not for: running it (`sketch.solve.execute`).
"""

from __future__ import annotations

import numpy as np

from clearance.sketch.graph.core import plan_core
from clearance.sketch.graph.graph import ConstraintGraph
from clearance.sketch.graph.pebble import play
from clearance.sketch.graph.peel import peel
from clearance.sketch.graph.steps import ConstructionPlan, PlanStep


def make_plan(graph: ConstraintGraph) -> ConstructionPlan:
    """The plan of a constraint graph; see `ConstructionPlan`.

    Dependent edges are omitted; if there are some, vertices that hung on them are peeled as well.
    """
    n = len(graph.kind)
    live, removed = bytearray(map(bool, graph.ends)), bytearray(n)
    last = peel(graph, live, removed)
    before: list[PlanStep] = []
    dependent: list[int] = []
    circuits: list[list[int]] = []
    if any(live):
        dependent, circuits = play(graph, live)
        for row in dependent:
            live[row] = 0
        before = peel(graph, live, removed) if dependent else []
    core: list[PlanStep] = []
    body_of, fixed = [-1] * n, np.zeros(0, bool)
    if any(live):
        core, body_of, fixed = plan_core(graph, live, removed)
    steps = (*core, *reversed(before), *reversed(last))
    return ConstructionPlan(
        steps, np.array(body_of), fixed, np.array(dependent, np.int64), circuits
    )
