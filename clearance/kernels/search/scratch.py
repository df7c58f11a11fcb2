"""Scratch memory of one search at a time, and its queue of node pairs."""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Shorts2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.arithmetic.predicates import ExactScratch, new_exact_scratch
from clearance.kernels.features.refine import RefineQueue, new_refine_queue
from clearance.kernels.search.front import LONGEST
from clearance.kernels.search.pieces import TrianglePairs, new_pieces

STACK_DEPTH = WIDTH * LONGEST + 4096
"""Capacity of the queue: all node pairs of a front, and three for each opening: three times the depths of both
trees. Trees of a million faces split at the mean are below 100 deep, and `descend` checks."""


class Scratch(NamedTuple):
    """Arrays for queues, pieces of faces and exact arithmetic, reused between queries."""

    nodes: Shorts2  # (STACK_DEPTH, 2) int32
    bounds: Floats  # (STACK_DEPTH,)
    entries: Shorts2  # (LONGEST + 2, 3) int32, new entries of a front; also lists of nodes
    lower_bounds: Floats  # (LONGEST + 2,)
    waiting: RefineQueue
    exact: ExactScratch
    pieces: TrianglePairs


@inline
def new_scratch():
    """Scratch of one search at a time."""
    return Scratch(
        np.empty((STACK_DEPTH, 2), dtype=np.int32),
        np.empty(STACK_DEPTH),
        np.empty((LONGEST + 2, 3), dtype=np.int32),
        np.empty(LONGEST + 2),
        new_refine_queue(),
        new_exact_scratch(),
        new_pieces(),
    )


@inline(force=True)
def copy(scratch, i, k):
    """Copies the waiting node pair at place `i` to place `k`."""
    scratch.nodes[k, 0], scratch.nodes[k, 1] = scratch.nodes[i, 0], scratch.nodes[i, 1]
    scratch.bounds[k] = scratch.bounds[i]


@inline(force=True)
def swap(scratch, i, k):
    """Swaps the waiting node pairs at two places."""
    nodes, bounds = scratch.nodes, scratch.bounds
    nodes[i, 0], nodes[k, 0] = nodes[k, 0], nodes[i, 0]
    nodes[i, 1], nodes[k, 1] = nodes[k, 1], nodes[i, 1]
    bounds[i], bounds[k] = bounds[k], bounds[i]


@inline(force=True)
def require_capacity(n_waiting):
    """Asserts that a group of node pairs more can wait."""
    if n_waiting + WIDTH > STACK_DEPTH:
        raise AssertionError("too many node pairs wait")


@inline(force=True)
def wait(scratch, n_waiting, node_a, node_b, bound, first):
    """Queues a node pair among those from place `first` on, the nearest last; how many wait."""
    k = n_waiting
    while k > first and scratch.bounds[k - 1] < bound:
        copy(scratch, k - 1, k)
        k -= 1
    scratch.bounds[k] = bound
    scratch.nodes[k, 0], scratch.nodes[k, 1] = node_a, node_b
    return n_waiting + 1
