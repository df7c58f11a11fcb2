"""The steps of a construction plan, as those who run or read a plan need them. Not for: making them (`plan`)."""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import shared

PEELED, IN_BODY, IN_CORE = 0, 1, 2
"""Where a step comes from: peeled off, inside a body, a cluster of the core."""


class PlanSteps(NamedTuple):
    """Steps in order: each is closed (a vertex and its partner) or numeric (a block).

    Attributes:
        vertex, partner: (s,) what a closed step places, -1 for none.
        edges: (s, 3) the equations that it places them from, -1 pads.
        block: (s,) the block of a numeric step, -1 for closed ones.
        origin: (s,) PEELED, IN_BODY or IN_CORE.
        block_vertex_start, block_vertex: the vertices of every block, (blocks + 1,) starts.
        block_row_start, block_row: the equations of every block, (blocks + 1,) starts.
    """

    vertex: np.ndarray
    partner: np.ndarray
    edges: np.ndarray
    block: np.ndarray
    origin: np.ndarray
    block_vertex_start: np.ndarray
    block_vertex: np.ndarray
    block_row_start: np.ndarray
    block_row: np.ndarray


@shared
def block_of(steps, b):
    """The (vertices, rows) of block b."""
    vertices = steps.block_vertex[steps.block_vertex_start[b] : steps.block_vertex_start[b + 1]]
    return vertices, steps.block_row[steps.block_row_start[b] : steps.block_row_start[b + 1]]
