"""Time is halved until each part is proven: one loop for an interval, and for rectangles of two clocks' times.

A pair over an interval is a search of its own here. The caller's type defines the proof of a part: without
tolerances (`certify`), or with them (`budget.sweep`). Not for: one part (`search.proof`).
"""

import math
from typing import Any, NamedTuple

from clearance.compile.declared import Floats2
from clearance.compile.decorators import by_type, inline

DEPTH = 64
"""Most waiting parts of an interval, one a halving; after 52 the ends are the same number."""

WIDER = 4.0
"""The gap of a pair grows by this factor each time it has used up its most parts."""


class Visit(NamedTuple):
    """The result for a part of time: the search after it, the part, and True if it must be halved."""

    search: Any
    part: Any
    is_open: bool


@by_type
def with_part(search, place):
    """Visits the part that waits at a place, as a `Visit`."""
    raise TypeError


@by_type
def without_part(search, part):
    """The search after a part that cannot be halved any more."""
    raise TypeError


@by_type
def put_halves(search, part, place):
    """Queues the halves of a part at a place and the next; the last one is visited first."""
    raise TypeError


@inline
def halve(search, depth):
    """The search after the whole part that waits at place 0.

    Args:
        depth: most parts that can wait.
    """
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        visit = with_part(search, n_waiting)
        search = visit.search
        if not visit.is_open:
            continue
        if n_waiting + 2 > depth:
            search = without_part(search, visit.part)
        else:
            put_halves(search, visit.part, n_waiting)
            n_waiting += 2
    return search


@by_type
def prove_part(asked, low, high, n_parts, least, gap):
    """A `Proof` of a pair over the part `low` to `high` (0 to 1) of an interval.

    Args:
        n_parts: the number of the part, 1 for the whole interval.
        least: [m] the least distance known to occur. gap: [m] allowed between it and the bound.
    """
    raise TypeError


class PairInterval(NamedTuple):
    """A pair over an interval.

    Attributes:
        asked: the argument of `prove_part`. waiting: (DEPTH, 2) parts. most_parts: after these the gap is widened.
        lower_bound: [m] of the parts so far. least: [m] given or seen. share: where it was seen, 0 to 1, or -1.
        gap: [m] as above. n_parts: so far. in_contact: True if the proof has ended in contact.
    """

    asked: Any
    waiting: Floats2
    most_parts: int
    lower_bound: float
    least: float
    share: float
    gap: float
    n_parts: int
    in_contact: bool


@with_part.register
def _(search: PairInterval, place):
    part = search.waiting[place, 0], search.waiting[place, 1]
    if search.in_contact:
        return Visit(search, part, False)
    low, high = part
    n_parts, gap, lower_bound = search.n_parts + 1, search.gap, search.lower_bound
    if n_parts % search.most_parts == 0 or place + 2 > DEPTH:
        gap *= WIDER
    proof = prove_part(search.asked, low, high, n_parts, search.least, gap)
    least, share = search.least, search.share
    if proof.least < least:
        least, share = proof.least, 0.5 * (low + high)
    if proof.is_complete:
        lower_bound = min(lower_bound, proof.lower_bound)
    search = PairInterval(
        search.asked, search.waiting, search.most_parts, lower_bound, least, share, gap, n_parts,
        proof.in_contact,
    )  # fmt: skip
    return Visit(search, part, not proof.is_complete)


@without_part.register
def _(search: PairInterval, part):
    return PairInterval(
        search.asked, search.waiting, search.most_parts, -math.inf, search.least, search.share,
        search.gap, search.n_parts, search.in_contact,
    )  # fmt: skip


@put_halves.register
def _(search: PairInterval, part, place):
    waiting = search.waiting
    low, high = part
    at = 0.5 * (low + high)
    waiting[place, 0], waiting[place, 1] = at, high
    waiting[place + 1, 0], waiting[place + 1, 1] = low, at


@inline
def prove_interval(asked, least, gap, most_parts, waiting):
    """A pair over a whole interval, halved until it is proven; the earlier half first."""
    waiting[0, 0], waiting[0, 1] = 0.0, 1.0
    first = PairInterval(asked, waiting, most_parts, math.inf, least, -1.0, gap, 0, False)
    return halve(first, DEPTH)
