"""Compiled walks over faces that share edges. Not for: which edges are shared (room `geometry`)."""

from __future__ import annotations

import numpy as np

from clearance.compile.jit import inline, kernel


@inline
def find_root(parents, i):
    """The root of `i` in a union-find forest, halving the path on the way."""
    while parents[i] != i:
        parents[i] = parents[parents[i]]
        i = parents[i]
    return i


@kernel
def joined_labels(n_items, first, second):
    """(n_items,) a label 0, 1, … for each item, equal for items that pairs (first, second) connect.

    Labels are given in the order of the least item that they hold.
    """
    parents = np.arange(n_items)
    for i in range(len(first)):
        a = find_root(parents, first[i])
        b = find_root(parents, second[i])
        if a < b:
            parents[b] = a
        elif b < a:
            parents[a] = b
    labels = np.empty(n_items, dtype=np.int64)
    n_labels = 0
    for i in range(n_items):
        root = find_root(parents, i)
        if root == i:
            labels[i] = n_labels
            n_labels += 1
        else:
            labels[i] = labels[root]
    return labels
