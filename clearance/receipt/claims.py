"""What a receipt claims: of each rule and interval a bound, or, where it is sampled, of some intervals.

Which are sampled follows from the case's numbers, so that nobody chooses them. Not for: proofs.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import numpy as np

from clearance.receipt.case_data import CaseData
from clearance.receipt.proof.motion_data import NOT_CLAIMED

EVERY = 16
"""One interval of so many is sampled, and that of the least bound."""


def judged(data: CaseData) -> np.ndarray:
    """(rules, intervals) True where a rule judges some pair."""
    found = np.zeros((len(data.rules), data.n_intervals), dtype=bool)
    for stretch in data.stretches:
        found[np.unique(stretch.rules), stretch.first : stretch.first + stretch.n_intervals] = True
    return found


def sampled(data: CaseData) -> np.ndarray:
    """(intervals,) True for those that a sampled receipt must claim something of."""
    seed = data.digest.encode()
    draws = (hashlib.sha256(seed + b"%d" % i).digest()[0] for i in range(data.n_intervals))
    return np.array([draw % EVERY == 0 for draw in draws])


def with_samples_only(claims: np.ndarray, data: CaseData) -> np.ndarray:
    """The claims of the sampled intervals, and of each rule that of its least."""
    chosen = np.broadcast_to(sampled(data), claims.shape).copy()
    for rule, row in enumerate(claims):
        claimed = np.flatnonzero(row != NOT_CLAIMED)
        if len(claimed):
            chosen[rule, claimed[np.argmin(row[claimed])]] = True
    return np.where(chosen, claims, NOT_CLAIMED)


def missing(claims: np.ndarray, data: CaseData, kind: str) -> Iterator[tuple[str, int]]:
    """Rules and intervals of which nothing is claimed and something must be."""
    must = judged(data)
    if kind == "sampled":
        must &= sampled(data)
    for rule, interval in np.argwhere(must & (claims == NOT_CLAIMED)).tolist():
        yield data.rules[rule], interval
