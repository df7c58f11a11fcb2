"""Scratch of one search at a time, and how node pairs wait in it."""

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
"""Node pairs that can wait: all of a front, and three for each opening, so three times the depths of both trees;
those of a million faces split at the mean are below 100 deep, and `descend` checks."""


class Scratch(NamedTuple):
    """Arrays for what waits, for pieces of faces and for exact arithmetic, reused between queries."""

    nodes: Shorts2  # (STACK_DEPTH, 2) int32
    bounds: Floats  # (STACK_DEPTH,)
    left: Shorts2  # (LONGEST + 2, 3) int32, entries of a front that were left
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
    """Lets what waits at place `i` wait at place `k` too."""
    scratch.nodes[k, 0], scratch.nodes[k, 1] = scratch.nodes[i, 0], scratch.nodes[i, 1]
    scratch.bounds[k] = scratch.bounds[i]


@inline(force=True)
def swap(scratch, i, k):
    """Lets what waits at two places change them."""
    nodes, bounds = scratch.nodes, scratch.bounds
    nodes[i, 0], nodes[k, 0] = nodes[k, 0], nodes[i, 0]
    nodes[i, 1], nodes[k, 1] = nodes[k, 1], nodes[i, 1]
    bounds[i], bounds[k] = bounds[k], bounds[i]


@inline(force=True)
def require_room(n_waiting):
    """Asserts that there is room for a group of node pairs beside those that wait."""
    if n_waiting + WIDTH > STACK_DEPTH:
        raise AssertionError("no room for what waits")


@inline(force=True)
def wait(scratch, n_waiting, node_a, node_b, bound, first):
    """Lets a node pair wait among those from place `first` on, the nearest last; how many wait."""
    k = n_waiting
    while k > first and scratch.bounds[k - 1] < bound:
        copy(scratch, k - 1, k)
        k -= 1
    scratch.bounds[k] = bound
    scratch.nodes[k, 0], scratch.nodes[k, 1] = node_a, node_b
    return n_waiting + 1
