"""Compiled walks over faces that share edges. Not for: which edges are shared (room `geometry`)."""

from __future__ import annotations

import numpy as np

from clearance.compile.declared import Integers
from clearance.compile.decorators import inline, kernel


@inline
def find_root(parents, i):
    """The root of `i` in a union-find forest, halving the path on the way."""
    while parents[i] != i:
        parents[i] = parents[parents[i]]
        i = parents[i]
    return i


@inline
def join(parents, i, k):
    """Makes the trees of `i` and `k` one; its root, the lesser of theirs."""
    a, b = find_root(parents, i), find_root(parents, k)
    parents[max(a, b)] = min(a, b)
    return min(a, b)


@inline
def labels_of(parents, start):
    """(n,) a label 0, 1, … for each item from `start` on, the same for all of a tree and -1 before; their number.

    Labels are given in the order of the roots, each the least item of its tree.
    """
    labels = np.full(len(parents), -1, dtype=np.int64)
    n_labels = 0
    for i in range(start, len(parents)):
        root = find_root(parents, i)
        if root == i:
            labels[i] = n_labels
            n_labels += 1
        else:
            labels[i] = labels[root]
    return labels, n_labels


@kernel
def joined_labels(n_items: int, first: Integers, second: Integers) -> Integers:
    """(n_items,) a label 0, 1, … for each item, equal for items that pairs (first, second) connect.

    Labels are given in the order of the least item that they hold.
    """
    parents = np.arange(n_items)
    for i in range(len(first)):
        join(parents, first[i], second[i])
    return labels_of(parents, 0)[0]
